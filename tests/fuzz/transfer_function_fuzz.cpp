// transfer_function_fuzz.cpp: Reader of transfer functions, vog's own and ParaView's; what is read is written and
// read again; as functions of values their pieces are exact.
#include <cmath>

#include "fuzz_target.h"
#include "render/by_value/value_pieces.h"
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
    ValueTransfer values;  // refused where the domain holds no finite value
    if (!accepted([&] { values = read_value_transfer(file.string(), -100, 300, 2); })) return;
    const by_value::ValuePieces pieces(values);
    for (const double value : {-1e30, -100.0, 0.0, 0.3, 1.0, 300.0, values.color.front().value,
                               values.opacity.back().value, 1e30}) {
        const ValueLight exact = light_of(values, value), fast = pieces(value);
        expect(exact.extinction >= 0 && exact.r >= 0 && exact.r <= 1, "light is in its range");
        expect(std::abs(fast.r - exact.r) < 1e-6, "pieces have the same colours");
    }
}

}  // namespace vog::fuzz
