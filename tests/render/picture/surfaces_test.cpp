// surfaces_test.cpp: triangles and slices in volume pictures, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "support/field_models.h"
#include "support/layer_pictures.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "vog/request_schema.h"

namespace vog::test {

namespace {

/// 8^3 voxels of one value in the cube from -0.5 to 0.5.
vog::Scene cube(float value) {
    Volume volume;
    volume.name = "density";
    volume.world_from_index = {{{Vec3d{0.125, 0, 0}, {0, 0.125, 0}, {0, 0, 0.125}}},
                               {-0.4375, -0.4375, -0.4375}};
    Leaf& leaf = volume.leaves.emplace_back();
    for (int v = 0; v < kLeafVoxels; ++v) leaf.set(v, value);
    return scene_of(std::move(volume));
}

/// Gaussians around the origin, each of value 4.
vog::Scene blob() {
    Gaussians model = random_gaussians(20, 0.1, 0.2, 3);
    Random random(3);
    for (Vec3f& mean : model.mean)
        mean = vec_cast<float>(0.2 * Vec3d{random(-1, 1), random(-1, 1), random(-1, 1)});
    ScalarField& field = model.fields.scalar.emplace_back();
    field.name = "heat", field.lower = 0, field.upper = 10;
    field.value.assign(model.size(), 4);
    field.gradient.assign(model.size(), {});
    field.deviation.assign(model.size(), 0);
    field.skewness.assign(model.size(), 0);
    return scene_of(std::move(model));
}

/// Two triangles at a height, wider than the picture.
vog::Scene wall(double z, double half = 2) {
    Surface surface;
    surface.point = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    surface.triangle = {{0, 1, 2}, {0, 2, 3}};
    return scene_of(std::make_shared<const Surface>(std::move(surface)));
}

Layer fog(double opacity, const std::string& field = {}) {
    Layer layer;
    layer.field = field;
    layer.transfer.bands = {{-1e3, 1e3, 1, 0, 0, opacity}};
    layer.transfer.unit_distance = 1;
    return layer;
}
Layer painted(std::array<float, 3> color, std::optional<double> opacity = {}) {
    Layer layer;
    layer.color = color, layer.opacity = opacity;
    return layer;
}

Rgba middle_of(const std::vector<Rgba>& light) { return light[16 * 32 + 16]; }

/// Light of red fog of a depth in front of a lit colour.
void expect_behind(const Rgba& seen, double tau, const std::array<double, 3>& lit, double opacity,
                   double tau_behind, double tolerance) {
    const double through = std::exp(-tau), passed = through * (1 - opacity);
    const double red =
        1 - through + through * opacity * lit[0] + passed * (1 - std::exp(-tau_behind));
    EXPECT_NEAR(double{seen.r}, red, tolerance);
    EXPECT_NEAR(double{seen.g}, through * opacity * lit[1], tolerance);
    EXPECT_NEAR(double{seen.b}, through * opacity * lit[2], tolerance);
    EXPECT_NEAR(double{seen.a}, 1 - passed * std::exp(-tau_behind), tolerance);
}

const std::array<float, 3> kTeal{0.1f, 0.5f, 0.4f};

/// Colour of a surface that faces the eye, which is where its light is.
std::array<double, 3> facing(const std::array<float, 3>& color) {
    const VolumeLook look;
    const auto part = [&](std::size_t c) {
        return std::min((look.ambient + look.diffuse) * double{color[c]} + look.specular, 1.0);
    };
    return {part(0), part(1), part(2)};
}

}  // namespace

TEST(layers, have_one_unit_of_length_which_some_may_not_state) {
    const auto in = [](const char* unit, vog::Scene scene) {
        scene.subject.content.units.length = unit;
        return scene;
    };
    const auto unit_of = [](std::vector<vog::Scene> scenes) {
        return scene_of_layers(std::move(scenes)).subject.content.units.length;
    };
    EXPECT_EQ(unit_of({in("mm", cube(3)), wall(0)}), "mm");
    EXPECT_EQ(unit_of({in("mm", cube(3)), in("", blob()), wall(0)}), "mm");
    EXPECT_EQ(unit_of({in("", blob()), in("um", cube(3)), in("µm", cube(2))}), "um");
    EXPECT_EQ(refusal([&] {
                  (void)unit_of({in("mm", cube(3)), in("um", cube(3))});
              }),
              "layer 1: lengths in 'um', expected 'mm' as in the layers before");
}

TEST(surfaces, lie_within_the_box_that_axes_outline) {
    const Box box = outline_of(scene_of_layers({cube(3), wall(4, 1)}).subject);
    EXPECT_EQ(box.upper, (Vec3d{1, 1, 4}));
    EXPECT_EQ(box.lower, (Vec3d{-1, -1, -0.5}));
}

TEST(surfaces, hide_exactly_what_lies_behind_them_in_voxels) {
    const double per_unit = -std::log(0.3);
    for (const double z : {0.9, 0.31, 0.0, -0.4999, -0.7})
        for (const double opacity : {1.0, 0.4})
            for (const bool slabs : {false, true}) {  // a model without light draws slabs
                Layer none = fog(0, "heat");
                none.transfer.may_be_empty = true;
                std::vector<Layer> layers{fog(0.7), painted(kTeal, opacity)};
                std::vector<vog::Scene> scenes{cube(3), wall(z)};
                if (slabs) layers.push_back(none), scenes.push_back(blob());
                PictureRequest request = request_of(layers);
                request.slabs = slabs ? std::optional(7) : std::nullopt;
                const double front = std::clamp(0.5 - z, 0.0, 1.0);
                expect_behind(middle_of(light_of(scenes, request)), per_unit * front, facing(kTeal),
                              opacity, per_unit * (1 - front), 1e-5);
            }
}

TEST(surfaces, in_a_model_are_its_half_in_front_and_their_colour) {
    const Layer heat = fog(0.9, "heat");
    for (const double z : {-2.0, -0.13, 0.07, 2.0}) {
        PictureRequest request = request_of({heat, painted(kTeal)});
        request.slabs = 512;
        const std::vector<Rgba> seen = light_of({blob(), wall(z)}, request);
        PictureRequest half = request_of({heat});
        half.slabs = 512;
        half.options.clip.planes.push_back({{0, 0, 1}, z});
        std::vector<Rgba> expected = light_of({blob()}, half);
        const std::array<double, 3> lit = facing(kTeal);
        for (Rgba& pixel : expected) {
            pixel.r += (1 - pixel.a) * static_cast<float>(lit[0]);
            pixel.g += (1 - pixel.a) * static_cast<float>(lit[1]);
            pixel.b += (1 - pixel.a) * static_cast<float>(lit[2]);
            pixel.a = 1;
        }
        EXPECT_LT(largest_difference(seen, expected), 2e-3) << z;
    }
}

TEST(surfaces, in_one_slab_of_a_model_stand_at_their_share_of_it) {
    const Layer heat = fog(0.9, "heat");
    PictureRequest request = request_of({heat});
    request.slabs = 1;
    const float whole = middle_of(light_of({blob()}, request)).a;
    request.layers.push_back(painted({0, 0, 0}));
    request.look.light = true, request.look.specular = 0;
    double before = 0;
    for (const double z : {0.3, 0.1, -0.1, -0.3}) {  // red is what lies in front
        const double red = double{middle_of(light_of({blob(), wall(z)}, request)).r};
        EXPECT_GT(red, before);
        before = red;
    }
    EXPECT_LT(before, double{whole});
}

TEST(surfaces, have_no_order_among_layers) {
    const Layer heat = fog(0.9, "heat"), solid = fog(0.4);
    const Layer glass = painted({0, 0, 1}, 0.3), paint = painted(kTeal);
    EXPECT_LT(largest_difference(light_of({blob(), cube(3), wall(0.2), wall(-0.3)},
                                          request_of({heat, solid, glass, paint})),
                                 light_of({wall(-0.3), cube(3), wall(0.2), blob()},
                                          request_of({paint, solid, glass, heat}))),
              1e-6);
}

TEST(surfaces, at_one_place_mix_evenly) {
    const std::vector<Rgba> seen =
        light_of({cube(3), wall(0.8), wall(0.8)},
                 request_of({fog(0.5), painted({0, 0, 0}), painted({0.5f, 0.5f, 0.5f})}));
    EXPECT_NEAR(double{middle_of(seen).g},
                0.5 * (facing({0, 0, 0})[1] + facing({0.5f, 0.5f, 0.5f})[1]), 1e-6);
}

TEST(surfaces, have_the_colours_of_their_points) {
    Surface surface;
    surface.point = {{-2, -2, 0.8}, {2, -2, 0.8}, {0, 2, 0.8}};
    surface.triangle = {{0, 1, 2}};
    surface.color = {{0, 0, 0}, {0, 0, 0.8f}, {0, 0.6f, 0}};
    PictureRequest request = request_of({fog(0.5), {}});
    request.look.light = true, request.look.specular = 0;
    const Rgba seen =
        middle_of(light_of({cube(3), scene_of(std::make_shared<const Surface>(surface))}, request));
    // Pixel (16, 16) is half a pixel right of and below the middle.
    const double x = 1.0 / 32, y = -1.0 / 32, top = (y + 2) / 4, right = 0.5 * (1 - top) + x / 4;
    const double body = request.look.ambient + request.look.diffuse;
    EXPECT_NEAR(double{seen.g}, body * 0.6 * top, 1e-4);
    EXPECT_NEAR(double{seen.b}, body * 0.8 * right, 1e-4);
}

TEST(surfaces, cast_shadows_and_are_in_them) {
    const auto green = [](std::vector<vog::Scene> scenes, std::vector<Layer> layers) {
        PictureRequest request = request_of(std::move(layers));
        request.look.shadows = true, request.look.lights = {{{1, 0, 1}}};
        return double{middle_of(light_of(std::move(scenes), request)).g};
    };
    Layer white = fog(0.9999);
    white.transfer.bands[0].g = white.transfer.bands[0].b = 1;
    white.transfer.unit_distance = 0.01;
    Layer none = fog(0);
    none.transfer.may_be_empty = true;
    // A wall on the way of the light, beside the way to the eye.
    Surface beside;
    beside.point = {{0.7, -2, 1.6}, {2, -2, 0.3}, {2, 2, 0.3}, {0.7, 2, 1.6}};
    beside.triangle = {{0, 1, 2}, {0, 2, 3}};
    const vog::Scene blind = scene_of(std::make_shared<const Surface>(beside));
    EXPECT_LT(green({cube(3), blind}, {white, painted(kTeal)}),
              0.6 * green({cube(3), blind}, {white, painted(kTeal, 1e-4)}));
    EXPECT_LT(
        green({cube(3), wall(-0.6), blind}, {none, painted(kTeal), painted(kTeal)}),
        0.6 * green({cube(3), wall(-0.6), blind}, {none, painted(kTeal), painted(kTeal, 1e-4)}));
}

TEST(slices, in_volumes_have_the_colours_of_their_values) {
    Layer slice;
    slice.transfer.points = transfer_points(named_transfer_function("gray"));
    slice.transfer.range.emplace(0, 12);
    slice.plane = SlicePlane{"z", {}, 0.25};
    const std::vector<Rgba> alone = light_of({cube(3)}, request_of({slice}));
    EXPECT_NEAR(double{middle_of(alone).g}, 0.25, 1e-6);
    EXPECT_EQ(middle_of(alone).a, 1);
    EXPECT_EQ(alone[0], (Rgba{0, 0, 0, 0}));
    slice.opacity = 0.6;
    const double per_unit = -std::log(0.3);
    expect_behind(middle_of(light_of({cube(3), cube(3)}, request_of({fog(0.7), slice}))),
                  0.25 * per_unit, {0.25, 0.25, 0.25}, 0.6, 0.75 * per_unit, 1e-5);
    slice.transfer.threshold = 4;  // nothing is above
    slice.transfer.may_be_empty = true;
    EXPECT_EQ(middle_of(light_of({cube(3)}, request_of({slice}))), (Rgba{0, 0, 0, 0}));
}

TEST(slices, in_volumes_are_those_of_a_model_alone) {
    Layer slice;
    slice.field = "heat";
    slice.transfer.points = transfer_points(named_transfer_function("gray"));
    slice.transfer.range.emplace(0, 10);
    slice.plane = SlicePlane{"z", {}, 0.05};
    const Rgba seen = middle_of(light_of({blob()}, request_of({slice})));
    EXPECT_NEAR(double{seen.r}, 0.4, 1e-5);
    EXPECT_EQ(seen.a, 1);
}

TEST(slices, in_volumes_are_those_without_volumes) {
    TransferFunction clear = named_transfer_function("gray");
    clear.opacity = {{0, 0.1f}, {1, 0.7f}};
    for (const bool by_value : {false, true})
        for (const char* field : {"", "heat"})
            for (const TransferFunction& map : {named_transfer_function("gray"), clear}) {
                Gaussians model = *blob().model().model;
                model.content.by_value = by_value;
                model.fields.scalar.front().is_measure = true;
                const vog::Scene scene = scene_of(std::move(model));
                Layer layer;
                layer.field = field;
                layer.transfer.points = transfer_points(map);
                layer.transfer.range.emplace(0, 10);
                layer.plane = SlicePlane{"z", {}, 0.05};
                PictureRequest layered = request_of({layer}), slice = request_of({});
                slice.show = Show::slice, slice.plane = layer.plane;
                slice.field = field, slice.transfer = layer.transfer;
                // With the colours of the bar, and coordinates.
                layered.marks.color_bar = slice.marks.color_bar = true;
                EXPECT_LT(largest_difference(render(scene_of_layers({scene}), layered).image.pixel,
                                             render(scene, slice).image.pixel),
                          2e-3)
                    << by_value << field << map.opacity.size();
            }
}

TEST(surfaces, of_bad_requests_are_refused_in_one_line) {
    const auto refused = [](std::vector<vog::Scene> scenes, std::vector<Layer> layers) {
        return refusal([&] { (void)light_of(std::move(scenes), request_of(std::move(layers))); });
    };
    EXPECT_NE(refused({wall(0)}, {painted(kTeal)}).find("all hidden or surfaces"),
              std::string::npos);
    EXPECT_NE(refused({cube(3), wall(0)}, {fog(0.5), fog(0.5)}).find("a surface has no values"),
              std::string::npos);
    EXPECT_NE(refused({cube(3)}, {painted(kTeal)}).find("only a surface has a color"),
              std::string::npos);
    EXPECT_NE(refused({cube(3)}, {[] {
                          Layer layer = fog(0.5);
                          layer.opacity = 0.5;
                          return layer;
                      }()})
                  .find("use unit_distance"),
              std::string::npos);
    Layer beyond = fog(0.5);
    beyond.plane = SlicePlane{"z", {}, 7};
    EXPECT_NE(refused({cube(3)}, {beyond}).find("plane"), std::string::npos);
    Surface broken;
    broken.point = {{0, 0, 0}, {1, 0, 0}, {0, NAN, 0}};
    broken.triangle = {{0, 1, 2}};
    EXPECT_NE(refused({cube(3), scene_of(std::make_shared<const Surface>(broken))},
                      {fog(0.5), painted(kTeal)})
                  .find("expected finite points"),
              std::string::npos);
}

TEST(surfaces, are_the_same_from_words_and_json) {
    PictureRequest request;
    request.show = Show::volume;
    set_member(request, "layers",
               {"implant.stl,colour=#ff8000,opacity=0.5", "a.vdb,plane=z=0.5,tf=gray,range=0,1"});
    EXPECT_EQ(request.layers[0].color, (std::array{1.0f, 128 / 255.0f, 0.0f}));
    EXPECT_EQ(request.layers[0].opacity, 0.5);
    EXPECT_EQ(request.layers[1].plane->offset, 0.5);
    EXPECT_EQ(request.layers[1].transfer.range, (std::pair{0.0, 1.0}));
    for (Layer& layer : request.layers) layer.file.clear();
    const std::string json = request_json(request);
    EXPECT_EQ(request_json(request_of_json(json)), json);
    EXPECT_NE(refusal([&] {
                  set_member(request, "layers", {"a.stl,opacity=0"});
              }).find("opacity 0: expected a number from 0.0001 to 1"),
              std::string::npos);
}

}  // namespace vog::test
