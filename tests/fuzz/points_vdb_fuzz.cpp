// points_vdb_fuzz.cpp: Reader of OpenVDB's particles; what is read is written and read again.
#include "fuzz_target.h"
#include "same_points.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".vdb");
    accepted([&] { (void)vdb_holds_points(file); });
    for (const bool lenient : {false, true}) {
        Points points;
        if (!accepted([&] { points = read_points(file, {.values = {lenient, false}}); })) continue;
        expect(accepted([&] { validate(points); }), "particles that are read are valid");
        expect_round_trip(points, ".csv");
    }
}

}  // namespace vog::fuzz
