// model_fuzz.cpp: Models with a hierarchy, written and read again; the renderers agree on them.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "drawn.h"
#include "same_model.h"
#include "vog/splat.h"
#include "vog/trace.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    Numbers numbers(input);
    Gaussians model = drawn_model(numbers);
    if (!accepted([&] { validate(model); })) return;
    Hierarchy hierarchy;
    if (numbers.flag() && !accepted([&] { hierarchy = build_hierarchy(model); })) return;
    expect_round_trip(model, hierarchy);

    Camera camera;
    DepthImage splatted, traced;
    const bool drawn = accepted([&] {
        camera = paper_view(view_box(model));
        if (numbers.flag()) camera.orthographic_width = fitted_width(camera, view_box(model));
        SplatRenderer renderer(model);
        renderer.render(camera, 16, 12, splatted);
    });
    const bool both = accepted([&] {
        const Camera same = drawn ? camera : paper_view(view_box(model));
        traced = render_trace(trace_scene(model), same, 16, 12);
    });
    if (!drawn || !both) return;
    double largest = 0;
    for (std::size_t n = 0; n < splatted.depth.size(); ++n) {
        expect(splatted.depth[n] >= 0 && traced.depth[n] >= 0, "T is a number of 0 or more");
        largest = std::max({largest, double{splatted.depth[n]}, double{traced.depth[n]}});
    }
    // The squares of smaller T leave the range of floats (docs/reliability.md, "Limits").
    if (largest < 1e-15) return;
    // Gaussians near a pixel's size have shares of their own in both, 3e-4.
    for (std::size_t n = 0; n < splatted.depth.size(); ++n) {
        const double a = double{splatted.depth[n]}, b = double{traced.depth[n]};
        if (a == b || std::abs(a - b) <= 1e-3 * largest) continue;
        std::fprintf(stderr, "fuzz: pixel %zu: %g splatted, %g traced, largest %g\n", n, a, b,
                     largest);
        expect(false, "splat and ray tracer agree");
    }
}

}  // namespace vog::fuzz
