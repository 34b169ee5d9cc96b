// picture_renderer_test.cpp: every renderer, source, quantity, clip and kind of camera from requests, against closed forms in
// double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "render/shown_field.h"
#include "support/exact_pixels.h"
#include "support/field_models.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::test {

namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr double kPixelError = 40;

struct View {
    const char* name;
    Camera camera;
};
std::vector<View> views() {
    Camera outside, inside, parallel;
    outside.eye = {4, 1.5, 2}, outside.look_at = {0, 0, 0};
    inside.eye = {0.3, -0.2, 0.1}, inside.look_at = {1, 0.4, -0.5}, inside.fov_degrees = 80;
    parallel.eye = {-1, 5, -2}, parallel.look_at = {0, 0, 0}, parallel.up = {0, 0, 1};
    parallel.orthographic_width = 3;
    return {{"outside", outside}, {"inside", inside}, {"parallel", parallel}};
}

struct Cut {
    const char* name;
    Clipping clip;
};
std::vector<Cut> cuts() {
    return {{"whole", {}},
            {"box", {Box{{-0.6, -0.4, -0.7}, {0.47, 0.81, 0.3}}, {}}},
            {"plane", {std::nullopt, {{{1, 2, -1}, 0.1}}}},
            {"beside", {std::nullopt, {{{1, 0, 0}, -99}}}}};
}

std::shared_ptr<const Gaussians> some_model() {
    // Wider than pixels: the closed form is that of the Gaussians themselves.
    auto model = std::make_shared<Gaussians>(random_gaussians(30, 0.3, 0.6, 5));
    add_random_fields(*model, 11);
    return model;
}

/// 16^3 voxels from -1 to 1, a fifth of them empty, as values and as a field of its own.
std::shared_ptr<const VolumeSet> some_voxels(std::vector<VoxelField>& heat) {
    auto set = std::make_shared<VolumeSet>();
    Volume& volume = set->volumes.emplace_back();
    volume.name = "density";
    volume.world_from_index = {{{Vec3d{0.125, 0, 0}, {0, 0.125, 0}, {0, 0, 0.125}}},
                               {-0.9375, -0.9375, -0.9375}};
    Random random(3);
    VoxelField& field = heat.emplace_back();
    field.name = "heat", field.component.resize(1);
    field.lower = 10, field.upper = 20;
    for (int n = 0; n < 8; ++n) {
        Leaf& leaf = volume.leaves.emplace_back();
        leaf.origin = {8 * (n >> 2), 8 * (n >> 1 & 1), 8 * (n & 1)};
        auto& values = field.component.front().leaf.emplace_back();
        values.fill(0);
        for (int v = 0; v < kLeafVoxels; ++v) {
            if (random() < 0.2) continue;
            leaf.set(v, static_cast<float>(random(0.1, 2)));
            values[static_cast<std::size_t>(v)] = static_cast<float>(random(10, 20));
        }
    }
    return set;
}

/// A model with levels of detail.
vog::Scene scene_with_levels() {
    Gaussians model = random_gaussians(100, 0.3, 0.6, 5);
    auto hierarchy = std::make_shared<Hierarchy>(build_hierarchy(model));
    return scene_of(std::make_shared<Gaussians>(std::move(model)), std::move(hierarchy));
}

/// Calls visit(pixel, origin, direction of length 1).
template <class Visit>
void each_ray(const Camera& camera, const Visit& visit) {
    const CameraFrame frame = frame_of(camera, kWidth, kHeight);
    for (int row = 0; row < kHeight; ++row)
        for (int column = 0; column < kWidth; ++column)
            visit(static_cast<std::size_t>(row * kWidth + column), frame.origin(column, row),
                  normalized(frame.direction(column, row)));
}

PictureRequest request_of(Show show, const std::string& field, const Camera& camera,
                          const Clipping& clip) {
    PictureRequest request;
    request.show = show;
    request.field = field;
    request.camera = camera;
    request.width = kWidth, request.height = kHeight;
    request.extinction = 1;
    request.options.clip = clip;
    return request;
}

constexpr Show kAll[] = {Show::depth,     Show::column,  Show::mean,
                         Show::deviation, Show::maximum, Show::volume};

}  // namespace

class picture_renderer_models : public testing::TestWithParam<std::tuple<Renderer, int, int>> {};

TEST_P(picture_renderer_models, draw_the_closed_form) {
    const auto& [renderer, view, cut] = GetParam();
    const Camera camera = views()[static_cast<std::size_t>(view)].camera;
    const Clipping clip = cuts()[static_cast<std::size_t>(cut)].clip;
    const auto model = some_model();
    double largest = 0;
    std::vector<Exact> exact(std::size_t{kWidth} * kHeight);
    each_ray(camera, [&](std::size_t n, Vec3d origin, Vec3d direction) {
        exact[n] = exact_model(*model, origin, direction, clip);
        largest = std::max(largest, exact[n].column);
    });
    PictureRenderer drawn(scene_of(model));
    for (const Show show : {Show::depth, Show::column, Show::mean, Show::deviation}) {
        SCOPED_TRACE(word_of(show));
        PictureRequest request =
            request_of(show, is_field_map(show) ? "temperature" : "", camera, clip);
        request.renderer = renderer;
        const ResolvedPicture picture = resolve(request, drawn.scene());
        Sums sums;
        drawn.draw(picture, sums);
        const Picture finished = finish(std::move(sums), picture, drawn.scene());
        const ScalarField& field = *model->fields.find_scalar("temperature");
        const double range = std::max(std::abs(field.lower), std::abs(field.upper));
        for (std::size_t n = 0; n < exact.size(); ++n) {
            EXPECT_NEAR(finished.sums.column[n], exact[n].column, 2e-5 * largest) << n;
            // Rims have the rounding of their small columns.
            if (!is_field_map(show) || exact[n].column < 1e-2 * largest) continue;
            EXPECT_NEAR(finished.sums.mean[n], exact[n].mean, 2e-4 * range) << n;
            EXPECT_NEAR(finished.sums.deviation[n], exact[n].deviation, 2e-3 * range) << n;
        }
    }
}

TEST_P(picture_renderer_models, draw_T_with_the_options_of_the_renderer) {
    const auto& [renderer, view, cut] = GetParam();
    const Camera camera = views()[static_cast<std::size_t>(view)].camera;
    const Clipping clip = cuts()[static_cast<std::size_t>(cut)].clip;
    PictureRequest boxes = request_of(Show::depth, "", camera, clip);
    boxes.renderer = renderer;
    boxes.options.aabb_sigma = 0.8;
    PictureRequest other = boxes;
    other.options.aabb_sigma = 0;
    if (renderer == Renderer::splat) {
        other.options.pixel_error = kPixelError;
    } else {
        other.options.trace.anyhit = AnyHit::collect;
        other.options.trace.hits_per_slab = 3;
    }
    const vog::Scene scene = scene_with_levels();
    PictureRenderer drawn(scene);
    for (const PictureRequest& request : {boxes, other}) {
        Sums sums;
        drawn.draw(resolve(request, scene), sums);
        const ModelSource& source = scene.model();
        const Gaussians* model = source.model.get();
        ViewCut levels(*model, *source.hierarchy);
        if (request.options.pixel_error) {
            model = &levels.choose(frame_of(camera, kWidth, kHeight), {kPixelError, true});
            EXPECT_EQ(drawn.report().cut->drawn(), model->size());
            EXPECT_EQ(model->size() == source.model->size(), view == 1)
                << "inside, all nodes are near";
        }
        double largest = 0;
        std::vector<double> exact(sums.column.size());
        each_ray(camera, [&](std::size_t n, Vec3d origin, Vec3d direction) {
            exact[n] = exact_depth(*model, request.options.aabb_sigma, origin, direction, clip);
            largest = std::max(largest, exact[n]);
        });
        for (std::size_t n = 0; n < exact.size(); ++n)
            EXPECT_NEAR(sums.column[n], exact[n], 2e-5 * largest) << n;
    }
}

TEST_P(picture_renderer_models, draw_halves_of_small_gaussians_that_make_the_whole) {
    const auto& [renderer, view, cut] = GetParam();
    if (cuts()[static_cast<std::size_t>(cut)].name != std::string("whole")) GTEST_SKIP() << "once";
    // Most are smaller than a pixel, and drawn as points.
    PictureRenderer drawn(scene_of(random_gaussians(500, 0.01, 0.2, 71)));
    const auto draw = [&](const Clipping& clip) {
        PictureRequest request =
            request_of(Show::depth, "", views()[static_cast<std::size_t>(view)].camera, clip);
        request.renderer = renderer;
        Sums sums;
        drawn.draw(resolve(request, drawn.scene()), sums);
        return sums.column;
    };
    const std::vector<float> whole = draw({});
    EXPECT_EQ(draw(cuts().back().clip), whole);
    const double largest = double{*std::ranges::max_element(whole)};
    const Vec3d normal{0.3, -0.7, 0.2};
    const std::vector<float> a = draw({std::nullopt, {{normal, 0.02}}}),
                             b = draw({std::nullopt, {{-normal, -0.02}}});
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_NEAR(double{a[n]} + double{b[n]}, double{whole[n]}, 2e-5 * largest) << n;
    EXPECT_NE(std::ranges::max(a), 0);
    EXPECT_NE(std::ranges::max(b), 0);
}

TEST_P(picture_renderer_models, draw_the_same_values_and_light_as_rays_in_exact_order) {
    const auto& [renderer, view, cut] = GetParam();
    if (renderer == Renderer::trace) GTEST_SKIP() << "the rays themselves";
    const auto model = some_model();
    PictureRenderer drawn(scene_of(model));
    PictureRequest request =
        request_of(Show::volume, "temperature", views()[static_cast<std::size_t>(view)].camera,
                   cuts()[static_cast<std::size_t>(cut)].clip);
    request.transfer.unit_distance = 0.2;
    const auto picture_by = [&](Renderer one, Show show) {
        request.renderer = one;
        request.slabs.reset();
        if (one != Renderer::trace) request.slabs = 256;
        request.show = show;
        const ResolvedPicture picture = resolve(request, drawn.scene());
        Sums sums;
        drawn.draw(picture, sums);
        return sums;
    };
    const Sums truth = picture_by(Renderer::trace, Show::volume),
               found = picture_by(renderer, Show::volume);
    double squares = 0, lit = 0;
    for (std::size_t n = 0; n < truth.light.size(); ++n) {
        const Rgba &a = truth.light[n], &b = found.light[n];
        for (const float d : {a.r - b.r, a.g - b.g, a.b - b.b, a.a - b.a})
            squares += double{d} * double{d} / 4;
        lit += double{a.a};
    }
    EXPECT_GT(lit, 5);
    // Measured: 1.6e-4 to 5.1e-3.
    EXPECT_LT(std::sqrt(squares / double(truth.light.size())), 0.01);
    const Sums high = picture_by(Renderer::trace, Show::maximum),
               maximum = picture_by(renderer, Show::maximum);
    const ScalarField& field = *model->fields.find_scalar("temperature");
    std::size_t off = 0, shown = 0;
    for (std::size_t n = 0; n < high.maximum.size(); ++n) {
        if (std::isnan(high.maximum[n])) continue;
        ++shown;
        off +=
            !(std::abs(high.maximum[n] - maximum.maximum[n]) < 0.03 * (field.upper - field.lower));
    }
    // Thresholds of density at rims are met in single pixels only.
    EXPECT_LT(off, shown / 10 + 2);
}

std::string name_of_models(const testing::TestParamInfo<std::tuple<Renderer, int, int>>& of) {
    const auto& [renderer, view, cut] = of.param;
    return std::string(info_of(renderer).name) + "_" +
           views()[static_cast<std::size_t>(view)].name + "_" +
           cuts()[static_cast<std::size_t>(cut)].name;
}
INSTANTIATE_TEST_SUITE_P(requests, picture_renderer_models,
                         testing::Combine(testing::Values(Renderer::splat, Renderer::trace),
                                          testing::Range(0, 3), testing::Range(0, 4)),
                         name_of_models);

class picture_renderer_voxels : public testing::TestWithParam<std::tuple<int, int>> {};

TEST_P(picture_renderer_voxels, draw_the_closed_form_of_every_quantity) {
    const auto& [view, cut] = GetParam();
    const Camera camera = views()[static_cast<std::size_t>(view)].camera;
    const Clipping clip = cuts()[static_cast<std::size_t>(cut)].clip;
    std::vector<VoxelField> heat;
    const auto set = some_voxels(heat);
    vog::Scene scene = scene_of(set);
    std::get<VoxelSource>(scene.sources.front()).fields = {{"heat", "K", false, heat}};
    PictureRenderer drawn(scene);
    for (const Show show : kAll) {
        SCOPED_TRACE(word_of(show));
        PictureRequest request = request_of(show, "", camera, clip);
        if (is_field_map(show)) request.field = "heat";
        request.transfer.range.emplace(10, 20);
        request.transfer.unit_distance = 0.3;
        const ResolvedPicture picture = resolve(request, scene);
        Sums sums;
        drawn.draw(picture, sums);
        const Picture finished = finish(std::move(sums), picture, scene);
        EXPECT_EQ(finished.image.width, kWidth);
        each_ray(camera, [&](std::size_t n, Vec3d origin, Vec3d direction) {
            const Exact exact =
                exact_voxels(pieces_of(set->volumes.front(), heat.front(), origin, direction, clip),
                             picture.chosen.transfer.color.empty()
                                 ? over_range(named_transfer_function("gray"), 10, 20, 1)
                                 : picture.chosen.transfer);
            const Sums& got = finished.sums;
            if (show == Show::depth || show == Show::column || is_field_map(show)) {
                EXPECT_NEAR(got.column[n], exact.column, 1e-5) << n;
            }
            if (is_field_map(show) && exact.column > 1e-4) {
                EXPECT_NEAR(got.mean[n], exact.mean, 1e-4) << n;
                EXPECT_NEAR(got.deviation[n], exact.deviation, 1e-3) << n;
            }
            if (show == Show::maximum && exact.column > 1e-6) {
                EXPECT_EQ(got.maximum[n], static_cast<float>(exact.maximum)) << n;
            }
            if (show != Show::volume) return;
            EXPECT_NEAR(got.light[n].r, exact.light.r, 2e-6) << n;
            EXPECT_NEAR(got.light[n].a, exact.light.a, 2e-6) << n;
        });
    }
}

TEST_P(picture_renderer_voxels, draw_the_mean_of_several_rays_a_pixel) {
    const auto& [view, cut] = GetParam();
    const Camera camera = views()[static_cast<std::size_t>(view)].camera;
    const Clipping clip = cuts()[static_cast<std::size_t>(cut)].clip;
    std::vector<VoxelField> heat;
    const auto set = some_voxels(heat);
    const vog::Scene scene = scene_of(set);
    PictureRequest request = request_of(Show::depth, "", camera, clip);
    request.options.samples = 2;
    Sums sums;
    PictureRenderer(scene).draw(resolve(request, scene), sums);
    const CameraFrame frame = frame_of(camera, kWidth, kHeight);
    for (int row = 0; row < kHeight; row += 3)
        for (int column = 0; column < kWidth; column += 3) {
            double exact = 0;
            for (const double x : {column - 0.25, column + 0.25})
                for (const double y : {row - 0.25, row + 0.25})
                    for (const Piece& piece :
                         pieces_of(set->volumes.front(), heat.front(), frame.origin(x, y),
                                   normalized(frame.direction(x, y)), clip))
                        exact += 0.25 * (piece.last - piece.first) * piece.density;
            EXPECT_NEAR(sums.column[static_cast<std::size_t>(row * kWidth + column)], exact, 1e-5);
        }
}

std::string name_of_voxels(const testing::TestParamInfo<std::tuple<int, int>>& of) {
    const auto& [view, cut] = of.param;
    return std::string(views()[static_cast<std::size_t>(view)].name) + "_" +
           cuts()[static_cast<std::size_t>(cut)].name;
}
INSTANTIATE_TEST_SUITE_P(requests, picture_renderer_voxels,
                         testing::Combine(testing::Range(0, 3), testing::Range(0, 4)),
                         name_of_voxels);

TEST(picture_request, open_members_get_defaults_and_stated_ones_stay) {
    const auto model = some_model();
    const vog::Scene scene = scene_of(model);
    PictureRequest request;
    const ResolvedPicture plain = resolve(request, scene);
    EXPECT_EQ(*plain.request.renderer, Renderer::splat);
    EXPECT_EQ(plain.request.camera->eye, default_view(scene.subject, 512, 512).eye);
    EXPECT_EQ(plain.colors.name, default_map(Show::depth));
    EXPECT_EQ(plain.name, "T");
    request.show = Show::column;
    EXPECT_EQ(resolve(request, scene).colors.name, default_map(Show::column));
    request.show = Show::volume;
    request.field = "temperature";
    request.transfer.range.emplace(0.25, 0.75);
    const ResolvedPicture volume = resolve(request, scene);
    EXPECT_EQ(volume.chosen.scale.low, 0.25);
    EXPECT_EQ(*volume.request.transfer.unit_distance, volume.chosen.transfer.unit_distance);
    // A resolved request resolves to itself.
    const ResolvedPicture again = resolve(volume.request, scene);
    EXPECT_EQ(again.chosen.transfer, volume.chosen.transfer);
    EXPECT_EQ(again.request.field, volume.request.field);
}

TEST(picture_request, refusals_say_what_would_work) {
    const auto model = some_model();
    vog::Scene scene = scene_of(model);
    scene.name = "m.ply";
    const auto refused = [&](const PictureRequest& request) {
        return refusal([&] { (void)render(scene, request); });
    };
    PictureRequest request;
    request.width = request.height = 8;
    request.show = Show::mean;
    EXPECT_EQ(refused(request),
              "m.ply: show 'mean' needs a field, the data have temperature, density");
    request.field = "heat";
    EXPECT_NE(refused(request).find("m.ply: "), std::string::npos);
    EXPECT_NE(refused(request).find("temperature"), std::string::npos);
    request.show = Show::maximum;
    request.field = "gas velocity";
    EXPECT_NE(refused(request).find("is a vector field"), std::string::npos);
    request = {};
    request.renderer = Renderer::reference;
    EXPECT_EQ(refused(request),
              "renderer 'reference', expected 'splat', 'trace', 'cuda' or 'optix' for Gaussians");
    request = {};
    request.options.clip.box = Box{{0, 0, 0}, {1, -1, 1}};
    EXPECT_NE(refused(request).find("expected the first below the second"), std::string::npos);
    EXPECT_EQ(refusal([] { (void)show_named("light"); }),
              "show 'light', expected 'T', 'column', 'mean', 'deviation', 'volume', 'maximum' or "
              "'slice'");
}

TEST(picture_renderer, draws_from_many_cameras_with_one_preparation) {
    const auto model = some_model();
    PictureRenderer drawn(scene_of(model));
    ResolvedPicture picture =
        resolve(request_of(Show::volume, "temperature", views()[0].camera, {}), drawn.scene());
    Sums first, again;
    drawn.draw(picture, first);
    picture.request.camera = views()[2].camera;
    drawn.draw(picture, again);
    picture.request.camera = views()[0].camera;
    drawn.draw(picture, again);
    for (std::size_t n = 0; n < first.light.size(); ++n)
        EXPECT_EQ(first.light[n].a, again.light[n].a) << n;
    EXPECT_EQ(first.light.size(), std::size_t{kWidth} * kHeight);
}

TEST(picture_renderer, draws_maps_into_the_memory_of_those_before) {
    PictureRenderer drawn(scene_of(some_model()));
    const auto draw = [&](const View& view, Sums& sums) {
        drawn.draw(resolve(request_of(Show::mean, "temperature", view.camera, {}), drawn.scene()),
                   sums);
    };
    const auto memory = [](const Sums& sums) {
        return std::array{sums.column.data(), sums.mean.data(), sums.deviation.data()};
    };
    Sums sums, fresh;
    draw(views()[2], sums);
    const auto before = memory(sums);
    draw(views()[0], sums);
    EXPECT_EQ(memory(sums), before);
    draw(views()[0], fresh);
    EXPECT_EQ(sums.column, fresh.column);
    for (std::size_t n = 0; n < fresh.mean.size(); ++n)  // NaN where nothing is
        if (fresh.column[n] > 0) {
            EXPECT_EQ(sums.mean[n], fresh.mean[n]) << n;
            EXPECT_EQ(sums.deviation[n], fresh.deviation[n]) << n;
        } else {
            EXPECT_TRUE(std::isnan(sums.mean[n]) && std::isnan(sums.deviation[n])) << n;
        }
}

}  // namespace vog::test
