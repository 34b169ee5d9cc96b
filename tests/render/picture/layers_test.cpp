// layers_test.cpp: volume pictures of several layers, against closed forms and against pictures of one layer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "shade/values/label_table.h"
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

/// A cube of 8^3 voxels of one value.
/// lower  corner, world units
vog::Scene cube(Vec3d lower, double edge, float value) {
    Volume volume;
    volume.name = "density";
    const double voxel = edge / 8;
    volume.world_from_index = {{{Vec3d{voxel, 0, 0}, {0, voxel, 0}, {0, 0, voxel}}},
                               lower + Vec3d{voxel / 2, voxel / 2, voxel / 2}};
    Leaf& leaf = volume.leaves.emplace_back();
    for (int v = 0; v < kLeafVoxels; ++v) leaf.set(v, value);
    return scene_of(std::move(volume));
}

/// Gaussians around a point, each with one value.
vog::Scene blob(Vec3d at, float value, std::uint64_t seed) {
    Gaussians model = random_gaussians(20, 0.1, 0.2, seed);
    Random random(seed);
    for (Vec3f& mean : model.mean)
        mean = vec_cast<float>(at + 0.2 * Vec3d{random(-1, 1), random(-1, 1), random(-1, 1)});
    ScalarField& field = model.fields.scalar.emplace_back();
    field.name = "heat", field.lower = 0, field.upper = 10;
    field.value.assign(model.size(), value);
    field.gradient.assign(model.size(), {});
    field.deviation.assign(model.size(), 0);
    field.skewness.assign(model.size(), 0);
    return scene_of(std::move(model));
}

/// Values of a colour and an opacity over a unit of length.
Layer layer_of(std::array<float, 3> color, double opacity, const std::string& field = {}) {
    Layer layer;
    layer.field = field;
    layer.transfer.bands = {{-1e3, 1e3, color[0], color[1], color[2], opacity}};
    layer.transfer.unit_distance = 1;
    return layer;
}

std::vector<Rgba> alone(const vog::Scene& scene, const Layer& layer,
                        Interpolation interpolation = Interpolation::constant) {
    PictureRequest request = request_of({});
    request.options.voxels.interpolation = interpolation;
    request.field = layer.field, request.transfer = layer.transfer;
    return render(scene, request).sums.light;
}

/// The first picture in front of the second.
std::vector<Rgba> in_front(const std::vector<Rgba>& near, const std::vector<Rgba>& far) {
    std::vector<Rgba> all = near;
    for (std::size_t n = 0; n < all.size(); ++n)
        for (const auto part : {&Rgba::r, &Rgba::g, &Rgba::b, &Rgba::a})
            all[n].*part += (1 - near[n].a) * far[n].*part;
    return all;
}

constexpr std::array<float, 3> kRed{1, 0, 0}, kBlue{0, 0, 1}, kGreen{0, 0.5f, 0.25f};

}  // namespace

TEST(layers, of_voxels_add_up_where_they_overlap) {
    // From front to back: half a unit of red, half a unit of both, half a unit of blue.
    const std::vector<Rgba> light =
        light_of({cube({-0.5, -0.5, -0.5}, 1, 3), cube({-0.5, -0.5, 0}, 1, 5)},
                 request_of({layer_of(kBlue, 0.3), layer_of(kRed, 0.6)}));
    const double red = -std::log(0.4), blue = -std::log(0.7);
    double passed = 1, seen_red = 0, seen_blue = 0;
    for (const auto& [r, b] : {std::pair{red, 0.0}, {red, blue}, {0.0, blue}}) {
        const double through = std::exp(-0.5 * (r + b)), part = passed * (1 - through) / (r + b);
        seen_red += part * r, seen_blue += part * b;
        passed *= through;
    }
    const Rgba middle = light[16 * 32 + 16];
    EXPECT_NEAR(middle.r, seen_red, 1e-6);
    EXPECT_NEAR(middle.b, seen_blue, 1e-6);
    EXPECT_NEAR(middle.a, 1 - passed, 1e-6);
    EXPECT_EQ(light[0], (Rgba{0, 0, 0, 0}));
}

TEST(layers, one_alone_is_its_own_picture) {
    const Layer layer = layer_of(kGreen, 0.7), heat = layer_of(kRed, 0.7, "heat");
    const vog::Scene voxels = cube({-0.7, -0.4, -0.5}, 1, 3), model = blob({}, 4, 3);
    EXPECT_LT(largest_difference(light_of({voxels}, request_of({layer})), alone(voxels, layer)),
              1e-6);
    // Sums of slabs in floats, and their logarithms.
    EXPECT_LT(largest_difference(light_of({model}, request_of({heat})), alone(model, heat)), 2e-5);
}

TEST(layers, twice_the_same_is_twice_the_extinction) {
    const vog::Scene model = blob({}, 4, 3);
    Layer once = layer_of(kRed, 0.5, "heat"), dense = once;
    dense.transfer.unit_distance = 0.5;
    EXPECT_LT(
        largest_difference(light_of({model, model}, request_of({once, once})), alone(model, dense)),
        5e-5);
}

TEST(layers, have_no_order) {
    const vog::Scene model = blob({0.1, 0, 0.1}, 4, 3), other = blob({}, 6, 5),
                     voxels = cube({-0.6, -0.6, -0.6}, 1, 3);
    const Layer a = layer_of(kRed, 0.8, "heat"), b = layer_of(kBlue, 0.9, "heat"),
                c = layer_of(kGreen, 0.4);
    EXPECT_LT(largest_difference(light_of({model, other, voxels}, request_of({a, b, c})),
                                 light_of({voxels, other, model}, request_of({c, b, a}))),
              1e-6);
}

TEST(layers, voxels_and_models_hide_each_other) {
    const Layer solid = layer_of(kGreen, 0.8), heat = layer_of(kRed, 0.9, "heat");
    const vog::Scene voxels = cube({-0.5, -0.5, -0.5}, 1, 3);
    for (const double z : {-2.0, 2.0}) {
        const vog::Scene model = blob({0.2, 0.1, z}, 4, 3);
        const std::vector<Rgba> own = alone(voxels, solid), other = alone(model, heat);
        PictureRequest request = request_of({solid, heat});
        request.slabs = 256;
        EXPECT_LT(largest_difference(light_of({voxels, model}, request),
                                     z > 0 ? in_front(other, own) : in_front(own, other)),
                  5e-3)
            << z;  // one of 256 slabs may hold parts of both
        EXPECT_GT(largest_difference(own, in_front(other, own)), 0.1);
    }
}

TEST(layers, voxels_are_the_same_beside_a_model_that_is_not_seen) {
    // Two values in one slab: the nearer one hides the other.
    Volume volume;
    volume.name = "density";
    Leaf& leaf = volume.leaves.emplace_back();
    for (int v = 0; v < kLeafVoxels; ++v) leaf.set(v, v & 1 ? 1.0f : 3.0f);
    volume.world_from_index = {{{Vec3d{0.125, 0, 0}, {0, 0.125, 0}, {0, 0, 0.125}}},
                               {-0.45, -0.45, -0.45}};
    const vog::Scene voxels = scene_of(std::move(volume));
    Layer two = layer_of(kRed, 0.5);
    two.transfer.bands = {{0, 2, 1, 0, 0, 0.999}, {2, 4, 0, 0, 1, 0.999}};
    Layer none = layer_of(kBlue, 0, "heat");
    none.transfer.may_be_empty = true;
    PictureRequest request = request_of({two, none});
    request.slabs = 3;
    EXPECT_LT(largest_difference(light_of({voxels, blob({}, 4, 3)}, request), alone(voxels, two)),
              1e-5);
}

TEST(layers, are_interpolated_where_they_have_voxels_of_values) {
    vog::Scene values = cube({-0.5, -0.5, -0.5}, 1, 3);
    Volume volume = values.voxels().volumes->volumes.front();
    for (int v = 0; v < kLeafVoxels; ++v)
        volume.leaves.front().set(v, 1 + static_cast<float>(v & 7));
    values = scene_of(std::move(volume));
    const vog::Scene segments = cube({-0.5, -0.5, 1}, 1, 3), model = blob({0.1, 0, 2}, 4, 3);
    Layer bands = layer_of(kGreen, 0.8), labels, heat = layer_of(kRed, 0.9, "heat");
    bands.transfer.bands = {{2.5, 4.2, 1, 0, 0, 0.9}, {5.1, 8, 0, 0, 1, 0.5}};
    labels.transfer.points = shading::label_points("3 liver 255 128 0 200\n", "", "");
    labels.transfer.unit_distance = 1;
    const std::vector<Rgba> smooth = alone(values, bands, Interpolation::linear);
    EXPECT_GT(largest_difference(smooth, alone(values, bands)), 0.05);
    const auto linear = [&](const std::vector<vog::Scene>& scenes, std::vector<Layer> layers) {
        PictureRequest request = request_of(std::move(layers));
        if (!scenes.back().has_voxels()) request.slabs = 256;
        request.options.voxels.interpolation = Interpolation::linear;
        return light_of(scenes, request);
    };
    EXPECT_LT(largest_difference(linear({values, segments}, {bands, labels}),
                                 in_front(alone(segments, labels), smooth)),
              1e-5);
    EXPECT_LT(largest_difference(linear({values, model}, {bands, heat}),
                                 in_front(alone(model, heat), smooth)),
              5e-3);
    for (const bool has_labels : {true, false})
        EXPECT_NE(refusal([&] {
                      if (has_labels)
                          linear({segments}, {labels});
                      else
                          linear({model}, {heat});
                  }).find("no layer draws voxels other than labels and planes; expected constant"),
                  std::string::npos);
}

TEST(layers, shadow_each_other) {
    const vog::Scene floor = cube({-0.5, -1.5, -0.5}, 1, 3), roof = blob({0, 0.8, 0}, 4, 3);
    const auto brightness = [&](bool with_roof) {
        PictureRequest request =
            request_of({layer_of({1, 1, 1}, 0.9), layer_of({0, 0, 0}, 0.999, "heat")});
        request.layers[1].visible = with_roof;
        request.look.shadows = true, request.look.lights = {{{0, 1, 0}}};
        double sum = 0;
        for (const Rgba& pixel : light_of({floor, with_roof ? roof : vog::Scene{}}, request))
            sum += double{pixel.r};
        return sum;
    };
    EXPECT_LT(brightness(true), 0.9 * brightness(false));
}

TEST(layers, one_alone_has_the_light_of_its_own_picture) {
    const Layer heat = layer_of(kRed, 0.9, "heat"), solid = layer_of(kGreen, 0.9);
    const auto differ = [](const vog::Scene& scene, const Layer& layer) {
        PictureRequest layered = request_of({layer}), own = request_of({});
        own.field = layer.field, own.transfer = layer.transfer;
        layered.look.studio = own.look.studio = true;
        return largest_difference(light_of({scene}, layered), render(scene, own).sums.light);
    };
    EXPECT_LT(differ(blob({}, 4, 3), heat), 1e-4);
    EXPECT_LT(differ(cube({-0.7, -0.4, -0.5}, 1, 3), solid), 1e-6);
}

TEST(layers, that_are_hidden_are_not_drawn) {
    const vog::Scene model = blob({}, 4, 3);
    Layer shown = layer_of(kRed, 0.5, "heat"), hidden = layer_of(kBlue, 0.9, "heat");
    hidden.visible = false;
    EXPECT_EQ(light_of({model, {}}, request_of({shown, hidden})),
              light_of({model}, request_of({shown})));
    EXPECT_NE(refusal([&] { (void)scene_of_layers({vog::Scene{}}); }).find("all hidden"),
              std::string::npos);
}

TEST(layers, are_called_by_their_files_without_extensions) {
    const auto picture = [](const char* first, const char* second) {
        PictureRequest request = request_of({layer_of({1, 0, 0}, 0.7), layer_of({0, 1, 0}, 0.7)});
        request.width = request.height = 256;
        request.marks.color_bar = true;
        std::vector<vog::Scene> scenes{cube({0, 0, 0}, 1, 3), cube({-1, 0, 0}, 1, 2)};
        scenes[0].name = first, scenes[1].name = second;
        return render(scene_of_layers(std::move(scenes)), request).image.pixel;
    };
    const auto plain = picture("head.nii", "lung.vdb");
    EXPECT_TRUE(picture("a/head.nii.gz", "lung.NVDB.GZ") == plain);
    EXPECT_FALSE(picture("hand.nii.gz", "lung.vdb") == plain);
}

TEST(layers, are_the_same_from_words_and_json) {
    PictureRequest request;
    request.show = Show::volume;
    set_member(request, "layers",
               {"stars.ply,field=heat,tf=inferno,range=0,1,unit-distance=2",
                "band=0,1,red,0.5,iso=2,#00ff00", "window=40,80"});
    ASSERT_EQ(request.layers.size(), 3u);
    EXPECT_EQ(request.layers[0].file, "stars.ply");
    EXPECT_EQ(request.layers[0].field, "heat");
    EXPECT_EQ(request.layers[0].transfer.range, (std::pair{0.0, 1.0}));
    EXPECT_EQ(request.layers[0].transfer.unit_distance, 2);
    EXPECT_EQ(request.layers[1].transfer.bands.size(), 2u);
    EXPECT_TRUE(request.layers[1].file.empty());
    EXPECT_EQ(request.layers[2].transfer.window, (std::pair{40.0, 80.0}));
    request.layers[0].file.clear();
    const std::string json = request_json(request);
    EXPECT_EQ(request_json(request_of_json(json)), json);
}

TEST(layers, of_channels_have_their_colours) {
    const auto layers = [](const std::vector<std::string>& grids) {
        std::vector<Channel> channels;
        for (const std::string& grid : grids) channels.push_back({grid, grid == "c2" ? 0.0 : 9.0});
        return layers_of_channels(channels);
    };
    const auto colors = [&](const std::vector<std::string>& grids) {
        std::string all;
        for (const Layer& layer : layers(grids))
            all += layer.grid + ' ' + layer.transfer.points.points.name + ' ';
        return all;
    };
    EXPECT_EQ(colors({"c0", "c1", "c2", "c3"}), "c0 magenta c1 lime c3 yellow ");
    EXPECT_FALSE(layers({"c0", "c1"})[0].transfer.range);
    EXPECT_EQ(layers({"red", "green", "blue"})[1].transfer.range, (std::pair{0.0, 9.0}));
    EXPECT_EQ(colors({"red", "green", "blue", "alpha"}), "red red green lime blue blue ");
    EXPECT_EQ(colors({"c0"}), "");
    EXPECT_EQ(colors({"t0", "t1"}), "");
    EXPECT_EQ(colors({"density", "temperature"}), "");
}

TEST(layers, of_one_file_under_one_range_have_one_unit_distance) {
    const vog::Scene scenes[] = {cube({0, 0, 0}, 1, 1), cube({0, 0, 0}, 1, 0.1f)};
    const auto units = [&](std::size_t other_input, double other_most) {
        PictureRequest request = request_of({});
        request.layers.resize(2);
        for (Layer& layer : request.layers) {
            layer.transfer.points = transfer_points("red");
            layer.transfer.range.emplace(0, 1);
        }
        request.layers[1].input = other_input;
        request.layers[1].transfer.range->second = other_most;
        const ResolvedPicture made = resolve(request, scene_of_layers({scenes[0], scenes[1]}));
        // The request that draws it again states them.
        for (std::size_t n = 0; n < 2; ++n)
            EXPECT_EQ(made.request.layers[n].transfer.unit_distance,
                      made.layers[n].chosen.transfer.unit_distance);
        return std::array{made.layers[0].chosen.transfer.unit_distance,
                          made.layers[1].chosen.transfer.unit_distance};
    };
    const auto [first, second] = units(0, 1);
    EXPECT_EQ(first, second);
    for (const auto& [own, other] : {units(1, 1), units(0, 2)}) {
        EXPECT_EQ(own, first);
        EXPECT_LT(other, own);
    }
}

TEST(layers, of_bad_words_are_refused_in_one_line) {
    const auto refused = [](const std::string& words) {
        return refusal([&] {
            PictureRequest request;
            set_member(request, "layers", {words});
        });
    };
    EXPECT_NE(refused("a.ply,map=inferno").find("'map': expected a file first, then grid, field"),
              std::string::npos);
    EXPECT_NE(refused("").find("'': expected a file first"), std::string::npos);
    EXPECT_NE(refused("range=2,1").find("range 2,1: expected LO,HI"), std::string::npos);
    EXPECT_NE(refused("window=1,2,tf=gray").find("tf has no effect beside"), std::string::npos);
    EXPECT_NE(refused("tf=gray,tf=hot").find("tf twice"), std::string::npos);
    EXPECT_NE(refusal([] {
                  (void)request_of_json(R"({"layers": [{"file": "/etc/passwd"}]})");
              }).find("'file': expected input"),
              std::string::npos);
    PictureRequest request = request_of({layer_of(kRed, 0.5)});
    request.field = "heat";
    EXPECT_NE(refusal([&] { require_effects(request); }).find("field has no effect beside"),
              std::string::npos);
    request.field.clear(), request.renderer = Renderer::trace;
    EXPECT_NE(refusal([&] { require_effects(request); }).find("layers is not for renderer"),
              std::string::npos);
}

}  // namespace vog::test
