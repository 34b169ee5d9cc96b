// field_cut_test.cpp: Maps of fields by cuts through a hierarchy: all Gaussians at error 0, fewer with the same
// sums else.
#include <gtest/gtest.h>

#include <cmath>

#include "render/splat/fields/field_splat.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/field_maps.h"

namespace vog::test {

namespace {

/// Fields that are planes all over the model, with a residual.
void add_planes(Gaussians& model) {
    ScalarField scalar;
    scalar.name = "temperature";
    VectorField vector;
    vector.name = "velocity";
    for (const Vec3f p : model.mean) {
        scalar.value.push_back(20 + 5 * p.x);
        scalar.gradient.push_back({5, 0, 0});
        scalar.deviation.push_back(0.1f);
        scalar.skewness.push_back(0);
        vector.value.push_back({1 + p.y, p.x, 2});
        vector.gradient[0].push_back({0, 1, 0});
        vector.gradient[1].push_back({1, 0, 0});
        vector.gradient[2].push_back({0, 0, 0});
        vector.covariance.push_back({0.01f, 0, 0, 0.01f, 0, 0.01f});
    }
    model.fields.scalar.push_back(std::move(scalar));
    model.fields.vector.push_back(std::move(vector));
}

/// Sums over the picture of column, and of column times mean.
struct Sums {
    double column = 0, first = 0;
};
Sums sums_of(const FieldMaps& maps) {
    Sums sums;
    for (std::size_t n = 0; n < maps.column.size(); ++n) {
        if (!(maps.column[n] > 0)) continue;
        sums.column += double{maps.column[n]};
        sums.first += double{maps.column[n]} * double{maps.mean[n]};
    }
    return sums;
}

}  // namespace

TEST(field_cut, draws_fewer_Gaussians_with_the_same_sums) {
    Gaussians model = random_gaussians(3000, 0.02, 0.06, 5);
    add_planes(model);
    const Hierarchy hierarchy = build_hierarchy(model);
    Camera camera;
    camera.eye = {1, 2, 3};
    camera.look_at = {0, 0, 0};
    camera.orthographic_width = 4;
    for (const std::string text : {"temperature", "velocity", "velocity.magnitude"}) {
        const FieldChoice choice = field_choice(text, model.fields);
        const auto render = [&](double error, CutReport* report) {
            return render_field_splat(model, choice, camera, 64, 64,
                                      {.hierarchy = &hierarchy, .cut = {.pixel_error = error}},
                                      report);
        };
        CutReport none, all, some;
        const FieldMaps right = render_field_splat(model, choice, camera, 64, 64, {}, &none);
        EXPECT_EQ(none.leaves, model.size());
        const FieldMaps leaves = render(0, &all), cut = render(3, &some);
        EXPECT_EQ(all.drawn(), model.size());
        EXPECT_EQ(leaves.column, right.column);
        EXPECT_LT(some.drawn(), model.size() / 2) << text;
        const Sums exact = sums_of(right), coarse = sums_of(cut);
        EXPECT_NEAR(coarse.column, exact.column, 5e-3 * exact.column);
        const double scale = choice.part == FieldPart::value ? 20 : 2;
        EXPECT_NEAR(coarse.first, exact.first, 5e-3 * scale * exact.column);
        double worst = 0;
        for (std::size_t n = 0; n < right.column.size(); ++n)
            if (right.column[n] > 0.1f * right.column[64 * 32 + 32])
                worst = std::max(worst, double{std::abs(cut.mean[n] - right.mean[n])});
        EXPECT_LT(worst, 0.1 * scale) << text;
        EXPECT_GT(worst, 0) << text;
    }
    EXPECT_THROW(
        (void)render_field_splat(model, field_choice("temperature", model.fields), camera, 8, 8,
                                 {.hierarchy = &hierarchy, .cut = {.pixel_error = -1}}),
        Error);
}

}  // namespace vog::test
