// gradient_opacity_test.cpp: Gradient opacity against the closed form, and from renderer to renderer.
#include <gtest/gtest.h>

#include <cmath>

#include "render/by_value/value_pieces.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/light/illumination.h"
#include "render/reference/reference.h"
#include "render/splat/volume/volume_splat.h"
#include "render/trace/trace.h"
#include "support/field_models.h"
#include "support/gpus.h"
#include "support/layer_pictures.h"
#include "support/made_fields.h"
#include "support/model_psnr.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "vog/request_schema.h"

namespace vog::test {

namespace {

constexpr int kEdge = 32;
constexpr double kFlatExtinction = 0.05, kSlope = 0.125, kFactor = 0.4;

/// Values 1 for x < 16, then rising by kSlope a voxel.
double value_at(int x) { return 1 + kSlope * std::max(x - 16, 0); }
Volume half_sloped() {
    Volume volume;
    volume.name = "density";
    for (int x = 0; x < kEdge; x += 8)
        for (int y = 0; y < kEdge; y += 8)
            for (int z = 0; z < kEdge; z += 8) {
                Leaf& leaf = volume.leaves.emplace_back();
                leaf.origin = {x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n)
                    leaf.set(n, static_cast<float>(value_at(x + (n >> 6))));
            }
    return volume;
}
/// White of one extinction, by the gradient.
ValueTransfer white(std::vector<GradientOpacity> gradient) {
    return {"white",
            {{0, 1, 1, 1}, {9, 1, 1, 1}},
            {{0, 0.5}, {9, 0.5}},
            std::log(2) / kFlatExtinction,
            std::move(gradient)};
}
/// Extinction times kFactor at kSlope: 0 to 0.1, 1 from there on.
std::vector<GradientOpacity> of_slope() { return {{0, 0}, {kSlope - 0.02, 0}, {kSlope + 0.03, 1}}; }
Camera along_z() {
    Camera camera;
    camera.eye = {15.5, 15.5, 100}, camera.look_at = {15.5, 15.5, 0};
    camera.orthographic_width = kEdge;
    return camera;
}
const Rgba& middle(const VolumeImage& picture, int x) {
    return picture.pixel[static_cast<std::size_t>(16 * kEdge + x)];
}

/// A random model, and steep matter of it.
struct Steep {
    Gaussians model = [] {
        Gaussians made = random_gaussians(60, 0.1, 0.4, 5);
        add_random_fields(made, 12);
        return made;
    }();
    const ScalarField& field = model.fields.scalar.front();
    Camera camera;
    ValueTransfer transfer = rainbow(field);
    double steepest = 0;

    Steep() {
        camera.eye = {2, 1.5, 3}, camera.look_at = {0.1, 0.05, -0.1};
        for (const Vec3f& g : field.gradient)
            steepest = std::max(steepest, length(vec_cast<double>(g)));
        transfer.gradient = {{0.1 * steepest, 0}, {0.4 * steepest, 1}, {0.9 * steepest, 0.3}};
    }
};

}  // namespace

TEST(gradient_opacity, is_linear_between_its_points) {
    const by_value::ValuePieces pieces(white({{2, 0.25}, {4, 1}, {8, 0.5}}));
    const std::pair<double, double> expected[] = {{0, 0.25}, {2, 0.25}, {3, 0.625}, {4, 1},
                                                  {6, 0.75}, {8, 0.5},  {1e30, 0.5}};
    for (const auto& [magnitude, factor] : expected)
        EXPECT_NEAR(pieces.factor(magnitude), factor, 1e-6) << magnitude;
    EXPECT_EQ(by_value::ValuePieces(white({})).factor(3), 1);
}

TEST(gradient_opacity, of_voxels_draws_the_sloped_half_alone) {
    const Volume volume = half_sloped();
    const VoxelField field = own();
    const auto draw = [&](Interpolation interpolation) {
        VoxelGridOptions voxels;
        voxels.interpolation = interpolation;
        return render_volume_reference({&volume, 1}, {&field, 1}, white(of_slope()), along_z(),
                                       kEdge, kEdge, {}, {}, voxels);
    };
    // Under linear interpolation voxels at the faces fade to the background, and those beside them see that step, too.
    const auto expected = [](int x, double voxels) {
        return x < 16 ? 0 : 1 - std::exp(-kFlatExtinction * kFactor * voxels);
    };
    const VolumeImage constant = draw(Interpolation::constant);
    const VolumeImage linear = draw(Interpolation::linear);
    for (int x = 2; x < kEdge - 2; ++x) {
        // The voxel of the edge has half of the slope, and those at both ends of the ray the steep step to nothing.
        if (std::abs(x - 16) <= 1) continue;
        const double ends = 1 - std::exp(-2 * kFlatExtinction * (x < 16 ? 1 : 1 - kFactor));
        const double clear = 1 - expected(x, kEdge);
        EXPECT_NEAR(middle(constant, x).a, 1 - clear * (1 - ends), 1e-5) << x;
        EXPECT_GE(middle(linear, x).a, expected(x, kEdge - 4)) << x;
        EXPECT_LE(middle(linear, x).a, 1 - clear * std::exp(-5 * kFlatExtinction)) << x;
    }
    EXPECT_GT(middle(linear, 24).a, middle(linear, 8).a + 0.3);
}

TEST(gradient_opacity, casts_the_shadows_of_what_it_leaves) {
    // The flat half shadows nothing: light from it passes undimmed.
    const Volume volume = half_sloped();
    const VoxelField field = own();
    VolumeLook look;
    look.shadows = true;
    look.lights = {{{-1, 0, 0}}};
    const auto shade = [&](const ValueTransfer& transfer) {
        const VolumeImage picture = render_volume_reference({&volume, 1}, {&field, 1}, transfer,
                                                            along_z(), kEdge, kEdge, {}, look);
        return double{middle(picture, 20).r} / double{middle(picture, 20).a};
    };
    const auto lit = [&](double depth) { return look.ambient + look.diffuse * std::exp(-depth); };
    EXPECT_NEAR(shade(white({})), lit(kFlatExtinction * 20.5), 0.01);
    // A sheet at the face, where values begin, then the slope.
    const double sheet = kFlatExtinction * (1 + 0.5);
    EXPECT_NEAR(shade(white(of_slope())), lit(sheet + kFlatExtinction * kFactor * 4), 0.04);
}

TEST(gradient_opacity, of_a_factor_1_changes_nothing) {
    const Steep of;
    ValueTransfer all = of.transfer, none = of.transfer;
    all.gradient = {{0, 1}, {1, 1}}, none.gradient = {};
    SlabOptions lit;
    lit.look.light = true;  // has gradients in any case
    const auto draw = [&](const ValueTransfer& transfer) {
        return render_volume_splat(of.model, of.field.name, transfer, of.camera, kEdge, kEdge, lit);
    };
    EXPECT_GT(psnr(draw(all), draw(none)), 90);
}

TEST(gradient_opacity, is_the_same_by_every_renderer) {
    constexpr int kSize = kEdge / 2;
    const Steep of;
    for (const bool light : {false, true})
        for (const bool shadows : {false, true}) {
            SlabOptions options;
            options.slabs = 256;
            options.look.light = light, options.look.shadows = shadows;
            options.look.lights = {{{1, 2, 1}}};
            const auto splat_of = [&](const ValueTransfer& transfer) {
                return render_volume_splat(of.model, of.field.name, transfer, of.camera, kSize,
                                           kSize, options);
            };
            const VolumeImage splat = splat_of(of.transfer);
            ValueTransfer without = of.transfer;
            without.gradient = {};
            EXPECT_LT(psnr(splat, splat_of(without)), 35);
            const VolumeImage trace =
                render_volume_trace(of.model, of.field.name, of.transfer, of.camera, kSize, kSize,
                                    {}, {}, options.look);
            EXPECT_GT(psnr(splat, trace), 38) << light << shadows;
            for (const std::string& target : splat_targets()) {
                options.simd_target = target;
                EXPECT_GT(psnr(splat, splat_of(of.transfer)), 90) << target;
            }
            for (const Gpu& gpu : gpus()) {
                gpu.prepare();
                const VolumeImage picture = GpuPictures(gpu.renderer, of.model)
                                                .volume(of.field.name, of.transfer, of.camera,
                                                        kSize, kSize, 256, options.look);
                EXPECT_GT(psnr(splat, picture), 60) << gpu.name << light << shadows;
            }
        }
}

TEST(gradient_opacity, of_a_model_is_that_of_its_voxels) {
    const Volume volume = half_sloped();
    MomentOptions fine;
    fine.block_voxels = 2;
    Gaussians model = convert_moments(volume, fine);
    const std::vector<VoxelField> field{measure_field(volume, "density")};
    add_fields(model, {&volume, 1}, {&field, 1});
    const ScalarField& values = *scalar_to_show(model.fields);
    // Planes over two voxels of constant value have 0.75 of the slope, softened ones up to 0.9: the factor is 0.32 of 0.375.
    const ValueTransfer transfer = white({{0.02, 0}, {0.3, 1}});
    const VolumeImage splat =
        render_volume_splat(model, values.name, transfer, along_z(), kEdge, kEdge, {.slabs = 128});
    for (int x = 4; x < kEdge - 4; ++x) {
        if (std::abs(x - 16) <= 3) continue;
        const double expected = x < 16 ? 0 : 1 - std::exp(-kFlatExtinction * 0.375 * kEdge);
        EXPECT_NEAR(middle(splat, x).a, expected, 0.1) << x;
    }
}

TEST(gradient_opacity, of_layers_adds_up_in_any_order) {
    const vog::Scene scene = scene_of(Steep().model);
    Layer steep, flat;
    steep.field = flat.field = Steep().field.name;
    const double most = Steep().steepest;
    steep.transfer.gradient = {{0.3 * most, 0}, {0.5 * most, 1}};
    flat.transfer.gradient = {{0.3 * most, 1}, {0.5 * most, 0}};
    const std::vector<Rgba> one = light_of({scene, scene}, request_of({steep, flat}));
    const std::vector<Rgba> other = light_of({scene, scene}, request_of({flat, steep}));
    // Together they are all there is.
    Layer all = steep;
    all.transfer.gradient = {{0, 1}, {1, 1}};
    const std::vector<Rgba> whole = light_of({scene}, request_of({all}));
    double off = 0, off_whole = 0;
    for (std::size_t n = 0; n < one.size(); ++n) {
        off = std::max(off, std::abs(double{one[n].a} - double{other[n].a}));
        off_whole += std::abs(double{one[n].a} - double{whole[n].a}) / double(one.size());
    }
    EXPECT_LT(off, 1e-5);
    EXPECT_LT(off_whole, 0.01);
}

TEST(gradient_opacity, of_percentages_is_that_of_the_steepest_gradient) {
    const auto same = [](const vog::Scene& scene, const std::string& field) {
        PictureRequest request;
        request.show = Show::volume, request.field = field, request.width = request.height = 24;
        const double steepest = steepest_gradient(scene, field);
        ASSERT_GT(steepest, 0);
        request.transfer.gradient = {{0.25 * steepest, 0}, {steepest, 1}};
        const Picture stated = render(scene, request);
        request.transfer.gradient = {{0.25, 0}, {1, 1}};
        request.transfer.gradient_of_steepest = true;
        const Picture shares = render(scene, request);
        EXPECT_EQ(shares.opacity, stated.opacity);
        EXPECT_EQ(request_json(shares.made.request), request_json(stated.made.request));
    };
    const Steep of;
    same(scene_of(of.model), of.field.name);
    same(scene_of(half_sloped()), "density");
}

TEST(gradient_opacity, is_kept_by_requests_and_files) {
    PictureRequest request;
    request.show = Show::volume;
    set_member(request, "gradient_opacity", {"0:0,2.5:0.5,40:1"});
    const std::vector<GradientOpacity> points{{0, 0}, {2.5, 0.5}, {40, 1}};
    EXPECT_EQ(request.transfer.gradient, points);
    EXPECT_EQ(request_of_json(request_json(request)).transfer.gradient, points);
    set_member(request, "gradient_opacity", {"0%:0,12.5%:0.5,100%:1"});
    const std::vector<GradientOpacity> shares{{0, 0}, {0.125, 0.5}, {1, 1}};
    const PictureRequest again = request_of_json(request_json(request));
    EXPECT_EQ(again.transfer.gradient, shares);
    EXPECT_TRUE(again.transfer.gradient_of_steepest);
    const std::string file = ::testing::TempDir() + "gradient_opacity.json";
    write_value_transfer(file, white(points));
    EXPECT_EQ(transfer_points(file).points.gradient, points);
    set_member(request, "layers", {"tf=gray,gradient-opacity=0:0,3:1"});
    EXPECT_EQ(request.layers.front().transfer.gradient,
              (std::vector<GradientOpacity>{{0, 0}, {3, 1}}));
}

TEST(gradient_opacity, refuses_bad_points_in_one_line) {
    const auto refused = [](const std::string& words) {
        PictureRequest request;
        return refusal([&] { set_member(request, "gradient_opacity", {words}); });
    };
    const std::string expected = ": expected MAGNITUDE:FACTOR, at least two";
    for (const char* bad : {"0:0", "1:0,1:1", "2:0,1:1", "-1:0,1:1", "0:0,1:1.5", "0:0,1:-1", "0,1",
                            "a:b,c:d", "0:0,nan:1", "0:0,50%:1", "0%:0,%:1", ":,:", "0:0:0,1:1",
                            "0:0,1:0,2:0,3:0,4:0,5:0,6:0,7:0,8:0"})
        EXPECT_NE(refused(bad).find(expected), std::string::npos) << bad << ": " << refused(bad);
    Volume flat = half_sloped();
    for (Leaf& leaf : flat.leaves)
        for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, 1);
    PictureRequest request;
    request.show = Show::volume;
    request.transfer.gradient = of_slope();
    EXPECT_NE(refusal([&] { (void)render(scene_of(flat), request); }).find("no gradient"),
              std::string::npos);
    request.show = Show::column;
    EXPECT_NE(refusal([&] { require_effects(request); }).find("has no effect on show 'column'"),
              std::string::npos);
}

}  // namespace vog::test
