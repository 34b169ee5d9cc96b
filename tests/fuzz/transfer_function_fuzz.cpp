// transfer_function_fuzz.cpp: Reader of transfer functions, vog's own and ParaView's; what is read is written and
// read again.
#include "fuzz_target.h"
#include "vog/shade.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".json");
    TransferFunction tf;
    if (!accepted([&] { tf = read_transfer_function(file); })) return;
    const std::filesystem::path again_file = scratch_file("again.json");
    expect(accepted([&] { write_transfer_function(again_file, tf); }),
           "a transfer function that is read is written");
    TransferFunction again;
    expect(accepted([&] { again = read_transfer_function(again_file); }),
           "a transfer function that is written is read");
    for (int n = 0; n <= 16; ++n) {
        const float v = static_cast<float>(n) / 16;
        const Rgba a = color_at(tf, v);
        expect(a == color_at(again, v), "colours survive bit for bit");
        expect(a.a >= 0 && a.a <= 1, "opacity is in [0, 1]");
    }
}

}  // namespace vog::fuzz
