// slice_test.cpp: slices of models, voxels and levels on a plane and averaged across it, against brute force in double precision;
// their views, and planes that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "support/field_models.h"
#include "support/level_volumes.h"
#include "support/random_volume.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

constexpr int kSliceWidth = 37, kSliceHeight = 29;

struct Sum {
    double density = 0, value = 0;  ///< value: density times the field
};

/// A pixel's point on a plane, by the definition of the two cameras.
std::optional<Vec3d> point_on(const Camera& camera, Vec3d normal, double offset, double column,
                              double row) {
    const Vec3d forward = normalized(camera.look_at - camera.eye);
    const Vec3d right = normalized(cross(forward, camera.up)), up = cross(right, forward);
    const double edge =
        camera.orthographic()
            ? camera.orthographic_width / kSliceWidth
            : 2 * std::tan(camera.fov_degrees * std::numbers::pi / 360) / kSliceHeight;
    const Vec3d beside = (edge * (column - 0.5 * (kSliceWidth - 1))) * right -
                         (edge * (row - 0.5 * (kSliceHeight - 1))) * up;
    const Vec3d origin = camera.orthographic() ? camera.eye + beside : camera.eye;
    const Vec3d direction = camera.orthographic() ? forward : forward + beside;
    const double t = (offset - dot(normal, origin)) / dot(normal, direction);
    return t >= 0 ? std::optional(origin + t * direction) : std::nullopt;
}

/// All Gaussians at a point, by the definition of the model.
Sum model_at(const Gaussians& model, const BigVector<float>& value, const BigVector<Vec3f>& slope,
             Vec3d point) {
    Sum sum;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3d from = point - model.origin - vec_cast<double>(model.mean[i]);
        const Vec3d own = transpose(matrix_from_quat(model.rotation[i])) * from;
        const Vec3f s = model.scale[i];
        const double q = std::pow(own.x / double{s.x}, 2) + std::pow(own.y / double{s.y}, 2) +
                         std::pow(own.z / double{s.z}, 2);
        if (q > double{model.cutoff} * double{model.cutoff}) continue;
        const double w = double{model.density[i]} * std::exp(-q / 2);
        sum.density += w;
        sum.value += w * (double{value[i]} + dot(vec_cast<double>(slope[i]), from));
    }
    return sum;
}

Gaussians sliced_model(Vec3d origin = {}) {
    Gaussians model = random_gaussians(60, 0.1, 0.5, 5);
    if (model.rotation.empty()) model.rotation.resize(model.size(), Quat{1, 0, 0, 0});
    add_random_fields(model, 11);
    model.origin = origin;
    model.box = {};
    return model;
}

PictureRequest slice_of(Vec3d normal, double offset, const std::string& field = "") {
    PictureRequest request;
    request.show = Show::slice;
    request.field = field;
    request.width = kSliceWidth, request.height = kSliceHeight;
    request.plane = {"", normal, offset};
    return request;
}
PictureRequest slice_of(const std::string& axis, std::optional<double> at = {}) {
    PictureRequest request = slice_of(Vec3d{}, 0);
    request.plane = {axis, {}, at};
    return request;
}

/// Cameras that a slice may have: its own, and a pinhole that sees the plane from the side and past its horizon.
std::vector<std::optional<Camera>> cameras() {
    Camera pinhole;
    pinhole.eye = {1.5, 0.4, 0.9}, pinhole.look_at = {0, 0, 0}, pinhole.fov_degrees = 70;
    return {std::nullopt, pinhole};
}

}  // namespace

TEST(slices, of_models_are_the_sum_of_their_gaussians_and_its_mean_field) {
    const Vec3d normal{0.2, -0.5, 1.1};
    const Vec3d far{40, 7, -3};
    for (const Vec3d origin : {Vec3d{}, far})
        for (const auto& camera : cameras()) {
            const Gaussians model = sliced_model(origin);
            const double offset = 0.07 + dot(normal, origin);
            PictureRequest request = slice_of(normal, offset, "temperature");
            request.camera = camera;
            if (camera) request.camera->eye = camera->eye + origin;
            if (camera) request.camera->look_at = camera->look_at + origin;
            const Clipping half{std::nullopt, {{{1, 0.2, 0}, -0.3 + dot({1, 0.2, 0}, origin)}}};
            request.options.clip = half;
            const ScalarField& field = *model.fields.find_scalar("temperature");
            const Picture mean = render(scene_of(Gaussians(model)), request);
            request.field.clear();
            const Picture density = render(scene_of(Gaussians(model)), request);
            int shown = 0;
            for (int row = 0; row < kSliceHeight; ++row)
                for (int column = 0; column < kSliceWidth; ++column) {
                    const auto n = static_cast<std::size_t>(row * kSliceWidth + column);
                    const auto at = point_on(mean.made.camera(), normal, offset, column, row);
                    const bool kept = at && dot({1, 0.2, 0}, *at) >= half.planes[0].offset;
                    const Sum sum =
                        kept ? model_at(model, field.value, field.gradient, *at) : Sum{};
                    ASSERT_EQ(std::isnan(density.values()[n]), !(sum.density > 0)) << n;
                    ASSERT_EQ(std::isnan(mean.values()[n]), !(sum.density > 0)) << n;
                    if (!(sum.density > 0)) continue;
                    ++shown;
                    EXPECT_NEAR(density.values()[n], sum.density, 1e-5 * sum.density) << n;
                    EXPECT_NEAR(mean.values()[n], sum.value / sum.density,
                                1e-5 * std::max(std::abs(field.lower), std::abs(field.upper)))
                        << n;
                }
            EXPECT_GT(shown, 100);
        }
}

TEST(slices, of_vector_fields_are_of_their_parts) {
    const Gaussians model = sliced_model();
    const VectorField& field = model.fields.vector.front();
    const vog::Scene scene = scene_of(Gaussians(model));
    const Vec3d normal{0, 0.6, 0.8};
    const auto values = [&](const std::string& part) {
        const auto shown = render(scene, slice_of(normal, 0.05, field.name + part));
        return std::vector<float>(shown.values().begin(), shown.values().end());
    };
    const auto x = values(".x"), y = values(".y"), z = values(".z"), view = values("");
    for (std::size_t n = 0; n < x.size(); ++n) {
        if (std::isnan(x[n])) continue;
        // Away from the eye, which is on the side of the normal.
        const double along = -(0.6 * double{y[n]} + 0.8 * double{z[n]});
        EXPECT_NEAR(view[n], along, 1e-6 * std::hypot(x[n], y[n], z[n])) << n;
        EXPECT_GE(values(".magnitude")[n] * (1 + 1e-4f), std::hypot(x[n], y[n], z[n])) << n;
        if (n % 97 == 0) break;
    }
}

TEST(slices, averaged_across_are_the_mean_over_planes) {
    const Gaussians model = sliced_model();
    const ScalarField& field = *model.fields.find_scalar("temperature");
    const Vec3d normal{0.2, -0.5, 1.1};
    constexpr double kThickness = 0.4;
    for (const std::string name : {"", "temperature"}) {
        PictureRequest request = slice_of(normal, 0.07, name);
        request.thickness = kThickness;
        const Picture thick = render(scene_of(Gaussians(model)), request);
        for (int pixel = 0; pixel < kSliceWidth * kSliceHeight; pixel += 53) {
            constexpr int kPlanes = 400;
            Sum sum;
            for (int k = 0; k < kPlanes; ++k) {
                const double off = 0.07 + ((k + 0.5) / kPlanes - 0.5) * kThickness * length(normal);
                const auto at = point_on(thick.made.camera(), normal, off, pixel % kSliceWidth,
                                         pixel / kSliceWidth);
                const Sum one = model_at(model, field.value, field.gradient, *at);
                sum.density += one.density / kPlanes, sum.value += one.value / kPlanes;
            }
            const float got = thick.values()[static_cast<std::size_t>(pixel)];
            if (sum.density < 1e-3) continue;
            // Steps of the midpoint rule at the ends of supports.
            const double expected = name.empty() ? sum.density : sum.value / sum.density;
            EXPECT_NEAR(
                got, expected,
                name.empty() ? 0.01 * sum.density + 1e-3 : 0.02 * (field.upper - field.lower))
                << pixel;
        }
    }
}

TEST(slices, of_voxels_are_the_voxels_that_hold_the_points) {
    VolumeMaker maker;
    maker.volume.name = "density";
    maker.volume.world_from_index = {{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.25}}}, {1, 2, 3}};
    Random random(3);
    std::array<std::array<std::array<float, 9>, 9>, 9> value{};
    for (int x = 0; x < 9; ++x)
        for (int y = 0; y < 9; ++y)
            for (int z = 0; z < 9; ++z) {
                float& at = value[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)]
                                 [static_cast<std::size_t>(z)];
                at = -1;  // inactive
                if (random() < 0.3) continue;
                at = random() < 0.2 ? 0.0f : static_cast<float>(random(0.1, 2));
                maker.box({x, y, z}, {x, y, z}, at);
            }
    const Volume volume = maker.finish();
    VoxelField field = own_field(volume);
    field.name = "heat";
    for (auto& leaf : field.component.front().leaf)
        for (float& one : leaf) one = 10 + 3 * one;
    auto set = std::make_shared<VolumeSet>();
    set->volumes.push_back(volume);
    vog::Scene scene = scene_of(std::shared_ptr<const VolumeSet>(set));
    std::get<VoxelSource>(scene.sources.front()).fields = {{"heat", "K", false, {field}}};
    const Vec3d normal{0.3, -0.2, 0.9};
    const double offset = dot(normal, {3, 4.1, 4});
    const Picture density = render(scene, slice_of(normal, offset)),
                  heat = render(scene, slice_of(normal, offset, "heat"));
    EXPECT_EQ(heat.made.unit, "K");
    int zero = 0, shown = 0;
    for (int row = 0; row < kSliceHeight; ++row)
        for (int column = 0; column < kSliceWidth; ++column) {
            const auto n = static_cast<std::size_t>(row * kSliceWidth + column);
            const Vec3d at = *point_on(density.made.camera(), normal, offset, column, row);
            const int i[] = {static_cast<int>(std::floor((at.x - 1) / 0.5 + 0.5)),
                             static_cast<int>(std::floor((at.y - 2) / 0.5 + 0.5)),
                             static_cast<int>(std::floor((at.z - 3) / 0.25 + 0.5))};
            const bool inside = std::ranges::all_of(i, [](int k) { return k >= 0 && k < 9; });
            const float expected =
                inside ? value[static_cast<std::size_t>(i[0])][static_cast<std::size_t>(i[1])]
                              [static_cast<std::size_t>(i[2])]
                       : -1;
            if (expected < 0) {
                EXPECT_TRUE(std::isnan(density.values()[n])) << n;
                EXPECT_TRUE(std::isnan(heat.values()[n])) << n;
                continue;
            }
            ++shown, zero += expected == 0;
            EXPECT_EQ(density.values()[n], expected) << n;
            EXPECT_NEAR(heat.values()[n], 10 + 3 * expected, 1e-5) << n;
        }
    EXPECT_GT(shown, 200);
    EXPECT_GT(zero, 20);
}

TEST(slices, of_levels_are_the_finest_that_is_active) {
    // Densities 1 and 2: the inner cube has voxels of half the size, and lies from 4 to 8.
    Levels levels = nested_cubes(16, {{}, {0.5, 0.5, 0.5}}, {{2, {3.5, 3.5, 3.5}, 8}}, 1);
    for (Leaf& leaf : levels.volumes[1].leaves)
        for (float& value : leaf.value) value *= 2;
    auto set = std::make_shared<VolumeSet>();
    static_cast<Levels&>(*set) = levels;
    set->overlap = Overlap::hide;
    PictureRequest request = slice_of("z", 6);
    request.width = request.height = 32;
    const vog::Scene scene = scene_of(std::shared_ptr<const VolumeSet>(set));
    for (const std::optional<double> thickness : {std::optional<double>{}, std::optional(0.5)}) {
        request.thickness = thickness;
        const Picture picture = render(scene, request);
        for (int row = 0; row < 32; ++row)
            for (int column = 0; column < 32; ++column) {
                const double x = (column + 0.5) / 2, y = (31 - row + 0.5) / 2;
                const bool inner = x > 4 && x < 8 && y > 4 && y < 8;
                EXPECT_NEAR(picture.values()[static_cast<std::size_t>(row * 32 + column)],
                            inner ? 2 : 1, 1e-6)
                    << column << ", " << row;
            }
    }
}

TEST(slices, have_the_files_values_where_densities_are_above_a_background) {
    Volume volume = cube_of(8, 100, {{}, {0.5, 0.5, 0.5}});
    volume.background = -1000;
    volume.name = "ct";
    const Picture voxels = render(scene_of(Volume(volume)), slice_of("x", 4));
    EXPECT_EQ(voxels.values()[kSliceHeight / 2 * kSliceWidth + kSliceWidth / 2], -900);
    EXPECT_EQ(voxels.made.name, "ct");
    Gaussians model = sliced_model();
    model.fields = {};
    model.fields.scalar.push_back({"ct", "HU", -1000, 100, true, {}, {}, {}, {}, {}, -1000});
    ScalarField& field = model.fields.scalar.front();
    field.value.resize(model.size()), field.gradient.resize(model.size());
    field.deviation.resize(model.size()), field.skewness.resize(model.size());
    const Picture of_model = render(scene_of(Gaussians(model)), slice_of("x", 0));
    EXPECT_EQ(with_unit(of_model.made.name, of_model.made.unit), "ct [HU]");
    // Models fitted to values show their mean.
    Gaussians fitted = model;
    fitted.content.by_value = true;
    PictureRequest mean = slice_of("x", 0);
    mean.field = "ct";
    const Picture stated = render(scene_of(Gaussians(model)), mean);
    const Picture chosen = render(scene_of(std::move(fitted)), slice_of("x", 0));
    EXPECT_EQ(chosen.made.request.field, "ct");
    ASSERT_EQ(chosen.values().size(), stated.values().size());
    for (std::size_t n = 0; n < chosen.values().size(); ++n)
        EXPECT_TRUE(chosen.values()[n] == stated.values()[n] || std::isnan(chosen.values()[n]));
    field.background = 0;
    const Picture above = render(scene_of(Gaussians(model)), slice_of("x", 0));
    for (std::size_t n = 0; n < above.values().size(); ++n)
        if (!std::isnan(above.values()[n])) {
            EXPECT_NEAR(of_model.values()[n], above.values()[n] - 1000, 1e-3);
        }
}

TEST(slices, look_along_the_normal_at_the_section_of_the_data) {
    Subject subject(Box{{1, 2, 3}, {5, 4, 13}});
    const auto axes_of = [&](const char* axis, Vec3d normal, double offset) {
        const Camera camera = slice_view(subject, {axis, normal, offset}, 200, 100);
        const CameraFrame frame = frame_of(camera, 200, 100);
        EXPECT_NEAR(length(cross(frame.forward, normal)), 0, 1e-12);
        EXPECT_NEAR(dot(camera.look_at, normal), offset, 1e-12);
        return std::array{frame.right, frame.up, Vec3d{camera.orthographic_width, 0, 0}};
    };
    const auto near = [](Vec3d a, Vec3d b) { EXPECT_NEAR(length(a - b), 0, 1e-12); };
    const auto z = axes_of("z", {0, 0, 1}, 7);
    near(z[0], {1, 0, 0}), near(z[1], {0, 1, 0});
    EXPECT_NEAR(z[2].x, 4, 1e-12);
    const auto x = axes_of("x", {1, 0, 0}, 2);
    near(x[0], {0, 1, 0}), near(x[1], {0, 0, 1});
    EXPECT_NEAR(x[2].x, 20, 1e-12) << "10 high, twice as wide";
    const auto y = axes_of("y", {0, 1, 0}, 3);
    near(y[0], {0, 0, 1}), near(y[1], {1, 0, 0});
    EXPECT_NEAR(y[2].x, 10, 1e-12);
    // A patient in right, anterior, superior: the right is at the left.
    subject.content.standing = {{0, 0, 1}, {0, 1, 0}};
    near(axes_of("axial", {0, 0, 1}, 7)[0], {-1, 0, 0});
    near(axes_of("axial", {0, 0, 1}, 7)[1], {0, 1, 0});
    near(axes_of("coronal", {0, 1, 0}, 3)[0], {-1, 0, 0});
    near(axes_of("sagittal", {1, 0, 0}, 3)[0], {0, -1, 0});
    near(axes_of("sagittal", {1, 0, 0}, 3)[1], {0, 0, 1});
}

TEST(slices, are_the_same_from_their_record_and_for_any_number_of_threads) {
    const vog::Scene scene = scene_of(sliced_model());
    PictureRequest request = slice_of("y");
    request.field = "temperature";
    const Picture first = render(scene, request);
    const std::vector<float> values(first.values().begin(), first.values().end());
    const std::string json = request_json(first.made.request);
    EXPECT_NE(json.find("\"plane\":\"y="), std::string::npos) << json;
    const ThreadLimit one(1);
    const Picture again = render(scene, request_of_json(json));
    EXPECT_EQ(request_json(again.made.request), json);
    for (std::size_t n = 0; n < values.size(); ++n)
        if (!std::isnan(values[n])) {
            EXPECT_EQ(values[n], again.values()[n]) << n;
        }
}

TEST(slices, outside_of_the_data_and_of_no_plane_are_refused) {
    const vog::Scene scene = scene_of(sliced_model());
    const auto refused = [&](const PictureRequest& request) {
        return refusal([&] { (void)resolve(request, scene); });
    };
    EXPECT_NE(refused(slice_of("z", 9)).find("plane z=9: lies outside of the data"),
              std::string::npos);
    EXPECT_NE(refused(slice_of("axial")).find("plane axial: the data do not say"),
              std::string::npos);
    PictureRequest none = slice_of("z");
    none.plane.reset();
    EXPECT_NE(refused(none).find("show 'slice' has no effect without `plane`"), std::string::npos);
    PictureRequest traced = slice_of("z", 0);
    traced.renderer = Renderer::trace;
    EXPECT_NE(refused(traced).find("plane is not for renderer 'trace', expected 'splat' or "
                                   "'reference'"),
              std::string::npos);
    for (const char* json : {R"({"plane": [0, 0, 0, 1]})", R"({"plane": "w=1"})",
                             R"({"plane": "z=a"})", R"({"plane": [1, 0, 0]})", R"({"plane": 3})",
                             R"({"thickness": 0})", R"({"thickness": -1})"})
        EXPECT_NE(refusal([&] { (void)request_of_json(json); }).find(": expected "),
                  std::string::npos)
            << json;
    PictureRequest thick = slice_of("z", 9);
    thick.thickness = 100;
    EXPECT_EQ(refused(thick), "no error");
}

}  // namespace vog::test
