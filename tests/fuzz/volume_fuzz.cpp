// volume_fuzz.cpp: Volumes written to OpenVDB files and read again.
#include "drawn.h"
#include "fuzz_target.h"
#include "same_volume.h"
#include "vog/volume_io.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    Numbers numbers(input);
    const Volume volume = drawn_volume(numbers);
    if (!accepted([&] { validate(volume); })) return;
    expect_round_trip(volume);
    // Half floats hold their own values.
    const std::filesystem::path file = scratch_file("half.vdb");
    Volume half;
    if (accepted([&] { write_vdb(file, volume, true); }) &&
        accepted([&] { half = read_vdb(file); }))
        expect(active_voxels(half) == active_voxels(volume), "half floats keep the active voxels");
}

}  // namespace vog::fuzz
