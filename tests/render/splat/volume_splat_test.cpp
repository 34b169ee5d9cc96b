// volume_splat_test.cpp: pictures of models by value: depth slabs and exact order, against closed forms.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/splat/volume/volume_splat.h"
#include "render/trace/trace.h"
#include "support/field_models.h"
#include "support/gpus.h"
#include "support/model_psnr.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog {

using namespace test;

namespace {

/// Gaussians on the z axis, each of one value: 1, 2, ...
Gaussians row_of_values(int count, double spacing) {
    Gaussians model;
    model.source = "row";
    ScalarField field;
    field.name = "heat";
    field.lower = 1, field.upper = std::max(count, 1);
    for (int n = 0; n < count; ++n) {
        model.mean.push_back({0, 0, static_cast<float>(spacing * n)});
        model.scale.push_back({0.5f, 0.4f, 0.3f});
        model.density.push_back(1.5f);
        field.value.push_back(static_cast<float>(n + 1));
        field.gradient.push_back({0, 0, 0});
        field.deviation.push_back(0);
        field.skewness.push_back(0);
    }
    model.fields.scalar.push_back(field);
    return model;
}

/// Values 1 and 2: red of little, blue of much extinction.
ValueTransfer two_colors() {
    return {"two",
            {{1, 1, 0.25f, 0}, {1.5, 1, 0.25f, 0}, {1.5, 0, 0.5f, 1}, {2, 0, 0.5f, 1}},
            {{1, 0.3}, {1.5, 0.3}, {1.5, 0.8}, {2, 0.8}},
            2};
}

Camera towards(Vec3d eye, Vec3d at, bool orthographic) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = at;
    camera.up = {0, 1, 0};
    camera.fov_degrees = 40;
    if (orthographic) camera.orthographic_width = 4;
    return camera;
}

using Draw = std::function<VolumeImage(const Gaussians&, const ValueTransfer&, const Camera&, int,
                                       int, const VolumeLook&)>;
VolumeImage splatted(const Gaussians& model, const ValueTransfer& transfer, const Camera& camera,
                     int width, int height, const VolumeLook& look) {
    SlabOptions options;
    options.look = look;
    return render_volume_splat(model, model.fields.scalar.front().name, transfer, camera, width,
                               height, options);
}
VolumeImage traced(const Gaussians& model, const ValueTransfer& transfer, const Camera& camera,
                   int width, int height, const VolumeLook& look) {
    return render_volume_trace(model, model.fields.scalar.front().name, transfer, camera, width,
                               height, {}, {}, look);
}
/// By depth slabs.
std::vector<Draw> slab_draws() {
    std::vector<Draw> all{splatted};
    for (const Gpu& gpu : gpus())
        all.emplace_back([gpu](const Gaussians& model, const ValueTransfer& transfer,
                               const Camera& camera, int width, int height,
                               const VolumeLook& look) {
            gpu.prepare();
            return GpuPictures(gpu.renderer, model)
                .volume(model.fields.scalar.front().name, transfer, camera, width, height, 32,
                        look);
        });
    return all;
}
std::vector<Draw> all_draws() {
    std::vector<Draw> all = slab_draws();
    all.emplace_back(traced);
    return all;
}

/// T of Gaussian i along the ray of a pixel.
double tau_at(const Gaussians& model, std::size_t i, const Camera& camera, int size, int x, int y) {
    const CameraFrame frame = frame_of(camera, size, size);
    return optical_depth(model, i, frame.origin(x, y), frame.direction(x, y));
}

TEST(volume_splat, one_value_is_beers_law) {
    const Gaussians model = row_of_values(1, 0);
    const ValueTransfer transfer = two_colors();
    const double s = light_of(transfer, 1).extinction;
    constexpr int kSize = 33;
    for (const bool orthographic : {false, true})
        // Before the Gaussian, and inside it.
        for (const double distance : {5.0, 0.2})
            for (const Draw& draw : all_draws()) {
                const Camera camera = towards({0.3, 0.2, distance}, {0, 0, 0}, orthographic);
                const VolumeImage image = draw(model, transfer, camera, kSize, kSize, {});
                for (int n = 0; n < kSize * kSize; n += 5) {
                    const double tau = tau_at(model, 0, camera, kSize, n % kSize, n / kSize);
                    const double alpha = 1 - std::exp(-s * tau);
                    const Rgba& pixel = image.pixel[static_cast<std::size_t>(n)];
                    EXPECT_NEAR(pixel.a, alpha, 3e-5) << n << ", distance " << distance;
                    EXPECT_NEAR(pixel.r, alpha, 3e-5);
                    EXPECT_NEAR(pixel.g, 0.25 * alpha, 3e-5);
                    EXPECT_NEAR(pixel.b, 0, 3e-5);
                }
            }
}

TEST(volume_splat, the_nearer_one_hides_the_farther_from_both_sides) {
    const Gaussians model = row_of_values(2, 4);
    const ValueTransfer transfer = two_colors();
    const double s[2] = {light_of(transfer, 1).extinction, light_of(transfer, 2).extinction};
    constexpr int kSize = 97, kMiddle = 48;  // a Gaussian has several pixels
    for (const bool orthographic : {false, true})
        for (const bool behind : {false, true})
            for (const Draw& draw : all_draws()) {
                const Camera camera =
                    towards({0, 0, behind ? 14.0 : -10.0}, {0, 0, 2}, orthographic);
                const Rgba pixel = draw(model, transfer, camera, kSize, kSize, {})
                                       .pixel[kMiddle * kSize + kMiddle];
                double alpha[2];
                for (std::size_t i = 0; i < 2; ++i)
                    alpha[i] =
                        1 - std::exp(-s[i] * tau_at(model, i, camera, kSize, kMiddle, kMiddle));
                const double red = behind ? (1 - alpha[1]) * alpha[0] : alpha[0];
                const double blue = behind ? alpha[1] : (1 - alpha[0]) * alpha[1];
                EXPECT_NEAR(pixel.r, red, 3e-5) << behind;
                EXPECT_NEAR(pixel.b, blue, 3e-5) << behind;
                EXPECT_NEAR(pixel.a, 1 - (1 - alpha[0]) * (1 - alpha[1]), 3e-5);
            }
}

/// Gaussians on a lattice that fill a box; values rise along a tilted direction.
Gaussians tilted_layer() {
    Gaussians model;
    ScalarField field;
    field.name = "heat", field.lower = 0, field.upper = 1;
    const Vec3d g{0.08, 0.05, -0.25};
    for (int x = -5; x <= 5; ++x)
        for (int y = -5; y <= 5; ++y)
            for (int z = -5; z <= 5; ++z) {
                const Vec3d at{0.5 * x + 0.1 * std::sin(3.0 * y + z), 0.5 * y, 0.5 * z};
                model.mean.push_back(vec_cast<float>(at));
                model.scale.push_back({0.35f, 0.3f, 0.3f});
                model.density.push_back(1);
                field.value.push_back(static_cast<float>(std::clamp(0.5 + dot(g, at), 0.0, 1.0)));
                field.gradient.push_back(vec_cast<float>(g));
                field.deviation.push_back(0.02f);
                field.skewness.push_back(0);
            }
    model.fields.scalar.push_back(field);
    return model;
}

TEST(volume_splat, slabs_approach_exact_order) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    const ValueTransfer transfer = rainbow(field);
    for (const bool orthographic : {false, true}) {
        const Camera camera = towards({1.5, 1.2, 2.5}, {0.5, 0.5, 0.5}, orthographic);
        const VolumeImage exact = traced(model, transfer, camera, 64, 64, {});
        double before = 0;
        for (const int slabs : {4, 32, 256}) {
            SlabOptions options;
            options.slabs = slabs;
            const double found = psnr(
                render_volume_splat(model, field.name, transfer, camera, 64, 64, options), exact);
            // An eighth of the thickness; thin slabs end at the steps of the tracer.
            EXPECT_GT(found, before + 6) << slabs;
            before = found;
            if (slabs == 32) {
                EXPECT_GT(found, 50);
            }
        }
        EXPECT_GT(before, 65);
    }
}

TEST(volume_splat, every_target_and_any_number_of_threads_give_one_picture) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    const ValueTransfer transfer = rainbow(field);
    const Camera camera = towards({1.5, 1.2, 2.5}, {0.5, 0.5, 0.5}, false);
    const VolumeImage best = splatted(model, transfer, camera, 150, 70, {});
    for (const int threads : {1, 3}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(threads));
        EXPECT_EQ(splatted(model, transfer, camera, 150, 70, {}).pixel, best.pixel);
    }
    for (const std::string& target : splat_targets()) {
        SlabOptions options;
        options.simd_target = target;
        const VolumeImage other =
            render_volume_splat(model, field.name, transfer, camera, 150, 70, options);
        EXPECT_GT(psnr(other, best), 90) << target;
    }
}

TEST(volume_splat, an_earlier_picture_leaves_no_trace) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    SlabRenderer renderer(model, field.name, rainbow(field));
    VolumeImage picture;
    renderer.render(towards({0.6, 0.6, 0.9}, {0.5, 0.5, 0.5}, false), 150, 90, picture);
    const Camera camera = towards({6, 5, 9}, {0.5, 0.5, 0.5}, false);
    renderer.render(camera, 200, 70, picture);
    EXPECT_EQ(picture.pixel, renderer.render(camera, 200, 70).pixel);
    EXPECT_EQ(picture.pixel.front(), (Rgba{0, 0, 0, 0}));
}

TEST(volume_splat, edits_under_one_view_draw_no_gaussians) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer transfers[] = {rainbow(field), rainbow(field)};
    transfers[1].unit_distance *= 0.3;
    const Camera camera = towards({6, 5, 9}, {0.5, 0.5, 0.5}, false);
    for (const bool lit : {false, true}) {
        SlabOptions options;
        options.look.light = lit;
        SlabRenderer renderer(model, field.name, transfers[0], options);
        int edit = 0;
        const auto is_drawn = [&](const Camera& from, int width, bool edits = true) {
            if (edits) ++edit;
            if (edits && lit) options.look.lights = {{{1, 0.1 * edit, 0}}};
            const ValueTransfer& transfer = transfers[lit ? 0 : edit % 2];
            renderer.set_transfer(transfer);
            renderer.set_light(options.look);
            const int before = renderer.drawn();
            const VolumeImage expected =
                render_volume_splat(model, field.name, transfer, from, width, width / 2, options);
            EXPECT_GT(psnr(renderer.render(from, width, width / 2), expected), 120);
            return renderer.drawn() > before;
        };
        EXPECT_TRUE(is_drawn(camera, 200));
        EXPECT_TRUE(is_drawn(camera, 200));  // the first edit keeps its sums
        EXPECT_FALSE(is_drawn(camera, 200));
        EXPECT_TRUE(is_drawn(camera, 400, false));  // more rays a pixel, once the view stands still
        EXPECT_FALSE(is_drawn(camera, 200));
        EXPECT_TRUE(is_drawn(camera, 200, false));  // the same again
        Camera other = camera;
        other.eye.x += 1;
        EXPECT_TRUE(is_drawn(other, 200));
        EXPECT_TRUE(is_drawn(other, 200));
        EXPECT_FALSE(is_drawn(other, 200));
        EXPECT_TRUE(is_drawn(camera, 200));
        VolumeLook unfit = options.look;
        unfit.light = !lit;
        EXPECT_THROW(renderer.set_light(unfit), Error);
    }
}

TEST(volume_splat, clips_cut_each_ray) {
    const Gaussians model = row_of_values(1, 0);
    const ValueTransfer transfer = two_colors();
    const double s = light_of(transfer, 1).extinction;
    constexpr int kSize = 49, kMiddle = 24;  // a Gaussian has several pixels
    VolumeLook half;
    half.clip.planes.push_back({{0, 0, 1}, 0});  // z >= 0 stays: half of the Gaussian
    VolumeLook box;
    box.clip.box = Box{{-9, -9, 0}, {9, 9, 9}};
    VolumeLook nothing;
    nothing.clip.box = Box{{7, 7, 7}, {9, 9, 9}};
    for (const bool orthographic : {false, true})
        for (const double distance : {5.0, 0.05})  // the second is drawn from inside
            for (const Draw& draw : all_draws()) {
                const Camera camera = towards({0, 0, -distance}, {0, 0, 0}, orthographic);
                const double whole = tau_at(model, 0, towards({0, 0, -5}, {0, 0, 0}, orthographic),
                                            kSize, kMiddle, kMiddle);
                const double alpha = 1 - std::exp(-0.5 * s * whole);
                for (const VolumeLook& look : {half, box}) {
                    const VolumeImage image = draw(model, transfer, camera, kSize, kSize, look);
                    EXPECT_NEAR(image.pixel[kMiddle * kSize + kMiddle].a, alpha, 3e-5);
                }
                for (const Rgba& pixel : draw(model, transfer, camera, kSize, kSize, nothing).pixel)
                    EXPECT_EQ(pixel.a, 0);
            }
}

TEST(volume_splat, light_follows_the_gradient) {
    Gaussians model = row_of_values(1, 0);
    ScalarField& field = model.fields.scalar.front();
    field.lower = 0, field.upper = 2;
    field.gradient[0] = {0, 0, 0.01f};  // along the view: no change of value worth a colour
    const ValueTransfer transfer{"white", {{0, 0.5f, 0.5f, 0.5f}}, {{0, 0.5}}, 1};
    VolumeLook look;
    look.light = true;
    look.ambient = 0.2, look.diffuse = 0.6, look.specular = 0.1, look.power = 4;
    const Camera front = towards({0, 0, 6}, {0, 0, 0}, true);
    for (const Draw& draw : all_draws()) {
        const auto color = [&] {
            const Rgba p = draw(model, transfer, front, 9, 9, look).pixel[40];
            return double{p.r} / double{p.a};
        };
        look.lights.clear();
        EXPECT_NEAR(color(), 0.5 * 0.8 + 0.1, 1e-4);  // head light
        look.lights = {{{1, 0, 0}}};
        EXPECT_NEAR(color(), 0.5 * 0.2, 1e-4);  // from the side
    }
}

/// A row whose first value is opaque red, the others blue.
ValueTransfer red_wall(double others) {
    return {"wall",
            {{1, 1, 0.25f, 0}, {1.5, 1, 0.25f, 0}, {1.5, 0, 0.5f, 1}, {40, 0, 0.5f, 1}},
            {{1, 0.9999}, {1.5, 0.9999}, {1.5, others}, {40, others}},
            0.01};
}

TEST(volume_splat, opaque_pixels_hide_all_behind) {
    const Gaussians model = row_of_values(40, 20);
    SlabOptions options;
    options.slabs = 64;  // one Gaussian each
    for (const bool orthographic : {false, true}) {
        // Gaussians on the axis are wider than the picture.
        Camera camera = towards({0, 0, -30}, {0, 0, 0}, orthographic);
        camera.fov_degrees = 1;
        if (orthographic) camera.orthographic_width = 0.5;
        const VolumeImage image =
            render_volume_splat(model, "heat", red_wall(0.5), camera, 70, 40, options);
        for (const Rgba& pixel : image.pixel) {
            EXPECT_NEAR(pixel.r, 1, 1e-5);
            EXPECT_NEAR(pixel.g, 0.25, 1e-5);
            EXPECT_NEAR(pixel.b, 0, 1e-5);
            EXPECT_NEAR(pixel.a, 1, 1e-5);
        }
    }
}

TEST(volume_splat, gaussians_without_light_are_as_if_they_were_not_there) {
    const Gaussians model = row_of_values(40, 2);
    Gaussians first = row_of_values(1, 2);
    first.fields.scalar.front().upper = 40;
    SlabOptions options;
    options.slabs = 256;  // none of them holds two Gaussians
    const auto draw = [&](const Gaussians& of, const Camera& camera) {
        return render_volume_splat(of, "heat", red_wall(0), camera, 75, 35, options);
    };
    // From the far end, and from inside one of the dark ones.
    for (const double z : {90.0, 20.0}) {
        const Camera camera = towards({0.3, 0.2, z}, {0, 0, 0}, false);
        const VolumeImage all = draw(model, camera), one = draw(first, camera);
        float most = 0;
        for (std::size_t n = 0; n < all.pixel.size(); ++n) {
            most = std::max(most, all.pixel[n].r);
            EXPECT_NEAR(all.pixel[n].r, one.pixel[n].r, 1e-4) << n;
            EXPECT_NEAR(all.pixel[n].a, one.pixel[n].a, 1e-4) << n;
            EXPECT_LE(all.pixel[n].b, 1e-4);
        }
        EXPECT_GT(most, 0.9);
    }
}

TEST(volume_splat, neighbours_blend_before_they_are_classified) {
    // Two Gaussians at one place are one of their mean value.
    Gaussians pair = row_of_values(2, 0), one = row_of_values(1, 0);
    ScalarField &values = pair.fields.scalar.front(), &value = one.fields.scalar.front();
    values.lower = value.lower = 0, values.upper = value.upper = 100;
    values.value = {40, 42}, value.value = {41};
    one.density = {3};
    const ValueTransfer band{
        "band",
        {{0, 0, 0, 1}, {30, 0, 0, 1}, {30, 1, 0, 0}, {52, 1, 0, 0}, {52, 0, 1, 0}},
        {{0, 0.5}, {52, 0.5}, {52, 0}, {100, 0}},
        1};
    const Camera camera = towards({0, 0, 6}, {0, 0, 0}, false);
    for (const Draw& draw : {Draw(splatted), Draw(traced)}) {
        const VolumeImage both = draw(pair, band, camera, 33, 33, {});
        const VolumeImage mean = draw(one, band, camera, 33, 33, {});
        for (std::size_t n = 0; n < both.pixel.size(); ++n)
            for (const auto channel : {&Rgba::r, &Rgba::g, &Rgba::b, &Rgba::a})
                EXPECT_NEAR(both.pixel[n].*channel, mean.pixel[n].*channel, 1e-4) << n;
    }
}

TEST(volume_splat, colours_lie_between_those_of_the_transfer_function) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer transfer = rainbow(field);
    for (ValueColor& color : transfer.color) color.b = 0.5f, color.g = std::min(color.g, 0.25f);
    for (const Draw& draw : {Draw(splatted), Draw(traced)})
        for (const Rgba& pixel :
             draw(model, transfer, towards({1.5, 1.2, 2.5}, {0.5, 0.5, 0.5}, false), 64, 64, {})
                 .pixel) {
            EXPECT_NEAR(pixel.b, 0.5f * pixel.a, 1e-5);
            EXPECT_LE(pixel.g, 0.25f * pixel.a + 1e-5f);
        }
}

TEST(volume_splat, tiles_have_no_seams) {
    // A tilted opaque surface, lit: steps between neighbours are the same inside of tiles and between them.
    const Gaussians model = tilted_layer();
    ValueTransfer surface{
        "surface", {{0, 1, 1, 1}}, {{0, 0}, {0.5, 0}, {0.5, 0.9999}, {1, 0.9999}}, 0.01};
    VolumeLook look;
    look.light = true;
    const VolumeImage image =
        splatted(model, surface, towards({0, 0, 8}, {0, 0, 0}, false), 256, 128, look);
    double inside = 0, between = 0;
    int insides = 0, betweens = 0;
    for (int y = 0; y < 128; ++y)
        for (int x = 1; x < 256; ++x) {
            const Rgba &a = image.pixel[static_cast<std::size_t>(y * 256 + x - 1)],
                       &b = image.pixel[static_cast<std::size_t>(y * 256 + x)];
            if (a.a < 0.99f || b.a < 0.99f) continue;
            (x % 64 == 0 ? between : inside) += std::abs(double{a.g} - double{b.g});
            ++(x % 64 == 0 ? betweens : insides);
        }
    ASSERT_GT(betweens, 100);
    EXPECT_LT(between / betweens, 1.05 * inside / insides + 1e-4);
}

TEST(volume_splat, every_cutoff_is_drawn) {
    // Others than 2.25 have polynomials of other degrees, in loops that are not unrolled.
    for (const double cutoff : {1.0, 2.25, 2.6, 3.0, 5.0, 8.0})
        for (const bool orthographic : {false, true}) {
            Gaussians model = row_of_values(2, 1);
            model.cutoff = static_cast<float>(cutoff);
            const Camera camera = towards({3, 1, 5}, {0, 0, 0.5}, orthographic);
            SlabOptions many;
            many.slabs = 128;
            const VolumeImage slabs =
                render_volume_splat(model, "heat", two_colors(), camera, 24, 24, many);
            const VolumeImage exact =
                render_volume_trace(model, "heat", two_colors(), camera, 24, 24);
            const ValueMap most = render_maximum_splat(model, "heat", camera, 24, 24, many);
            const ValueMap traced = render_maximum_trace(model, "heat", camera, 24, 24);
            float opaque = 0;
            std::size_t shown = 0;
            for (std::size_t n = 0; n < exact.pixel.size(); ++n) {
                opaque = std::max(opaque, exact.pixel[n].a);
                EXPECT_NEAR(slabs.pixel[n].a, exact.pixel[n].a, 2e-3) << cutoff << " at " << n;
                shown += !std::isnan(traced.value[n]) && !std::isnan(most.value[n]);
            }
            EXPECT_GT(opaque, 0.1) << cutoff;
            EXPECT_GT(shown, 20u) << cutoff;
        }
}

TEST(volume_splat, what_is_wrong_is_refused_in_one_line) {
    const Gaussians model = row_of_values(1, 0);
    const Camera camera = towards({0, 0, 6}, {0, 0, 0}, true);
    const auto refused = [&](const std::string& field, const SlabOptions& options) {
        try {
            (void)render_volume_splat(model, field, two_colors(), camera, 8, 8, options);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    SlabOptions none, many;
    none.slabs = 0, many.slabs = 1000000;
    EXPECT_EQ(refused("heat", none), "splat: 0 depth slabs, expected 1 to 1024");
    EXPECT_EQ(refused("heat", many), "splat: 1000000 depth slabs, expected 1 to 1024");
    EXPECT_NE(refused("cold", {}).find("cold"), std::string::npos);
    EXPECT_TRUE(
        render_volume_splat(row_of_values(0, 0), "heat", two_colors(), camera, 8, 8).pixel[0].a ==
        0);
}

}  // namespace
}  // namespace vog
