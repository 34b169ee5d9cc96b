// pictures_test.cpp: Pictures of values, maxima and clips by GPU renderers against the CPU's, and what they refuse.
// Maps of fields are in tests/render/field_maps_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/splat/volume/volume_splat.h"
#include "support/field_models.h"
#include "support/gpus.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/picture.h"

namespace vog::test {

namespace {

constexpr int kWidth = 66, kHeight = 35;  // two by two tiles of slabs, none of them whole

/// Gaussians of all sizes about the origin, also below a pixel, with fields.
Gaussians mixed_model(int count) {
    Gaussians model = random_gaussians(count, 0.1, 0.4, 11);
    for (int n = 0; n < count; ++n) {
        const auto i = static_cast<std::size_t>(n);
        if (n % 3 == 0) model.scale[i] = 0.02f * model.scale[i];
        if (n % 7 == 0) model.scale[i].x = 0.3f;  // needles
    }
    add_random_fields(model, 12);
    return model;
}

ValueTransfer colors_of(const ScalarField& field) {
    const double low = field.lower, range = field.upper - field.lower;
    return {"colors",
            {{low, 0, 0, 1}, {low + 0.4 * range, 0, 1, 0}, {low + range, 1, 0, 0}},
            {{low, 0.1}, {low + 0.3 * range, 0.4}, {low + 0.5 * range, 0}, {low + range, 0.9}},
            0.2};
}

/// Light only near two values, in bands narrower than the columns of a table of means.
ValueTransfer bands_of(const ScalarField& field) {
    const double low = field.lower, range = field.upper - field.lower, half = 3e-4 * range;
    ValueTransfer bands{"bands", {{low, 0, 0, 1}, {low + range, 1, 1, 0}}, {}, 0.02};
    for (const double at : {low + 0.3 * range, low + 0.7 * range})
        for (const double off : {-half, 0.0, half})
            bands.opacity.push_back({at + off, off == 0 ? 0.9 : 0});
    return bands;
}

Camera looking(Vec3d eye, double fov, double width = 0) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = {0.1, 0.05, -0.1};
    camera.fov_degrees = fov;
    camera.orthographic_width = width;
    return camera;
}
const std::pair<const char*, Camera> kCameras[] = {
    {"perspective", looking({2, 1.5, 3}, 40)},
    {"eye_inside", looking({0.3, 0.2, 0.5}, 80)},
    {"parallel", looking({1, 2, 3}, 40, 3)},
    {"parallel_eye_inside", looking({0.1, 0.2, 0.3}, 40, 3)},
};

Clipping some_planes() {
    Clipping clip;
    clip.box = Box{{-0.7, -0.5, -0.8}, {0.6, 0.7, 0.3}};
    clip.planes = {{{1, 0.7, -0.4}, -0.3}};
    return clip;
}

/// Difference in the channel that is furthest off, of all pixels but the `without` that differ most. A NaN is infinitely far.
double worst(const VolumeImage& a, const VolumeImage& b, std::size_t without = 0) {
    if (a.pixel.size() != b.pixel.size()) return HUGE_VAL;
    std::vector<double> off;
    for (std::size_t n = 0; n < a.pixel.size(); ++n) {
        double most = 0;
        for (const auto channel : {&Rgba::r, &Rgba::g, &Rgba::b, &Rgba::a}) {
            const double of_channel =
                std::abs(double{a.pixel[n].*channel} - double{b.pixel[n].*channel});
            if (!(of_channel <= most)) most = of_channel < HUGE_VAL ? of_channel : HUGE_VAL;
        }
        off.push_back(most);
    }
    std::ranges::sort(off, std::greater());
    return off[without];
}

using gpu_pictures = GpuTest;

}  // namespace

/// Each GPU with its own copy of a model.
std::vector<std::pair<Gpu, GpuPictures>> all_pictures(const Gaussians& model) {
    std::vector<std::pair<Gpu, GpuPictures>> all;
    for (const Gpu& gpu : gpus()) all.emplace_back(gpu, GpuPictures(gpu.renderer, model));
    return all;
}

TEST_F(gpu_pictures, by_value_are_those_of_the_splat) {
    const Gaussians model = mixed_model(40);
    const ScalarField& field = model.fields.scalar.front();
    const ValueTransfer colors = colors_of(field), bands = bands_of(field);
    VolumeLook lit;
    lit.light = true;
    lit.lights = {{{0.3, 1, 0.2}}};
    VolumeLook clipped;
    clipped.light = true;
    clipped.clip = some_planes();
    auto all = all_pictures(model);
    for (const auto& [name, camera] : kCameras)
        for (const auto& [slabs, look] :
             {std::pair{70, VolumeLook{}}, {32, lit}, {7, clipped}, {9, VolumeLook{}}}) {
            const ValueTransfer& transfer = slabs == 9 ? bands : colors;
            SlabOptions options;
            options.slabs = slabs, options.look = look;
            const VolumeImage expected =
                render_volume_splat(model, field.name, transfer, camera, kWidth, kHeight, options);
            for (auto& [gpu, pictures] : all) {
                SCOPED_TRACE(gpu.name + " " + name + " " + std::to_string(slabs));
                gpu.prepare();
                const VolumeImage found =
                    pictures.volume(field.name, transfer, camera, kWidth, kHeight, slabs, look);
                // Narrow bands show variances that are differences of sums in floats.
                const bool is_bands = slabs == 9;
                EXPECT_LT(worst(found, expected), is_bands ? 0.03 : 0.01);
                // Where the gradient is square to the ray, either side faces the light: rounding decides.
                if (!is_bands) {
                    EXPECT_LT(worst(found, expected, look.light ? 2 : 0), 1e-4);
                }
            }
        }
}

TEST_F(gpu_pictures, of_labels_are_those_of_the_splat) {
    Gaussians model = mixed_model(40);
    ScalarField label = model.fields.scalar.front();
    label.name = "label", label.lower = 0, label.upper = 2035;
    for (std::size_t i = 0; i < model.size(); ++i)
        label.value[i] = std::array{0.0f, 17.0f, 1035.0f, 2035.0f}[i % 4];
    label.gradient.assign(model.size(), {}), label.deviation.assign(model.size(), 0);
    model.fields.scalar.push_back(label);
    const ValueTransfer organs{
        "organs",
        {{16.5, 1, 0, 0}, {17.5, 1, 0, 0}, {2034.5, 0, 0, 1}, {2035.5, 0, 0, 1}},
        {{16.5, 0},
         {16.5, 0.6},
         {17.5, 0.6},
         {17.5, 0},
         {2034.5, 0},
         {2034.5, 0.6},
         {2035.5, 0.6},
         {2035.5, 0}},
        1};
    auto all = all_pictures(model);
    for (const auto& [name, camera] : kCameras) {
        SlabOptions options;
        options.slabs = 32;
        const VolumeImage expected =
            render_volume_splat(model, "label", organs, camera, kWidth, kHeight, options);
        // Two colours, and no other between them.
        for (const Rgba& pixel : expected.pixel) EXPECT_EQ(pixel.g, 0);
        for (auto& [gpu, pictures] : all) {
            SCOPED_TRACE(gpu.name + " " + name);
            gpu.prepare();
            const VolumeImage found =
                pictures.volume("label", organs, camera, kWidth, kHeight, 32, {});
            // Where three labels meet, their moments differ by rounding.
            EXPECT_LT(worst(found, expected), 0.03);
        }
    }
}

TEST_F(gpu_pictures, of_maxima_are_those_of_the_splat) {
    Gaussians model = mixed_model(40);
    // The density itself, whose means are bounded by it, in a unit in which T is far from 1.
    for (float& density : model.density) density *= 300;
    ScalarField own = model.fields.scalar.front();
    own.name = "own", own.is_measure = true, own.lower = 0, own.upper = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        own.value[i] = 0.7f * model.density[i], own.gradient[i] = {},
        own.deviation[i] = 0.1f * own.value[i];
        own.upper = std::max(own.upper, double{model.density[i]});
    }
    model.fields.scalar.push_back(std::move(own));
    auto all = all_pictures(model);
    for (const ScalarField& field : model.fields.scalar)
        for (const auto& [name, camera] : kCameras)
            for (const Clipping& clip : {Clipping{}, some_planes()}) {
                const double range = field.upper - field.lower;
                SlabOptions options;
                options.slabs = 10, options.look.clip = clip;
                const ValueMap expected =
                    render_maximum_splat(model, field.name, camera, kWidth, kHeight, options);
                for (auto& [gpu, pictures] : all) {
                    SCOPED_TRACE(gpu.name + " " + field.name + " " + name);
                    gpu.prepare();
                    const ValueMap found =
                        pictures.maximum(field.name, camera, kWidth, kHeight, 10, clip);
                    std::size_t shown = 0, other = 0;
                    for (std::size_t n = 0; n < found.value.size(); ++n) {
                        if (std::isnan(expected.value[n]) && std::isnan(found.value[n])) continue;
                        ++shown;
                        // A slab counts from a share of the densest on: rounding decides at that share.
                        other += !(std::abs(found.value[n] - expected.value[n]) < 1e-3 * range);
                    }
                    EXPECT_GT(shown, 250u);
                    EXPECT_LT(other, shown / 50);
                }
            }
}

TEST_F(gpu_pictures, of_clipped_depth_are_the_closed_form) {
    Gaussians model = random_gaussians(50, 0.15, 0.4, 5);
    model.origin = {40, -30, 20};
    Clipping clip = some_planes();
    clip.box = moved(*clip.box, model.origin);
    clip.planes[0].offset += dot(clip.planes[0].normal, model.origin);
    for (auto [name, camera] : kCameras) {
        camera.eye = camera.eye + model.origin;
        camera.look_at = camera.look_at + model.origin;
        PictureRenderer renderer(scene_of(model));
        PictureRequest request{.camera = camera,
                               .width = kWidth,
                               .height = kHeight,
                               .renderer = Renderer::trace,
                               .options = {.clip = clip}};
        const DepthImage expected = bare_depth(renderer, request);
        const float most = *std::ranges::max_element(expected.depth);
        EXPECT_GT(most, 0);
        for (const Gpu& gpu : gpus()) {
            SCOPED_TRACE(gpu.name + " " + name);
            gpu.prepare();
            PictureRenderer on_gpu(scene_of(model));
            request.renderer = gpu.renderer;
            const DepthImage depth = bare_depth(on_gpu, request);
            EXPECT_TRUE(on_gpu.report().gpu_ms.has_value());
            for (std::size_t n = 0; n < depth.depth.size(); ++n)
                ASSERT_NEAR(depth.depth[n], expected.depth[n], 1e-5 * double{most}) << n;
        }
    }
}

TEST_F(gpu_pictures, of_fields_are_the_same_bytes_in_every_run_and_order_of_traversal) {
    const Gaussians model = mixed_model(200);
    const FieldChoice choice{"gas velocity", FieldPart::view};
    const Camera camera = kCameras[1].second;
    FieldMaps before;
    for (const Gpu& gpu : gpus()) {
        gpu.prepare();
        GpuPictures pictures(gpu.renderer, model);
        const FieldMaps maps = pictures.fields(choice, camera, kWidth, kHeight);
        (void)pictures.fields(choice, camera, 2 * kWidth, 20);
        (void)pictures.depth(camera, 9, 7);
        const auto bytes_of = [](const FieldMaps& of) {
            std::vector<std::uint32_t> bits;
            for (const auto* values : {&of.column, &of.mean, &of.deviation})
                for (const float value : *values)
                    bits.push_back(std::bit_cast<std::uint32_t>(value));
            return bits;
        };
        EXPECT_EQ(bytes_of(pictures.fields(choice, camera, kWidth, kHeight)), bytes_of(maps));
        if (gpu.name == "optix_strict" || gpu.name == "optix_noisy") {
            EXPECT_EQ(bytes_of(maps), bytes_of(before)) << gpu.name;
        }
        before = maps;
    }
}

TEST_F(gpu_pictures, of_boxes_are_those_of_the_ray_tracer) {
    const Gaussians model = mixed_model(40);
    const FieldChoice choice{model.fields.scalar.front().name, FieldPart::value};
    const TraceSceneOptions boxes{1, 0};
    const Camera camera = kCameras[0].second;
    const FieldMaps expected =
        render_field_trace(model, choice, camera, kWidth, kHeight, {}, boxes);
    for (const Gpu& gpu : gpus()) {
        if (gpu.renderer != Renderer::optix) continue;
        gpu.prepare();
        GpuPictures pictures(gpu.renderer, model, boxes);
        const FieldMaps maps = pictures.fields(choice, camera, kWidth, kHeight);
        const float most = *std::ranges::max_element(expected.column);
        for (std::size_t n = 0; n < maps.column.size(); ++n) {
            ASSERT_NEAR(maps.column[n], expected.column[n], 1e-5f * most) << n;
            if (expected.column[n] > 1e-3f * most) {
                ASSERT_NEAR(maps.mean[n], expected.mean[n], 0.02) << n;  // of 1,500
            }
        }
    }
}

TEST_F(gpu_pictures, of_boxes_by_value_are_those_of_the_ray_tracer_to_the_error_of_slabs) {
    const Gaussians model = mixed_model(40);
    const ScalarField& field = model.fields.scalar.front();
    const ValueTransfer transfer = colors_of(field);
    const TraceSceneOptions boxes{0.7, 0};
    const Camera camera = kCameras[0].second;
    VolumeLook look;
    look.light = true;
    look.clip = some_planes();
    const VolumeImage expected =
        render_volume_trace(model, field.name, transfer, camera, kWidth, kHeight, {}, boxes, look);
    const VolumeImage whole =
        render_volume_trace(model, field.name, transfer, camera, kWidth, kHeight, {}, {}, look);
    const ValueMap largest =
        render_maximum_trace(model, field.name, camera, kWidth, kHeight, {}, boxes, some_planes());
    for (const Gpu& gpu : gpus()) {
        if (gpu.renderer != Renderer::optix) continue;
        SCOPED_TRACE(gpu.name);
        gpu.prepare();
        GpuPictures pictures(gpu.renderer, model, boxes);
        const VolumeImage found =
            pictures.volume(field.name, transfer, camera, kWidth, kHeight, 256, look);
        // Light within a slab has no order: its colours differ by a share of what one slab absorbs.
        EXPECT_LT(worst(found, expected), 0.03);
        EXPECT_GT(worst(whole, expected), 0.3);
        const ValueMap map =
            pictures.maximum(field.name, camera, kWidth, kHeight, 256, some_planes());
        std::size_t shown = 0, other = 0;
        for (std::size_t n = 0; n < map.value.size(); ++n) {
            if (std::isnan(map.value[n]) && std::isnan(largest.value[n])) continue;
            ++shown;
            // Means over slabs, and over an eighth of a Gaussian.
            other +=
                !(std::abs(map.value[n] - largest.value[n]) < 0.02 * (field.upper - field.lower));
        }
        EXPECT_GT(shown, 150u);
        EXPECT_LT(other, shown / 20);
    }
}

TEST_F(gpu_pictures, of_wrong_input_are_refused_in_one_line) {
    const Gaussians model = mixed_model(5);
    const std::string field = model.fields.scalar.front().name;
    const ValueTransfer transfer = colors_of(model.fields.scalar.front());
    const Camera camera = kCameras[0].second;
    EXPECT_EQ(refusal([&] { GpuPictures(Renderer::splat, model); }),
              "splat: no renderer on a GPU, expected cuda or optix");
    EXPECT_EQ(refusal([&] {
                  GpuPictures(Renderer::cuda, model, {1, 0});
              }),
              "cuda: bounding boxes (aabb_sigma), expected optix");
    for (const Renderer renderer : {Renderer::cuda, Renderer::optix}) {
        GpuPictures pictures(renderer, model);
        const std::string name = info_of(renderer).name;
        EXPECT_EQ(refusal([&] { (void)pictures.volume(field, transfer, camera, 9, 9, 0); }),
                  name + ": 0 depth slabs, expected 1 to 1024");
        EXPECT_EQ(refusal([&] { (void)pictures.maximum(field, camera, 9, 9, 1025); }),
                  name + ": 1025 depth slabs, expected 1 to 1024");
        EXPECT_TRUE(refusal([&] {
                        (void)pictures.maximum("cold", camera, 9, 9);
                    }).starts_with("no field 'cold'"));
        EXPECT_TRUE(refusal([&] {
                        (void)pictures.fields({"cold", FieldPart::value}, camera, 9, 9);
                    }).starts_with("no field 'cold'"));
        Clipping flat;
        flat.planes = {{{0, 0, 0}, 1}};
        EXPECT_TRUE(
            refusal([&] { (void)pictures.depth(camera, 9, 9, flat); }).starts_with("clip plane"));
        // Nothing to draw is an empty picture.
        Gaussians none = mixed_model(0);
        GpuPictures empty(renderer, none);
        EXPECT_EQ(empty.volume(field, transfer, camera, 3, 2).pixel,
                  std::vector<Rgba>(6, Rgba{0, 0, 0, 0}));
        EXPECT_EQ(empty.depth(camera, 3, 2).depth, std::vector<float>(6, 0.0f));
        EXPECT_EQ(empty.fields({field, FieldPart::value}, camera, 3, 2).column,
                  std::vector<float>(6, 0.0f));
        EXPECT_TRUE(std::isnan(empty.maximum(field, camera, 3, 2).value[5]));
    }
    PictureRenderer clipped(scene_of(model));
    const Clipping clip = some_planes();
    TraceOptions collect;
    collect.anyhit = AnyHit::collect;
    for (const Renderer renderer : {Renderer::cuda, Renderer::optix})
        for (const RenderOptions& options : {RenderOptions{.aabb_sigma = 1, .clip = clip},
                                             RenderOptions{.trace = collect, .clip = clip},
                                             RenderOptions{.samples = 2, .clip = clip}})
            EXPECT_NE(refusal([&] {
                          (void)bare_depth(clipped, {.renderer = renderer, .options = options});
                      }),
                      "no error");
}

}  // namespace vog::test
