// ply_fuzz.cpp: Reader of models; what is read is written and read again, and drawn.
#include <cmath>

#include "fuzz_target.h"
#include "render/splat/splat.h"
#include "same_model.h"
#include "vog/ply.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".ply");
    Gaussians model;
    Hierarchy hierarchy;
    if (!accepted([&] { model = read_ply(file, &hierarchy); })) return;
    expect(accepted([&] { validate(model); }), "a model that is read is valid");
    expect_round_trip(model, hierarchy);
    DepthImage image;
    const bool drawn = accepted([&] {
        SplatRenderer renderer(model);
        renderer.render(paper_view(view_box(model)), 16, 16, image);
    });
    if (drawn)
        for (const float depth : image.depth) expect(depth >= 0, "T is a number of 0 or more");
}

}  // namespace vog::fuzz
