// picture_defaults_test.cpp: defaults of pictures, and that volumes and their models share them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/dense.h"
#include "vog/error.h"
#include "vog/model_io.h"
#include "vog/picture.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

/// A cube of 8^3 voxels of one density, and a model of one Gaussian a voxel with that field.
struct Cube {
    Volume volume;
    std::vector<VoxelField> own;
    Gaussians model;

    explicit Cube(float density, double edge = 1) {
        volume.name = "density";
        volume.world_from_index = affine_from_voxels({edge, edge, edge}, {});
        Leaf& leaf = volume.leaves.emplace_back();
        for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, density);
        own.push_back(measure_field(volume, "density"));
        model = convert_moments(volume, {.block_voxels = 1, .soft_steps = 0});
        const std::vector<std::vector<VoxelField>> fields{own};
        add_fields(model, std::span(&volume, 1), fields);
    }
    ValueData of_voxels() const {
        return value_data(std::span(&volume, 1), own, world_box(volume));
    }
    ValueData of_model() const { return value_data(model, *scalar_to_show(model.fields)); }
};

TransferRequest map_of(const std::string& name) {
    TransferRequest request;
    request.points = transfer_points(name);
    return request;
}

}  // namespace

TEST(picture_defaults, cubes_have_the_closed_form_of_the_unit_distance) {
    for (const float density : {1e-20f, 0.5f, 3.0f})
        for (const double edge : {1e-3, 1.0, 1e6}) {
            // Mass density e^3, over the median and 3/2 e^2, half of it: 1/3 of the cube's edge e, to two digits.
            const Cube cube(density, edge);
            for (const ValueData& data : {cube.of_voxels(), cube.of_model()}) {
                EXPECT_TRUE(data.is_measure);
                const ColorScale scale = value_scale(data);
                EXPECT_EQ(scale.low, 0);
                EXPECT_NEAR(scale.high / double{density}, 1, 0.01);
                EXPECT_NEAR(map_unit_distance(data, scale) / (8 * edge), 1.0 / 3, 0.01);
            }
        }
}

TEST(picture_defaults, values_near_each_other_are_told_apart) {
    for (const double low : {300.0, 1013.2, 1e5, -1e5 - 1}) {
        ValueCounts counts;
        for (int n = 0; n <= 1000; ++n) counts.add(static_cast<float>(low + n / 1000.0), 1);
        ValueData data{low, low + 1, counts.spread(), {{0, 0, 0}, {1, 1, 1}}, 1, false, {}, 0};
        const ColorScale scale = value_scale(data);
        EXPECT_EQ(scale.low, low);
        EXPECT_EQ(scale.high, low + 1);
        EXPECT_NEAR(map_unit_distance(data, scale), 0.17,
                    0.01);  // opacity 1/2, of 3/2 for the box, by two
        // A few values far above do not count.
        data.upper = low + 1e4;
        EXPECT_LT(value_scale(data).high, low + 1 + std::abs(low) / 32);
    }
}

TEST(picture_defaults, percentiles_are_those_of_the_mass) {
    ValueCounts counts;
    for (int n = 1; n <= 1000; ++n) counts.add(-static_cast<float>(n), 2);
    counts.add(7, 0), counts.add(7, -1), counts.add(7, std::nan(""));
    const ValueSpread spread = counts.spread();
    EXPECT_NEAR(spread.low, -990, 5);
    EXPECT_NEAR(spread.middle, -500, 3);
    EXPECT_NEAR(spread.high, -10.5, 0.6);  // -10 or -11: a hundredth lies above
    ValueCounts twice = counts;
    twice.add(counts);
    EXPECT_EQ(twice.spread(), spread);
    EXPECT_FALSE(ValueCounts().spread().known);
    counts = {};
    counts.add(0, 1), counts.add(-0.0f, 1);
    EXPECT_EQ(counts.spread(), (ValueSpread{0, 0, 0, true}));
}

TEST(picture_defaults, ranges_are_logarithmic_where_the_data_ask) {
    using Kind = ColorScale::Kind;
    const auto of = [](double low, double middle, double high) {
        return ValueData{low / 2, high * 2, {low, middle, high, true}, {}, 1, true, {}};
    };
    const auto expect = [](const ColorScale& scale, Kind kind, double low, double high) {
        EXPECT_EQ(scale.kind, kind);
        EXPECT_DOUBLE_EQ(scale.low, low);
        EXPECT_DOUBLE_EQ(scale.high, high);
    };
    expect(value_scale(of(1, 2, 9)), Kind::linear, 1, 9);
    expect(value_scale(of(1, 2, 10)), Kind::log, 1, 10);
    expect(value_scale(of(1, 2, 10), false), Kind::linear, 1, 10);
    expect(value_scale(of(1, 2, 9), true), Kind::log, 1, 9);
    expect(value_scale(of(1e-9, 2, 10)), Kind::log, 1e-3, 10);
    expect(value_scale(of(-1, 2, 10)), Kind::linear, -1, 10);
    EXPECT_THROW((void)value_scale(of(-2, -2, -1), true), Error);
}

TEST(picture_defaults, what_has_the_least_value_is_seen_where_most_has_it) {
    const auto position = [](const ValueData& data) {
        const ColorScale scale = value_scale(data);
        EXPECT_GT(scale.high, data.spread.low);
        return scale_position(scale, data.lower);
    };
    for (const ValueSpread& spread : {ValueSpread{40, 40, 1000, true},
                                      {10, 10, 1000, true},
                                      {1, 1, 1, true},
                                      {1, 1.0078125, 1.015625, true}}) {
        const double at = position({spread.low, 5 * spread.high, spread, {}, 1, true, {}, 0});
        EXPECT_GT(at, 0.1) << spread.low << ' ' << spread.high;
        EXPECT_LT(at, 0.6) << spread.low << ' ' << spread.high;
    }
    EXPECT_EQ(position({1, 9, {1, 4, 9, true}, {}, 1, true, {}}), 0);
    EXPECT_EQ(position({0, 9, {0, 0, 9, true}, {}, 1, true, {}}), 0) << "0 is nothing";
}

TEST(picture_defaults, volumes_and_models_have_one_unit_distance) {
    for (const Volume& volume : {sample_cloud({.size = 64}), sample_explosion({.size = 64})})
        for (const MomentOptions& options :
             {MomentOptions{.block_voxels = 2, .soft_steps = 0}, MomentOptions{.budget = 500}}) {
            Gaussians model = convert_moments(volume, options);
            const std::vector<VoxelField> own{measure_field(volume, "density")};
            const std::vector<std::vector<VoxelField>> fields{own};
            add_fields(model, std::span(&volume, 1), fields);
            const ChosenTransfer voxels = choose_transfer(
                map_of("viridis"), value_data(std::span(&volume, 1), own, world_box(volume)));
            const ChosenTransfer gaussians = choose_transfer(
                map_of("viridis"), value_data(model, *scalar_to_show(model.fields)));
            EXPECT_EQ(voxels.transfer, gaussians.transfer);
            EXPECT_EQ(voxels.unit_distance, UnitDistance::of_map);
        }
}

TEST(picture_defaults, models_in_files_keep_the_spread) {
    const Volume volume = sample_explosion({.size = 64});
    const Gaussians model = convert_moments(volume, {.budget = 500, .own_field = "density"});
    const std::vector<VoxelField> own{measure_field(volume, "density")};
    const ValueSpread spread = own.front().counts.spread();
    EXPECT_TRUE(spread.known);
    EXPECT_EQ(model.fields.scalar.front().spread, spread);
    for (const char* name : {"spread.ply", "spread.vogz"}) {
        const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / name;
        write_model(file, model);
        EXPECT_EQ(read_model(file).fields.scalar.front().spread, spread) << name;
    }
    // Of another model, by its Gaussians.
    ScalarField unknown = model.fields.scalar.front();
    unknown.spread = {};
    EXPECT_NEAR(value_data(model, unknown).spread.middle / spread.middle, 1, 0.1);
}

TEST(picture_defaults, requests_keep_what_they_state) {
    const ValueData data{0, 2, {0, 1, 2, true}, {{0, 0, 0}, {1, 2, 2}}, 4, true, {}};
    TransferRequest request = map_of("gray");
    EXPECT_EQ(choose_transfer(request, data).transfer.unit_distance,
              0.25);  // half of 4 / 4, half of that
    request.log = true;
    EXPECT_EQ(choose_transfer(request, data).scale.kind, ColorScale::Kind::log);
    request.range.emplace(1, 4);
    const ValueTransfer log = choose_transfer(request, data).transfer;
    EXPECT_DOUBLE_EQ(log.color.front().value * log.color.back().value, 4);
    const ValueLight middle = light_of(log, 2);
    EXPECT_NEAR(middle.r, 0.5, 1e-3);
    EXPECT_NEAR(-std::expm1(-middle.extinction * log.unit_distance), 0.25, 1e-3);
    request.log.reset();
    EXPECT_EQ(choose_transfer(request, data).scale.kind, ColorScale::Kind::linear);
    request.range.reset();
    request.unit_distance = 7;
    EXPECT_EQ(choose_transfer(request, data).transfer.unit_distance, 7);
    request = {};
    request.window.emplace(1, 0.5);
    EXPECT_EQ(choose_transfer(request, data).transfer.unit_distance, 0.03);  // diagonal 3
    EXPECT_EQ(choose_transfer(request, data).scale.low, 0.75) << "of a colour bar: the window";
    EXPECT_EQ(choose_transfer(request, data).scale.high, 1.25);
    request.bands = {{0, 1, 1, 1, 1, 0.5}};
    EXPECT_THROW((void)choose_transfer(request, data), Error);
    request.window.reset();
    EXPECT_EQ(choose_transfer(request, data).unit_distance, UnitDistance::rough);
    request.bands = {{5, 6, 1, 1, 1, 0.5}};
    EXPECT_THROW((void)choose_transfer(request, data), Error);
    request.may_be_empty = true;
    EXPECT_NO_THROW((void)choose_transfer(request, data));
}

TEST(picture_defaults, axes_have_the_coordinates_that_a_colour_bar_has_beside_it) {
    const vog::Scene scene = scene_of(Cube(1).volume);
    PictureRequest request;
    request.show = Show::column;
    request.width = request.height = 96;
    request.marks.color_bar = true;
    request.camera = Camera{};
    request.camera->eye = {3.5, 3.5, 20}, request.camera->look_at = {3.5, 3.5, 3.5};
    const int perspective = render(scene, request).image.width;
    request.camera->orthographic_width = 12;
    EXPECT_GT(render(scene, request).image.width, perspective) << "coordinates at the left";
    request.marks.axes = true;
    EXPECT_EQ(render(scene, request).image.width, perspective) << "those of the axes alone";
}

TEST(picture_defaults, axes_far_from_the_origin_have_their_numbers) {
    const auto inked = [](double far) {
        Cube cube(1);
        cube.volume.world_from_index.translation = {far, far, far};
        PictureRequest request;
        request.show = Show::column;
        request.width = request.height = 256;
        request.marks.axes = true;
        const Image image = render(scene_of(cube.volume), request).image;
        return std::ranges::count_if(image.pixel, [](const Rgba& c) { return c.b > 0.95f; });
    };
    // The numbers of voxels at 0, and names that are longer by " - 1e9", of 17 pixels a glyph at most.
    const auto near = inked(0), far = inked(1e9);
    EXPECT_GT(far, near);
    EXPECT_LT(far, near + 3 * 6 * 17);
}

TEST(picture_defaults, colour_bars_of_one_input_have_no_name_of_a_file) {
    vog::Scene scene = scene_of(Cube(1).volume), other = scene;
    scene.name = "enzo/level0.vdb", other.name = "enzo/level1.vdb";
    PictureRequest request;
    request.show = Show::volume;
    request.width = request.height = 96;
    request.layers.resize(2);
    request.layers[1].plane = SlicePlane{"z"};
    request.marks.color_bar = true;
    const auto drawn = [&](const vog::Scene& a, const vog::Scene& b) {
        return render(scene_of_layers({a, b}), request).image;
    };
    const Image same = drawn(scene, scene);
    EXPECT_EQ(same.pixel, drawn(other, other).pixel);
    EXPECT_NE(same.pixel, drawn(scene, other).pixel);
}

TEST(picture_defaults, views_are_fitted_to_what_a_clip_leaves) {
    const Subject all = scene_of(Cube(1).volume).subject;
    PictureRequest request;
    request.options.clip.box = Box{{-3, 1, 2}, {3, 9, 3}};
    request.options.clip.planes = {{{0, -2, 0}, -6}};  // y <= 3
    Box seen;
    for (const Vec3d& point : shown_by(request, all).content.hull) seen.include(point);
    const Box expected{{-0.5, 1, 2}, {3, 3, 3}};
    EXPECT_LT(length(seen.lower - expected.lower), 0.1);
    EXPECT_LT(length(seen.upper - expected.upper), 0.1);
    EXPECT_EQ(shown_by(request, all).box.radius(), all.box.radius());
    // A plane across a corner: three points on edges, the corner, and no more than the rounding of few points leaves out.
    request.options.clip = {{}, {{{1, 1, 1}, 3 * 7.5 - 3}}};
    seen = {};
    for (const Vec3d& point : shown_by(request, all).content.hull) {
        seen.include(point);
        EXPECT_GE(point.x + point.y + point.z, 3 * 7.5 - 3 - 0.1);
    }
    EXPECT_LT(length(seen.lower - Vec3d{4.5, 4.5, 4.5}), 0.2);
    EXPECT_LT(length(seen.upper - Vec3d{7.5, 7.5, 7.5}), 0.2);
    for (const double offset : {-1e3, 1e3, 22.5}) {  // cuts nothing; leaves nothing; leaves a point
        request.options.clip = {{}, {{{1, 1, 1}, offset}}};
        Box whole;
        for (const Vec3d& point : shown_by(request, all).content.hull) whole.include(point);
        EXPECT_EQ(whole, all.content.voxels);
    }
    request.marks.axes = true;
    request.options.clip.box = Box{{0, 0, 0}, {1, 1, 1}};
    EXPECT_GT(fitted_width(default_view(all, 1, 1), shown_by(request, all)),
              fitted_width(default_view(all, 1, 1), all))
        << "axes outline all";
}

TEST(picture_defaults, data_without_extent_mass_or_range_have_one) {
    const auto scale_of = [](double value) {
        return value_scale({value, value, {value, value, value, true}, {}, 1, true, {}});
    };
    EXPECT_EQ(rough_unit_distance(ValueData{}), 1);
    EXPECT_EQ(rough_unit_distance({.box = {{1, 1, 1}, {1, 1, 1}}}), 1);
    // A hundredth of the diagonal, 6; of a field beside a density of 1000 in half of the box 1000 times as much.
    ValueData data{.box = {{0, 0, 0}, {4, 4, 2}}, .mass = 16000, .is_measure = true};
    EXPECT_EQ(rough_unit_distance(data), 0.06);
    data.is_measure = false;
    EXPECT_EQ(rough_unit_distance(data), 30);
    data.content = {{0, 0, 0}, {4, 2, 2}};
    EXPECT_EQ(rough_unit_distance(data), 60);
    EXPECT_EQ(map_unit_distance({}, scale_of(1)), 1);
    const Box box{{0, 0, 0}, {1, 2, 2}};
    EXPECT_EQ(map_unit_distance({0, 0, {}, box, 0, true, {}}, scale_of(1)), 0.03);
    EXPECT_EQ(map_unit_distance({-2, -1, {-2, -2, -1, true}, box, 1, true, {}}, scale_of(-1)),
              0.03);
    EXPECT_EQ(scale_of(3).low, 0);
    EXPECT_EQ(scale_of(3).high, 3);
    EXPECT_EQ(scale_of(-3).low, -3);
    EXPECT_EQ(scale_of(-3).high, 0);
    EXPECT_EQ(scale_of(0).high, 1);
    EXPECT_EQ(default_view(box, 0, 5).eye, default_view(box, 7, 7).eye);
}

TEST(picture_defaults, fields_and_labels) {
    Fields fields;
    EXPECT_EQ(scalar_to_show(fields), nullptr);
    EXPECT_EQ(scalar_to_begin_with(fields), nullptr);
    fields.scalar.resize(1);
    fields.scalar[0].name = "a";
    EXPECT_EQ(scalar_to_show(fields), &fields.scalar[0]);
    fields.scalar.emplace_back().name = "b";
    EXPECT_EQ(scalar_to_show(fields), nullptr);
    EXPECT_EQ(scalar_to_begin_with(fields), &fields.scalar[0]);
    fields.scalar[1].is_measure = true;
    EXPECT_EQ(scalar_to_show(fields), &fields.scalar[1]);
    EXPECT_EQ(scalar_to_show(fields, "a"), &fields.scalar[0]);
    EXPECT_EQ(scalar_to_show(fields, "c"), nullptr);
    EXPECT_EQ(quantity_label(Show::depth, ""), "optical depth T");
    EXPECT_EQ(quantity_label(Show::column, "", "g/cm2"), "column density [g/cm2]");
    EXPECT_EQ(quantity_label(Show::mean, "heat", "K"), "heat [K]");
    EXPECT_EQ(quantity_label(Show::maximum, "heat", "K"), "maximum of heat [K]");
}

}  // namespace vog::test
