// page_fuzz.cpp: Models encoded for the page and decoded within the losses that write_html states.
#include <algorithm>
#include <cmath>

#include "drawn.h"
#include "support/web_decoder.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    Numbers numbers(input);
    const Gaussians model = drawn_model(numbers);
    if (!accepted([&] { validate(model); })) return;
    web::WebFrame frame;
    web::WebLevel level;
    if (!accepted([&] {
            frame = web::web_frame(model);
            level = web::web_level(model, frame);
        }))
        return;
    const Gaussians again = test::decoded(level, frame, model.cutoff);
    expect(again.size() == model.size(), "every Gaussian with a density is encoded");
    const double whole = mass(model);
    // Densities over more than 90 octaves have steps of more than 1/1024.
    const double rounding = std::exp2(0.5 * level.density.step) - 1;
    // Denormal densities have fewer digits; the largest floats have no room to be rounded up.
    const auto [least, most] = std::ranges::minmax(model.density);
    if (whole > 1e-25 && whole < 1e25 && least > 1e-36f && most < 1e38f)
        expect(std::abs(mass(again) / whole - 1) <= std::max(1.0 / 512, rounding + 1e-4),
               "the mass survives");
}

}  // namespace vog::fuzz
