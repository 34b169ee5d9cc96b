// model_fuzz.cpp: Models with a hierarchy, written and read again; the renderers agree on them.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "data/fields/field_arrays.h"
#include "drawn.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "same_model.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    Numbers numbers(input);
    Gaussians model = drawn_model(numbers);
    if (!accepted([&] { validate(model); })) return;
    const bool nodes = numbers.flag(), orthographic = numbers.flag();
    model.fields = drawn_fields(numbers, model.size());  // last, after all that kept inputs draw
    if (!accepted([&] { validate(model); })) return;
    Hierarchy hierarchy;
    if (nodes && !accepted([&] { hierarchy = build_hierarchy(model); })) return;
    if (!model.fields.empty())
        expect(accepted([&] { validate(hierarchy.nodes.fields, hierarchy.size()); }),
               "fields of nodes are valid");
    expect_round_trip(model, hierarchy);

    Camera camera;
    DepthImage splatted, traced;
    const bool drawn = accepted([&] {
        camera = paper_view(view_box(model));
        if (orthographic) camera.orthographic_width = fitted_width(camera, view_box(model));
        SplatRenderer renderer(model);
        renderer.render(camera, 16, 12, splatted);
    });
    const bool both = accepted([&] {
        const Camera same = drawn ? camera : paper_view(view_box(model));
        traced = render_trace(trace_scene(model), same, 16, 12);
    });
    if (!drawn || !both) return;
    double largest = 0, unit = 0, coordinate = 0;
    for (std::size_t n = 0; n < splatted.depth.size(); ++n) {
        expect(splatted.depth[n] >= 0 && traced.depth[n] >= 0, "T is a number of 0 or more");
        largest = std::max({largest, double{splatted.depth[n]}, double{traced.depth[n]}});
    }
    // The squares of smaller T leave the range of floats, and cameras have doubles
    // (docs/reliability.md, "Limits").
    for (std::size_t n = 0; n < model.size(); ++n) {
        const Vec3f s = model.scale[n];
        unit = std::max(unit, double{model.density[n]} * double{std::max({s.x, s.y, s.z})});
    }
    const Box box = view_box(model);
    for (int axis = 0; axis < 3; ++axis)
        coordinate = std::max({coordinate, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
    if (largest < 1e-10 * unit || 0x1p-52 * coordinate > 1e-6 * box.radius()) return;
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
