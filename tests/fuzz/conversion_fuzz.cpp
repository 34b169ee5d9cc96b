// conversion_fuzz.cpp: Volumes of any extent, values and transforms converted by any cells: mass and mean are
// conserved, and the model is valid.
#include <cmath>
#include <limits>

#include "drawn.h"
#include "vog/convert_moments.h"

namespace vog::fuzz {

// The measured error takes 24 pictures of 256 x 256 pixels for each candidate.
const Limits kLimits{.seconds = 60};

namespace {

MomentOptions drawn_options(Numbers& numbers) {
    MomentOptions options;
    const int kind = numbers.below(16);
    if (kind < 8) options.block_voxels = 1 << kind;
    if (kind >= 8 && kind < 15) options.budget = 1 + static_cast<std::size_t>(numbers.below(300));
    // The search for an error takes seconds: rarely.
    const bool searches = kind == 15 && numbers.byte() == 'E';
    if (searches && numbers.flag()) options.error = 0.05 + 0.5 * numbers.share();
    if (kind == 15 && !searches) options.budget = 1 + static_cast<std::size_t>(numbers.below(4000));
    options.soft_steps = numbers.below(4) - 1;
    options.axis_aligned = numbers.flag();
    return options;
}

}  // namespace

void run(Bytes input) {
    Numbers numbers(input);
    const MomentOptions options = drawn_options(numbers);
    const Volume volume = drawn_volume(numbers);
    if (!accepted([&] { validate(volume); })) return;
    MomentReport report;
    Gaussians model;
    if (!accepted([&] { model = convert_moments(volume, options, &report); })) return;
    expect(accepted([&] { validate(model); }), "a model that is converted is valid");
    expect(options.budget == 0 || model.size() <= options.budget, "a budget is kept");
    const double whole = mass(volume), drawn = mass(model);
    expect(std::isfinite(drawn), "the mass is finite");
    expect(std::abs(report.mass_ratio - 1) <= 1e-4, "the mass of cells is that of the data");
    // Single precision of scales and densities; denormal ones have fewer digits.
    if (whole > 1e-25 && whole < 1e25)
        expect(std::abs(drawn / whole - (1 - report.dropped_mass_share)) <= 1e-3,
               "the mass of the model is that of the cells");
}

}  // namespace vog::fuzz
