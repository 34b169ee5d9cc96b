// light_test.cpp: Shadows and ambient occlusion against closed forms, and from renderer to renderer.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/light/illumination.h"
#include "render/picture/request/request_effects.h"
#include "render/reference/reference.h"
#include "render/splat/volume/volume_splat.h"
#include "render/trace/trace.h"
#include "support/field_models.h"
#include "support/gpus.h"
#include "support/made_fields.h"
#include "support/model_psnr.h"
#include "support/scenes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "vog/request_schema.h"

namespace vog {

using namespace test;
using lights::ExtinctionLattice;

namespace {

/// Voxels of edge 1 and value 1 in a cube, or those of them that are inside.
Volume cube(int edge, const std::function<bool(Vec3d)>& inside = {}) {
    Volume volume;
    for (int x = 0; x < edge; x += 8)
        for (int y = 0; y < edge; y += 8)
            for (int z = 0; z < edge; z += 8) {
                Leaf& leaf = volume.leaves.emplace_back();
                leaf.origin = {x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n) {
                    const Vec3i at = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
                    if (!inside || inside(vec_cast<double>(at))) leaf.set(n, 1);
                }
            }
    return volume;
}
/// White of one extinction.
ValueTransfer white(double extinction) {
    return {"white", {{0, 1, 1, 1}, {2, 1, 1, 1}}, {{0, 0.5}, {2, 0.5}}, std::log(2) / extinction};
}
VolumeLook shadows(Vec3d towards) {
    VolumeLook look;
    look.shadows = true;
    look.lights = {{towards}};
    return look;
}
VolumeLook occlusion() {
    VolumeLook look;
    look.occlusion = true;
    return look;
}

Camera from(Vec3d eye, double width = 0) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = {0.1, 0.05, -0.1};
    camera.orthographic_width = width;
    return camera;
}

Gaussians colored_model() {
    Gaussians model = random_gaussians(60, 0.1, 0.4, 5);
    add_random_fields(model, 12);
    model.origin = {40, -30, 20};
    return model;
}
ValueTransfer colors_of(const ScalarField& field) {
    const double low = field.lower, range = field.upper - field.lower;
    return {"colors",
            {{low, 0, 0.5f, 1}, {low + range, 1, 0.5f, 0}},
            {{low, 0.1}, {low + range, 0.9}},
            0.2};
}

constexpr double kBoxExtinction = 0.05;
/// A box of one extinction along z. Its columns have the same way to a light along x; few rows, which take little time.
VolumeImage box_under(const VolumeLook& look) {
    const Volume volume = cube(32, [](Vec3d at) { return std::abs(at.y - 15.5) < 1; });
    const VoxelField field = own();
    Camera camera;
    camera.eye = {15.5, 15.5, 100}, camera.look_at = {15.5, 15.5, 0};
    camera.orthographic_width = 32;
    return render_volume_reference({&volume, 1}, {&field, 1}, white(kBoxExtinction), camera, 32, 32,
                                   {}, look);
}

}  // namespace

TEST(light, passes_a_box_of_one_extinction_by_its_depth) {
    const double alpha = 1 - std::exp(-32 * kBoxExtinction);
    for (const double side : {1.0, -1.0})
        for (const int octaves : {1, 3}) {
            VolumeLook look = shadows({side, 0, 0});
            look.octaves = octaves;
            const VolumeImage picture = box_under(look);
            for (int x = 2; x < 30; ++x) {
                const double depth = kBoxExtinction * (side > 0 ? 31.5 - x : x + 0.5);
                double passed = 0, whole = 0;
                for (int n = 0; n < octaves; ++n) {
                    passed += std::pow(0.5, n) * std::exp(-std::pow(0.5, n) * depth);
                    whole += std::pow(0.5, n);
                }
                const Rgba pixel = picture.pixel[static_cast<std::size_t>(16 * 32 + x)];
                EXPECT_NEAR(pixel.r, alpha * (look.ambient + look.diffuse * passed / whole), 0.01);
                EXPECT_NEAR(pixel.a, alpha, 1e-5);  // light hides nothing
            }
        }
    // Light of half of the extinction cut off by a clip.
    VolumeLook cut = shadows({1, 0, 0});
    cut.clip.planes.push_back({{-1, 0, 0}, -15.5});
    const float edge = box_under(cut).pixel[16 * 32 + 14].r;
    EXPECT_NEAR(edge, alpha * (0.3 + 0.7 * std::exp(-kBoxExtinction * 1.5)), 0.02);
    // Of all, as a choice.
    cut.clip_lights = false;
    EXPECT_NEAR(box_under(cut).pixel[16 * 32 + 14].r,
                alpha * (0.3 + 0.7 * std::exp(-kBoxExtinction * 17.5)), 0.01);
}

TEST(light, is_scattered_forward_by_its_phase_function) {
    const Volume volume = cube(
        32, [](Vec3d at) { return std::hypot(at.x - 15.5, at.y - 15.5) < 3; });  // one pixel's rays
    const VoxelField field = own();
    Camera camera;
    camera.eye = {15.5, 15.5, 100}, camera.look_at = {15.5, 15.5, 0};
    camera.orthographic_width = 32;
    for (const double g : {0.0, 0.6, -0.4})
        for (const Vec3d& towards : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}, Vec3d{0, 3, 0}}) {
            VolumeLook look = shadows(towards);
            look.asymmetry = g;
            const Rgba pixel = render_volume_reference({&volume, 1}, {&field, 1}, white(1e-5),
                                                       camera, 32, 32, {}, look)
                                   .pixel[16 * 32 + 16];
            // Light that comes from behind goes straight on.
            const double turn = -normalized(towards).z;
            const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * turn, 1.5);
            const double seen = std::min(look.ambient + look.diffuse * phase, 1.0);
            EXPECT_NEAR(pixel.r / pixel.a, seen, 2e-3) << g << ' ' << turn;
        }
    VolumeLook look = shadows({1, 0, 0});
    for (const double g : {-1.0, 1.0, std::nan("")}) {
        look.asymmetry = g;
        EXPECT_THROW(validate(look), Error);
    }
}

TEST(light, reaches_the_middle_of_a_sphere_from_all_sides) {
    constexpr double kRadius = 20, kExtinction = 0.06;
    const auto inside = [](Vec3d at) { return length(at - Vec3d{23.5, 23.5, 23.5}) < kRadius; };
    const Volume volume = cube(48, inside);
    const VoxelField field = own();
    const auto reached = lights::illumination({&volume, 1}, {&field, 1}, white(kExtinction),
                                              occlusion(), {0, 0, 1}, nullptr);
    const device::LightLattice lattice = reached.lattice();
    const auto at = [&](Vec3d point) {
        return device::reached_at(lattice, {point.x, point.y, point.z}, {0, 0, 1});
    };
    EXPECT_NEAR(at({23.5, 23.5, 23.5}).ambient(), std::exp(-kExtinction * kRadius), 0.01);
    EXPECT_EQ(at({23.5, 23.5, 23.5}).direct(0), 1);
    // At the surface half of all directions is open: 1/2 + 1/2 (1 - e^-2sR) / 2sR.
    const double across = 2 * kExtinction * kRadius;
    EXPECT_NEAR(at({23.5 + kRadius, 23.5, 23.5}).ambient(),
                0.5 + 0.5 * (1 - std::exp(-across)) / across, 0.03);
}

TEST(light, depths_towards_both_sides_are_the_whole) {
    ExtinctionLattice lattice({{0, 0, 0}, {9, 6, 4}}, 9);
    for (std::size_t n = 0; n < lattice.sum.size(); ++n) lattice.sum[n] = double(n * n % 17);
    for (const Vec3d towards : {Vec3d{1, 0, 0}, {0, -2, 0}, {0, 0, 3}}) {
        const std::vector<float> ahead = lights::depths_towards(lattice, towards),
                                 behind = lights::depths_towards(lattice, -towards);
        const int axis = towards.x != 0 ? 0 : towards.y != 0 ? 1 : 2;
        Vec3i at{3, 2, 1};
        double whole = 0;
        for (at[axis] = 0; at[axis] < lattice.size[axis]; ++at[axis])
            whole += lattice.edge * lattice.sum[lattice.at(at.x, at.y, at.z)];
        for (at[axis] = 0; at[axis] < lattice.size[axis]; ++at[axis]) {
            const std::size_t cell = lattice.at(at.x, at.y, at.z);
            EXPECT_NEAR(ahead[cell] + behind[cell], whole, 1e-4 * whole);
        }
    }
}

TEST(light, models_and_voxels_absorb_the_same_on_the_way) {
    // A lattice holds the model's whole optical depth, for cells of any size.
    const Gaussians model = colored_model();
    ScalarField field = model.fields.scalar.front();
    const by_value::LightOfMoments light(white(0.7), by_value::value_range(field), false);
    for (const int cells : {12, 40}) {
        ExtinctionLattice lattice(view_box(model), cells);
        add_extinction(model, field, light, 1, nullptr, lattice);
        const double whole = std::accumulate(lattice.sum.begin(), lattice.sum.end(), 0.0) *
                             std::pow(lattice.edge, 3);
        EXPECT_NEAR(whole, 0.7 * mass(model), 0.03 * whole);
    }
    const Volume volume = cube(24);
    for (const int cells : {7, 24, 50}) {
        ExtinctionLattice lattice(world_box(volume), cells);
        add_extinction(volume, own(), white(0.7), lattice);
        EXPECT_NEAR(lattice.sum[lattice.at(lattice.size.x / 2, lattice.size.y / 2, 3)], 0.7,
                    0.03);  // points are up to half a cell apart
    }
}

TEST(light, opaque_matter_beside_clear_matter_lets_half_of_it_pass) {
    Gaussians model;
    model.box = {{-8, -8, -8}, {8, 8, 8}};
    ScalarField field;
    field.upper = 1;
    for (const float value : {0.0f, 1.0f}) {
        model.mean.push_back({0, 0, 0}), model.scale.push_back({2, 2, 2});
        model.density.push_back(1);
        field.value.push_back(value), field.gradient.push_back({0, 0, 0});
        field.deviation.push_back(0), field.skewness.push_back(0);
    }
    const ValueTransfer step{
        "step", {{0, 1, 1, 1}, {1, 1, 1, 1}}, {{0, 0}, {0.5, 0}, {0.5, 0.999}, {1, 0.999}}, 1e-3};
    const by_value::LightOfMoments light(step, by_value::value_range(field), false);
    ExtinctionLattice lattice(view_box(model), 64);
    add_extinction(model, field, light, 1, nullptr, lattice);
    const Vec3i middle{lattice.size.x / 2, lattice.size.y / 2, lattice.size.z / 2};
    const double depth = lattice.sum[lattice.at(middle.x, middle.y, middle.z)] * lattice.edge *
                         lattice.cells / device::kDepthCells;
    EXPECT_NEAR(depth, std::log(2), 0.01);
}

/// Pixels along an edge of the pictures that are compared from renderer to renderer.
constexpr int kLightEdge = 24;

TEST(light, every_renderer_of_models_has_the_same_light) {
    const Gaussians model = colored_model();
    const ScalarField& field = model.fields.scalar.front();
    const ValueTransfer transfer = colors_of(field);
    VolumeLook all = shadows({1, 2, -1});
    all.light = all.occlusion = true;
    VolumeLook clipped = shadows({-1, 0.5, 0});
    clipped.octaves = 4, clipped.asymmetry = 0.5;
    clipped.clip.planes.push_back({{1, 0, 0}, model.origin.x});
    clipped.lights.push_back({{0, 0, 1}, false, 0.3});
    all.lights.insert(all.lights.end(), {{{}, false, 0.2}, {{-1, 0.3, 0.1}, false, 0.5}});
    for (Camera camera : {from({2, 1.5, 3}), from({1, 2, 3}, 3), from({0.3, 0.2, 0.5})})
        for (const VolumeLook& look : {shadows({1, 2, 1}), occlusion(), all, clipped}) {
            camera.look_at = camera.look_at + model.origin, camera.eye = camera.eye + model.origin;
            SlabOptions options;
            options.slabs = 256, options.look = look;
            const VolumeImage splat = render_volume_splat(model, field.name, transfer, camera,
                                                          kLightEdge, kLightEdge, options);
            const VolumeImage trace = render_volume_trace(model, field.name, transfer, camera,
                                                          kLightEdge, kLightEdge, {}, {}, look);
            EXPECT_GT(psnr(splat, trace), 45);
            for (const Gpu& gpu : gpus()) {
                gpu.prepare();
                const VolumeImage picture =
                    GpuPictures(gpu.renderer, model)
                        .volume(field.name, transfer, camera, kLightEdge, kLightEdge, 256, look);
                EXPECT_GT(psnr(splat, picture), 70) << gpu.name;
            }
            camera.look_at = camera.look_at - model.origin, camera.eye = camera.eye - model.origin;
        }
}

TEST(light, every_renderer_looks_up_light_before_opaque_matter) {
    const Gaussians model = colored_model();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer opaque = colors_of(field);
    opaque.unit_distance = 0.002;
    const by_value::LightOfMoments light(opaque, by_value::value_range(field), field.is_measure);
    SlabOptions options;
    options.look = shadows({1, 2, 1});
    options.look.occlusion = true;
    options.look.lights.push_back({{-1, 0, 2}, false, 0.4});
    ASSERT_TRUE(
        lights::illumination({model, field, light}, options.look, {0, 0, 1}).lattice().opaque);
    Camera camera = from({2, 1.5, 3});
    camera.look_at = camera.look_at + model.origin, camera.eye = camera.eye + model.origin;
    const VolumeImage splat =
        render_volume_splat(model, field.name, opaque, camera, kLightEdge, kLightEdge, options);
    for (const Gpu& gpu : gpus()) {
        gpu.prepare();
        const VolumeImage picture = GpuPictures(gpu.renderer, model)
                                        .volume(field.name, opaque, camera, kLightEdge, kLightEdge,
                                                options.slabs, options.look);
        EXPECT_GT(psnr(splat, picture), 55) << gpu.name;
    }
    const VolumeImage trace = render_volume_trace(model, field.name, opaque, camera, kLightEdge,
                                                  kLightEdge, {}, {}, options.look);
    EXPECT_GT(psnr(splat, trace), 25);
}

TEST(light, of_two_sides_adds_up_to_the_closed_form) {
    VolumeLook look = shadows({1, 0, 0});
    look.lights = {{{3, 0, 0}, false, 0.25}, {{-1, 0, 0}, false, 0.7}};
    const VolumeImage picture = box_under(look);
    const double alpha = 1 - std::exp(-32 * kBoxExtinction);
    for (int x = 2; x < 30; ++x) {
        const double passed = 0.25 * std::exp(-kBoxExtinction * (31.5 - x)) +
                              0.7 * std::exp(-kBoxExtinction * (x + 0.5));
        const Rgba pixel = picture.pixel[static_cast<std::size_t>(16 * 32 + x)];
        EXPECT_NEAR(pixel.r, alpha * (look.ambient + look.diffuse * passed), 0.01);
    }
}

TEST(light, of_several_directions_is_the_sum_of_single_ones) {
    const Gaussians model = colored_model();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer transfer = colors_of(field);
    transfer.unit_distance = 0.02;
    Camera camera = from({2, 1.5, 3});
    camera.look_at = camera.look_at + model.origin, camera.eye = camera.eye + model.origin;
    const Volume volume = cube(24, [](Vec3d at) { return length(at - Vec3d{12, 12, 12}) < 9; });
    const VoxelField values = own();
    Camera aside;
    aside.eye = {40, 30, 60}, aside.look_at = {12, 12, 12};
    // Below white, at which colours end.
    const std::vector<DirectionalLight> lights{
        {{1, 2, -1}, false, 0.2}, {{}, false, 0.1}, {{-3, 0.5, 2}, false, 0.15}};
    for (const bool surfaces : {false, true}) {
        const double g = surfaces ? 0 : 0.3;
        const auto drawn = [&](std::vector<DirectionalLight> of) {
            VolumeLook look;
            look.shadows = true, look.light = surfaces, look.asymmetry = g;
            look.ambient = 0, look.diffuse = 0.5, look.specular = 0.1;
            look.lights = std::move(of);
            SlabOptions options;
            options.look = look, options.precision = 0;  // every pixel
            std::vector<VolumeImage> all{
                render_volume_reference({&volume, 1}, {&values, 1}, white(0.3), aside, kLightEdge,
                                        kLightEdge, {}, look),
                render_volume_splat(model, field.name, transfer, camera, kLightEdge, kLightEdge,
                                    options),
                render_volume_trace(model, field.name, transfer, camera, kLightEdge, kLightEdge, {},
                                    {}, look)};
            for (const Gpu& gpu : gpus()) {
                gpu.prepare();
                all.push_back(GpuPictures(gpu.renderer, model)
                                  .volume(field.name, transfer, camera, kLightEdge, kLightEdge,
                                          options.slabs, look));
            }
            return all;
        };
        const auto together = drawn(lights);
        std::vector<std::vector<VolumeImage>> single;
        for (const DirectionalLight& light : lights) single.push_back(drawn({light}));
        for (std::size_t n = 0; n < together.size(); ++n) {
            double brightest = 0, worst = 0;
            for (std::size_t pixel = 0; pixel < together[n].pixel.size(); ++pixel) {
                double sum = 0;
                for (const auto& pictures : single) sum += double{pictures[n].pixel[pixel].g};
                brightest = std::max(brightest, sum);
                worst = std::max(worst, std::abs(sum - double{together[n].pixel[pixel].g}));
            }
            EXPECT_GT(brightest, 0.02) << n;
            EXPECT_LT(worst, 2e-5) << n << ' ' << surfaces << ' ' << g;
        }
    }
}

TEST(light, fixed_to_the_camera_turns_with_the_view) {
    const vog::Scene scene = scene_of(colored_model());
    PictureRequest request = request_of_json(
        R"({"show": "volume", "field": "temperature", "size": 24, "shadows": true})");
    for (const Vec3d eye : {Vec3d{2, 1.5, 3}, Vec3d{-1, 3, 0.5}}) {
        Camera camera = from(eye);
        camera.look_at = camera.look_at + colored_model().origin;
        camera.eye = camera.eye + colored_model().origin;
        request.camera = camera;
        request.look.lights = {{{1, 2, 0.5}, true, 0.5}};
        const auto of_camera = render(scene, request).sums.light;
        const CameraFrame frame = frame_of(camera, 1, 1);
        request.look.lights = {{frame.right + 2.0 * frame.up - 0.5 * frame.forward, false, 0.5}};
        EXPECT_EQ(of_camera, render(scene, request).sums.light);
        request.look.lights.front().towards = {1, 2, 0.5};
        EXPECT_NE(of_camera, render(scene, request).sums.light);
    }
}

TEST(light, a_sphere_is_lit_evenly) {
    // Opaque within a cell of the lattice, whose cells a surface meets in any way. Its lit side has no pattern of them.
    constexpr double kRadius = 22;
    Volume volume = cube(64);
    for (Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Vec3i at = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
            const double inside = kRadius - length(vec_cast<double>(at) - Vec3d{31.5, 31.5, 31.5});
            leaf.set(n, static_cast<float>(std::clamp(0.5 + 0.1 * inside, 0.0, 1.0)));
        }
    MomentOptions options;
    options.block_voxels = 4;
    Gaussians model = convert_moments(volume, options);
    const std::vector<VoxelField> field{measure_field(volume, "density")};
    add_fields(model, {&volume, 1}, {&field, 1});
    PictureRequest request;
    request.show = Show::volume, request.width = request.height = 64;
    request.transfer.bands.push_back({0.5, HUGE_VAL, 1, 1, 1, kMostOpacity});
    request.look = shadows({0.2, 0.3, 1});
    Camera camera;
    camera.eye = {31.5, 31.5, 200}, camera.look_at = {31.5, 31.5, 31.5};
    camera.orthographic_width = 64;
    request.camera = camera;
    for (const vog::Scene& scene : {scene_of(model), scene_of(volume)}) {
        const Picture picture = render(scene, request);
        for (int y = 16; y < 48; ++y)
            for (int x = 16; x < 48; ++x)
                if (std::hypot(x - 31.5, y - 31.5) < 0.7 * kRadius) {
                    const std::size_t pixel = static_cast<std::size_t>(64 * y + x);
                    EXPECT_GT(picture.sums.light[pixel].r, 0.9) << x << ' ' << y;
                }
    }
}

TEST(light, opaque_matter_is_as_bright_as_matter_that_is_less_opaque) {
    // Light that falls from the eye on a half space of any extinction: 1 / 2.
    const Volume volume = cube(64);
    const VoxelField values = measure_field(volume, "density");
    VolumeLook look = shadows({0, 0, 1});
    look.ambient = 0, look.diffuse = 1;
    Camera camera;
    camera.eye = {31.5, 31.5, 200}, camera.look_at = {31.5, 31.5, 31.5};
    camera.orthographic_width = 16;
    for (const double extinction : {0.5, 2.0, 4.0, 8.0, 64.0}) {
        const VolumeImage picture = render_volume_reference(
            {&volume, 1}, {&values, 1}, white(extinction), camera, 16, 16, {}, look);
        EXPECT_NEAR(picture.pixel[136].r, 0.5, 0.12) << extinction;
    }
}

TEST(light, another_light_under_one_view_draws_no_gaussians) {
    const Gaussians model = colored_model();
    const ScalarField& field = model.fields.scalar.front();
    Camera camera = from({2, 1.5, 3});
    camera.look_at = camera.look_at + model.origin, camera.eye = camera.eye + model.origin;
    SlabOptions options;
    SlabRenderer renderer(model, field.name, colors_of(field), options);
    int drawn = 0;
    for (const VolumeLook& look :
         {VolumeLook{}, shadows({1, 0, 0}), shadows({0, 1, 0}), occlusion(), VolumeLook{}}) {
        options.look = look;
        renderer.set_light(look);
        const VolumeImage picture = renderer.render(camera, 60, 40);
        EXPECT_GT(psnr(picture, render_volume_splat(model, field.name, colors_of(field), camera, 60,
                                                    40, options)),
                  120);
        if (++drawn == 2) drawn = renderer.drawn();
    }
    EXPECT_EQ(renderer.drawn(), 2);
}

TEST(light, without_obstacles_is_the_colour_itself) {
    const Gaussians model = colored_model();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer thin = colors_of(field);
    thin.unit_distance = 1e7;
    Camera camera = from({2, 1.5, 3});
    camera.look_at = camera.look_at + model.origin, camera.eye = camera.eye + model.origin;
    SlabOptions lit;
    lit.look = shadows({1, 1, 1}), lit.look.occlusion = true;
    const VolumeImage with = render_volume_splat(model, field.name, thin, camera, 32, 32, lit);
    const VolumeImage without = render_volume_splat(model, field.name, thin, camera, 32, 32, {});
    for (std::size_t n = 0; n < with.pixel.size(); ++n)
        EXPECT_NEAR(with.pixel[n].r, without.pixel[n].r, 1e-5 * without.pixel[n].r + 1e-12);
}

TEST(light, of_requests_has_its_defaults) {
    const vog::Scene scene = scene_of(colored_model());
    const auto resolved = [&](const char* json) {
        PictureRequest request = request_of_json(json);
        require_effects(request);
        return resolve(request, scene).request.look;
    };
    const std::string volume = R"({"show": "volume", "field": "temperature", )";
    const VolumeLook studio = resolved((volume + R"("light": "studio"})").c_str());
    EXPECT_TRUE(studio.shadows && studio.occlusion && !studio.light && !studio.studio);
    EXPECT_EQ(studio.octaves, kStudioOctaves);
    EXPECT_NEAR(length(studio.lights.front().towards), 1, 1e-12);
    EXPECT_EQ(resolved((volume + R"("shadows": true})").c_str()).lights, studio.lights);
    EXPECT_EQ(resolved((volume + R"("shadows": true, "light_from": [0, 0, 2]})").c_str()).lights,
              (std::vector<DirectionalLight>{{{0, 0, 2}}}));
    EXPECT_TRUE(resolved((volume + R"("shadows": true, "light": "head"})").c_str()).lights.empty());
    // Old words are written as they were, others as texts.
    for (const char* words :
         {R"("light":"head")", R"("light":[1.0,2.0,0.5])", R"("light":"head=0.5")",
          R"("light":["head",[1.0,0.0,0.0],"camera:0,1,-1=0.25"])",
          R"("shadows":true,"light_from":["1,2,3=2","head"])"}) {
        const PictureRequest request = request_of_json("{" + std::string(words) + "}");
        EXPECT_EQ(request_json(request), "{" + std::string(words) + "}");
        EXPECT_EQ(request_of_json(request_json(request)).look, request.look);
    }
    const std::vector<DirectionalLight> two{{{1, 2, 1}, false, 1}, {{0, 1, 1}, true, 0.4}};
    PictureRequest of_words;
    set_member(of_words, "light", {"1,2,1", "camera:0,1,1=0.4"});
    EXPECT_EQ(of_words.look.lights, two);
    for (const char* word : {"camera:0,1", "camera:head", "1,2,1=", "1,2,1=-1", "1,2,1=inf",
                             "head=nan", "1,2,1=0.5=1", "0,0,0", "camera:0,0,0", "1,2,x", "moon"})
        EXPECT_THROW(set_member(of_words, "light", {word}), RequestError) << word;
    EXPECT_THROW(set_member(of_words, "light", {"head", "studio"}), RequestError);
    EXPECT_THROW(set_member(of_words, "light", std::vector<std::string>(9, "head")), RequestError);
    EXPECT_FALSE(
        resolved((volume + R"("shadows": true, "clip_lights": 0, "clip": [0,0,0,1,1,1]})").c_str())
            .clip_lights);
    for (const char* wrong :
         {R"("shadows": true, "clip_lights": false})",
          R"("clip_lights": false, "clip": [0, 0, 0, 1, 1, 1]})",
          R"("shadows": true, "clip_lights": 2, "clip": [0, 0, 0, 1, 1, 1]})",
          R"("light_from": [1, 0, 0]})", R"("scattering": 3})", R"("shadows": 1})",
          R"("shadows": true, "scattering": 0})", R"("shadows": true, "scattering": 99})",
          R"("shadows": true, "light_from": [0, 0, 0]})",
          R"("shadows": true, "light": [1, 0, 0], "light_from": [1, 0, 0]})", R"("light": "moon"})",
          R"("light_weights": [1, 1, 1, 1]})"})
        EXPECT_THROW((void)resolved((volume + wrong).c_str()), Error) << wrong;
}

}  // namespace vog
