// quantity_gl_test.cpp: fields, clips and volumes by value in OpenGL against the CPU's splat, from outside, inside, beside,
// and under parallel rays.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

#include "gl/shade_gl.h"
#include "gl/slabs_gl.h"
#include "quantity/look.h"
#include "render/splat/fields/field_splat.h"
#include "render/splat/volume/volume_splat.h"
#include "support/data.h"
#include "viewer/headless.h"
#include "vog/compare.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/picture.h"
#include "vog/renderer.h"
#include "vog/sample.h"

namespace vog::test {

using namespace viewer;

namespace {

/// A cloud with its values, and a vector field of planes with residuals.
Gaussians cloud_with_fields() {
    MomentOptions options;
    options.block_voxels = 8;
    options.own_field = "density";
    Gaussians model = convert_moments(sample_cloud({.size = 64}), options);
    VectorField flow;
    flow.name = "flow";
    flow.upper = 3;
    const auto per_radius = static_cast<float>(3 / view_box(model).radius());
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3f at = per_radius * model.mean[i];
        flow.value.push_back({std::sin(at.y), std::cos(at.x), at.z});
        flow.gradient[0].push_back({0, per_radius * std::cos(at.y), 0});
        flow.gradient[1].push_back({-per_radius * std::sin(at.x), 0, 0});
        flow.gradient[2].push_back({0, 0, per_radius});
        const float share = 0.5f + 0.5f * std::sin(2 * at.x);
        flow.covariance.push_back({0.04f, 0.01f * share, 0, 0.09f * share, -0.01f * share, 0.02f});
    }
    model.fields.vector.push_back(std::move(flow));
    return model;
}

struct View {
    const char* name;
    Camera camera;
};
std::vector<View> views(const Gaussians& model) {
    const Box box = view_box(model);
    Camera inside = paper_view(box);
    inside.eye = inside.look_at;
    inside.look_at = inside.eye + Vec3d{0.3, 0.1, -1};
    inside.fov_degrees = 75;
    Camera parallel = paper_view(box);
    parallel.orthographic_width = 2.2 * box.radius();
    return {{"paper", paper_view(box)},
            {"inside", inside},
            {"beside", orbit_view(box, {-69, 6, 0.6, 90})},
            {"parallel", parallel}};
}

constexpr int kWidth = 180, kHeight = 140;

/// What the window draws of a field.
ResolvedPicture picture_of(Show show, const std::string& field, const Camera& camera,
                           const VolumeLook& look = {}, std::optional<int> slabs = {},
                           const ValueTransfer* transfer = nullptr,
                           FieldPart part = FieldPart::value) {
    PictureRequest request;
    request.show = show, request.camera = camera;
    request.width = kWidth, request.height = kHeight;
    request.look = look, request.options.clip = look.clip;
    request.slabs = slabs;
    return sums_of(request, {field, part}, transfer);
}

/// Sums as the window draws them.
SumImage drawn(const Gaussians& model, const ResolvedPicture& picture) {
    const GlModel on_device(model);
    const GlTarget target(GL_RGBA32F, kWidth, kHeight);
    target.clear();
    const Show show = picture.request.show;
    std::optional<GlField> field;
    if (!is_depth(show)) field.emplace(on_device, model, picture.field);
    if (is_by_value(show))
        GlSlabs().add(
            {&on_device, &*field, model.fields.find_scalar(picture.field.field), &model, picture},
            picture.camera(), {}, target);
    else
        GlFieldSums().add(on_device, field ? &*field : nullptr, picture.camera(), {},
                          picture.request.options.clip, target);
    return {kWidth, kHeight, 4, target.read_floats()};
}

/// Box of the middle of a model, a part of which it cuts through.
Clipping middle_of(const Gaussians& model) {
    const Box box = view_box(model);
    const Vec3d center = box.center(), size = box.upper - box.lower;
    Clipping clip;
    clip.box = Box{center - 0.3 * size, center + 0.2 * size};
    return clip;
}

/// Expects 55 dB, and no channel of a pixel off by more than 2 of 255.
void expect_same(const Image& expected, const Image& image) {
    const PictureDifference difference = compare(expected, image);
    EXPECT_GE(difference.psnr_db, 55);
    EXPECT_LE(difference.largest, 2)
        << "at " << difference.largest_column << ", " << difference.largest_row;
}

void expect_same_map(const Gaussians& model, const FieldChoice& choice, const Camera& camera) {
    const FieldMaps maps = render_field_splat(model, choice, camera, kWidth, kHeight);
    const ResolvedPicture picture =
        picture_of(Show::mean, choice.field, camera, {}, {}, nullptr, choice.part);
    const Sums numbers =
        numbers_of(drawn(model, picture), picture, unit_of(model.fields, choice.field));
    const FieldMaps shown{kWidth, kHeight, numbers.column, numbers.mean, numbers.deviation};
    const auto& map = named_transfer_function("viridis");
    for (const Show show : {Show::mean, Show::deviation}) {
        // A root mean square has no deviation in sums.
        if (choice.part == FieldPart::magnitude && show == Show::deviation) continue;
        SCOPED_TRACE(word_of(show));
        const auto& values = show == Show::mean ? maps.mean : maps.deviation;
        const ValueMap expected = visible_values(maps, values, kLeastColumn);
        const ColorScale scale = fitted_scale(values_for_scale(maps, values), ScaleFit::linear);
        const auto& numbers_shown = show == Show::mean ? shown.mean : shown.deviation;
        expect_same(shade_map(expected, map, scale),
                    shade_map(visible_values(shown, numbers_shown, kLeastColumn), map, scale));
    }
}

/// The window's own pass over sums, as the pictures above are from numbers.
Image shaded(const SumImage& sums, const ShadeView& view, const Look& look) {
    const GlTarget on_device(GL_RGBA32F, sums.width, sums.height);
    on_device.upload(sums.value);
    const GlTarget picture(GL_RGBA8, sums.width, sums.height);
    picture.bind();
    GlShade shade;
    shade.set_look(look);
    shade.draw({&on_device, 1}, {&on_device, 1}, view, {0, 0, sums.width, sums.height});
    return read_picture(sums.width, sums.height);
}

}  // namespace

class quantity_gl : public headless {};

TEST_F(quantity_gl, maps_are_the_cpus) {
    const Gaussians model = cloud_with_fields();
    for (const View& view : views(model))
        for (const FieldChoice& choice : {FieldChoice{"density", FieldPart::value},
                                          {"flow", FieldPart::view},
                                          {"flow", FieldPart::y},
                                          {"flow", FieldPart::magnitude}}) {
            SCOPED_TRACE(std::string(view.name) + " " + field_label(choice));
            expect_same_map(model, choice, view.camera);
        }
}

TEST_F(quantity_gl, maxima_are_the_cpus) {
    const Gaussians model = cloud_with_fields();
    Gaussians other = model;  // a field beside the density: without the limit of a density's means
    other.fields.scalar.push_back(other.fields.scalar.front());
    other.fields.scalar.back().name = "other";
    other.fields.scalar.back().is_measure = false;
    const FieldUnit unit = unit_of(other.fields, "density");
    VolumeLook clipped;
    clipped.clip = middle_of(model);
    const auto& map = named_transfer_function("viridis");
    for (const View& view : views(model))
        for (const auto& [name, field, look, slabs] :
             {std::tuple{"density", "density", VolumeLook{}, kMaximumSlabs},
              {"other", "other", VolumeLook{}, kMaximumSlabs},
              {"clip", "density", clipped, kMaximumSlabs},
              {"a few slabs", "density", VolumeLook{}, 13}}) {
            SCOPED_TRACE(std::string(view.name) + " " + name);
            SlabOptions options;
            options.slabs = slabs;
            options.look = look;
            const ValueMap cpu =
                render_maximum_splat(other, field, view.camera, kWidth, kHeight, options);
            const ResolvedPicture picture =
                picture_of(Show::maximum, field, view.camera, look, slabs);
            const Sums numbers = numbers_of(drawn(other, picture), picture, unit);
            // Of the field's range: from inside, maxima span a 500th of it.
            const ColorScale scale{.low = 0, .high = 1};
            expect_same(shade_map(cpu, map, scale),
                        shade_map({kWidth, kHeight, numbers.maximum}, map, scale));
        }
}

TEST_F(quantity_gl, shading_of_sums_is_shade_map) {
    const Gaussians model = cloud_with_fields();
    const Camera camera = paper_view(view_box(model));
    const ResolvedPicture picture = picture_of(Show::mean, "density", camera);
    const SumImage sums = drawn(model, picture);
    const FieldUnit unit = unit_of(model.fields, "density");
    const Sums numbers = numbers_of(sums, picture, unit);
    const FieldMaps maps{kWidth, kHeight, numbers.column, numbers.mean, numbers.deviation};
    Look look;
    load_map(look, "viridis");
    for (const bool log : {false, true})
        for (const Show show : {Show::column, Show::mean, Show::deviation}) {
            SCOPED_TRACE(word_of(show));
            ShadeView view;
            view.show = show;
            view.unit = unit;
            view.scale = fitted_scale_of(numbers, show, log ? ScaleFit::log : ScaleFit::linear);
            view.least_column = static_cast<float>(kLeastColumn) * largest_column(numbers);
            view.checker = false;
            const ValueMap shown = colored_map(maps, show, ScaleFit::linear, view.scale).shown;
            expect_same(shade_map(shown, map_function(look), view.scale), shaded(sums, view, look));
        }
}

TEST_F(quantity_gl, differences_are_of_shares_of_the_scale) {
    const Gaussians model = cloud_with_fields();
    const ResolvedPicture what = picture_of(Show::mean, "density", paper_view(view_box(model)));
    const SumImage sums = drawn(model, what);
    ShadeView view;
    view.show = Show::mean;
    view.unit = unit_of(model.fields, "density");
    view.scale = fitted_scale_of(numbers_of(sums, what, view.unit), Show::mean, ScaleFit::linear);
    view.difference = true;
    view.checker = false;
    // An image less itself is grey wherever it shows something.
    const Image equal = shaded(sums, view, {});
    SumImage more = sums;
    const double step = 0.5 * (view.scale.high - view.scale.low) / view.unit.unit;
    for (std::size_t n = 0; n < more.value.size(); n += 4)
        more.value[n + 1] += static_cast<float>(step) * more.value[n];
    const GlTarget a(GL_RGBA32F, kWidth, kHeight), b(GL_RGBA32F, kWidth, kHeight);
    a.upload(more.value);
    b.upload(sums.value);
    const GlTarget picture(GL_RGBA8, kWidth, kHeight);
    picture.bind();
    GlShade shade;
    view.difference_limit = 0.5f;
    shade.draw({&a, 1}, {&b, 1}, view, {0, 0, kWidth, kHeight});
    const Image above = read_picture(kWidth, kHeight);
    int shown = 0;
    for (std::size_t n = 0; n < equal.pixel.size(); ++n) {
        if (equal.pixel[n] == Rgba{0, 0, 0, 1}) continue;
        ++shown;
        EXPECT_NEAR(equal.pixel[n].r, 0.8667f, 0.01f);
        EXPECT_NEAR(above.pixel[n].r, 0.706f, 0.01f);
        EXPECT_NEAR(above.pixel[n].b, 0.149f, 0.02f);
    }
    EXPECT_GT(shown, kWidth * kHeight / 20);
}

TEST_F(quantity_gl, clipped_depth_is_the_cpus) {
    const Gaussians model = cloud_with_fields();
    PictureRequest request{.width = kWidth, .height = kHeight};
    Clipping& clip = request.options.clip;
    clip = middle_of(model);
    clip.planes.push_back({{1, 2, 0.5}, dot(Vec3d{1, 2, 0.5}, view_box(model).center())});
    PictureRenderer cpu(scene_of(model));
    for (const View& view : views(model)) {
        SCOPED_TRACE(view.name);
        request.camera = view.camera;
        DepthImage expected = bare_depth(cpu, request);
        set_extinction(expected, auto_extinction(expected));
        VolumeLook look;
        look.clip = clip;
        const ResolvedPicture picture = picture_of(Show::depth, "", view.camera, look);
        const DepthImage depth = depth_of(numbers_of(drawn(model, picture), picture, {}));
        const DepthDifference difference = compare(expected, depth);
        EXPECT_GE(difference.grey.psnr_db, 55);
        EXPECT_LE(difference.grey.largest, 2);
    }
}

TEST_F(quantity_gl, volumes_by_value_are_the_cpus) {
    const Gaussians model = cloud_with_fields();
    const ScalarField& field = model.fields.scalar.front();
    const double middle = std::midpoint(field.lower, field.upper);
    const auto ramp = std::make_shared<const ValueTransfer>(
        over_range(named_transfer_function("viridis"), field.lower, field.upper, 6));
    const auto band = std::make_shared<const ValueTransfer>(
        band_transfer({{middle, field.upper, 1, 0.6f, 0.2f, 0.9}}, 4));
    VolumeLook plain, lit, aside, shadowed, all, clipped;
    lit.light = aside.light = all.light = true;
    aside.lights = shadowed.lights = all.lights = {{{1, 2, -1}}};
    shadowed.shadows = all.shadows = all.occlusion = true;
    clipped.clip = middle_of(model);
    for (const View& view : views(model))
        for (const auto& [name, transfer, look] : {std::tuple{"ramp", ramp, plain},
                                                   {"band", band, plain},
                                                   {"light", ramp, lit},
                                                   {"light aside", ramp, aside},
                                                   {"shadows", ramp, shadowed},
                                                   {"shadows of a band", band, shadowed},
                                                   {"all light", ramp, all},
                                                   {"clip", ramp, clipped}}) {
            SCOPED_TRACE(std::string(view.name) + " " + name);
            SlabOptions options;
            options.look = look;
            const VolumeImage cpu = render_volume_splat(model, "density", *transfer, view.camera,
                                                        kWidth, kHeight, options);
            const ResolvedPicture picture =
                picture_of(Show::volume, "density", view.camera, look, 32, transfer.get());
            const VolumeImage gl{kWidth, kHeight,
                                 numbers_of(drawn(model, picture), picture, {}).light};
            expect_same(over(cpu, {0, 0, 0, 1}), over(gl, {0, 0, 0, 1}));
        }
}

TEST_F(quantity_gl, edits_under_one_camera_draw_no_gaussians) {
    const Gaussians model = cloud_with_fields();
    const ScalarField& values = model.fields.scalar.front();
    const double middle = std::midpoint(values.lower, values.upper);
    const ValueTransfer ramp =
        over_range(named_transfer_function("viridis"), values.lower, values.upper, 6);
    const ValueTransfer band = band_transfer({{middle, values.upper, 1, 0.6f, 0.2f, 0.9}}, 4);
    const GlModel on_device(model);
    const GlField field(on_device, model, {"density", FieldPart::value});
    const GlTarget target(GL_RGBA32F, kWidth, kHeight);
    GlSlabs slabs;
    KeptSlabs kept;
    const auto draw = [&](const ResolvedPicture& picture, KeptSlabs* keep, Jitter jitter = {}) {
        target.clear();
        slabs.add({&on_device, &field, &values, &model, picture}, picture.camera(), jitter, target,
                  keep);
        return target.read_floats();
    };
    const auto is_drawn_anew = [&](const ResolvedPicture& picture) {
        const int before = kept.drawn();
        EXPECT_EQ(draw(picture, &kept), draw(picture, nullptr));
        return kept.drawn() > before;
    };
    VolumeLook lit, aside, clipped;
    lit.light = aside.light = true;
    aside.lights = {{{1, 2, -1}}};
    clipped.clip = middle_of(model);
    const Camera camera = paper_view(view_box(model));
    const auto of = [&](const ValueTransfer& transfer, const VolumeLook& look = {},
                        std::optional<int> count = 32) {
        return picture_of(Show::volume, "density", camera, look, count, &transfer);
    };
    EXPECT_TRUE(is_drawn_anew(of(ramp)));
    EXPECT_FALSE(is_drawn_anew(of(band)));
    draw(of(band), &kept, {0.2, 0.3});  // a sub-frame of the still picture
    EXPECT_FALSE(is_drawn_anew(of(ramp)));
    EXPECT_TRUE(is_drawn_anew(of(ramp, lit)));
    EXPECT_FALSE(is_drawn_anew(of(band, aside)));
    EXPECT_TRUE(is_drawn_anew(of(ramp, clipped)));
    EXPECT_TRUE(is_drawn_anew(of(ramp, {}, 30)));
    EXPECT_TRUE(is_drawn_anew(of(ramp)));
    ResolvedPicture aside_seen = of(ramp);
    aside_seen.request.camera->eye.x += 0.1;
    EXPECT_TRUE(is_drawn_anew(aside_seen));
}

}  // namespace vog::test
