// option_checks.cpp: Pictures of options.ply by GPU renderers and the CPU's, written by prepare.cpp.
#include "option_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "option_scene.h"
#include "pfm.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/shown_field.h"
#include "support/scenes.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

constexpr double kOfTheCpu = 1e-4;

struct OptionScene {
    std::filesystem::path folder;
    Gaussians model = read_ply(folder / "options.ply");
    Camera camera = option_camera(model);

    DepthImage expected(const std::string& name) const {
        return read_pfm(folder / (name + ".pfm"));
    }
};

DepthImage as_image(const std::vector<float>& values) {
    DepthImage image(kOptionWidth, kOptionHeight);
    image.depth = values;
    return image;
}
DepthImage channel(const VolumeImage& picture, float Rgba::*of) {
    DepthImage image(picture.width, picture.height);
    std::ranges::transform(picture.pixel, image.depth.begin(), of);
    return image;
}

/// Gaussians wider than pixels, with a field: the closed form is what a picture is of.
Gaussians wide_model() {
    Gaussians model = random_gaussians(40, 0.2, 0.5, 5);
    Random random(6);
    ScalarField& field = model.fields.scalar.emplace_back();
    field.name = "heat";
    for (std::size_t i = 0; i < model.size(); ++i) {
        field.value.push_back(static_cast<float>(random(15, 25)));
        field.gradient.push_back(vec_cast<float>(random.in_cube(5)));
        field.deviation.push_back(static_cast<float>(random(0, 2)));
        field.skewness.push_back(0);
    }
    return model;
}
constexpr int kWideWidth = 96, kWideHeight = 64;
Camera wide_camera(double width) {
    Camera camera;
    camera.eye = {2, 1.5, 3};
    camera.look_at = {0, 0, 0};
    camera.fov_degrees = 40;
    camera.orthographic_width = width;
    return camera;
}
Clipping wide_clip() {
    Clipping clip;
    clip.box = Box{{-0.6, -0.4, -0.7}, {0.5, 0.6, 0.1}};
    clip.planes = {{{1, 0.7, -0.4}, -0.3}};
    return clip;
}

/// Column, mean and deviation of every pixel in double precision; NaN where the column is below a thousandth of the largest.
std::array<DepthImage, 3> closed_form(const Gaussians& model, const Camera& camera,
                                      const Clipping& clip) {
    std::array<DepthImage, 3> maps;
    for (DepthImage& map : maps) map = DepthImage(kWideWidth, kWideHeight);
    const CameraFrame frame = frame_of(camera, kWideWidth, kWideHeight);
    for (int y = 0; y < kWideHeight; ++y)
        for (int x = 0; x < kWideWidth; ++x) {
            FieldSums all;
            for (std::size_t i = 0; i < model.size(); ++i) {
                const FieldSums one = field_sums(model, {"heat", FieldPart::value}, i,
                                                 frame.origin(x, y), frame.direction(x, y), clip);
                all.column += one.column, all.first += one.first, all.second += one.second;
            }
            const double mean = all.first / all.column;
            maps[0].at(x, y) = static_cast<float>(all.column);
            maps[1].at(x, y) = static_cast<float>(mean);
            maps[2].at(x, y) =
                static_cast<float>(std::sqrt(std::max(all.second / all.column - mean * mean, 0.0)));
        }
    const float least = 1e-3f * *std::ranges::max_element(maps[0].depth);
    for (std::size_t n = 0; n < maps[0].depth.size(); ++n)
        if (!(maps[0].depth[n] >= least)) maps[1].depth[n] = maps[2].depth[n] = NAN;
    return maps;
}

int check_closed_form(Renderer renderer) {
    const std::string name = info_of(renderer).name;
    const Gaussians model = wide_model();
    GpuPictures pictures(renderer, model);
    int failures = 0;
    for (const double width : {0.0, 3.0})
        for (const Clipping& clip : {Clipping{}, wide_clip()}) {
            const Camera camera = wide_camera(width);
            const std::string of = std::string(clip.empty() ? "" : "clipped ") +
                                   (width > 0 ? "parallel " : "") + "heat: ";
            const auto expected = closed_form(model, camera, clip);
            const FieldMaps maps =
                pictures.fields({"heat", FieldPart::value}, camera, kWideWidth, kWideHeight, clip);
            const auto against = [&](const char* what, const DepthImage& exact,
                                     const std::vector<float>& found, double tolerance) {
                DepthImage image = exact;
                image.depth = found;
                failures += check(name, of + what, worst_of(exact, image), tolerance);
            };
            against("T", expected[0], pictures.depth(camera, kWideWidth, kWideHeight, clip).depth,
                    1e-5);
            against("column", expected[0], maps.column, 1e-5);
            against("mean", expected[1], maps.mean, 2e-5);
            against("deviation", expected[2], maps.deviation, 1e-4);
        }
    return failures;
}

int check_pictures(const OptionScene& scene, Renderer renderer) {
    const std::string name = info_of(renderer).name;
    const auto& [folder, model, camera] = scene;
    GpuPictures pictures(renderer, model);
    int failures = 0;
    const auto against = [&](const std::string& file, const DepthImage& image, double tolerance) {
        failures += check(name, file, worst_of(scene.expected(file), image), tolerance);
    };
    const int width = kOptionWidth, height = kOptionHeight;
    const ScalarField& field = model.fields.scalar.front();
    const FieldMaps maps = pictures.fields({field.name, FieldPart::value}, camera, width, height);
    against("column", as_image(maps.column), kOfTheCpu);
    against("mean", as_image(maps.mean), 1e-3);
    against("deviation", as_image(maps.deviation), 1e-3);
    const double unit = view_box(model).radius() / 50;
    const ValueTransfer transfer = option_transfer(field, unit);
    for (const int slabs : {32, 70}) {
        const VolumeImage volume =
            pictures.volume(field.name, transfer, camera, width, height, slabs, option_look(model));
        const std::string of = fmt::format("volume{}_", slabs);
        against(of + "r", channel(volume, &Rgba::r), 1e-3);
        against(of + "g", channel(volume, &Rgba::g), 1e-3);
        against(of + "b", channel(volume, &Rgba::b), 1e-3);
        against(of + "a", channel(volume, &Rgba::a), 1e-3);
    }
    // Rounding decides at the share of the densest slab from which one counts: a few pixels may be of another slab.
    const DepthImage expected = scene.expected("maximum");
    const ValueMap maximum = pictures.maximum(field.name, camera, width, height, kMaximumSlabs);
    std::size_t shown = 0, other = 0;
    for (std::size_t n = 0; n < maximum.value.size(); ++n) {
        if (std::isnan(expected.depth[n]) && std::isnan(maximum.value[n])) continue;
        ++shown;
        other +=
            !(std::abs(maximum.value[n] - expected.depth[n]) <= 1e-3 * (field.upper - field.lower));
    }
    failures += check(name, "maximum, share of pixels", double(other) / double(shown), 0.02);
    // Pictures of other sizes leave no trace.
    const FieldMaps before = pictures.fields({field.name, FieldPart::value}, camera, 90, 70);
    (void)pictures.fields({field.name, FieldPart::value}, camera, 640, 480);
    (void)pictures.depth(camera, 17, 5);
    const FieldMaps after = pictures.fields({field.name, FieldPart::value}, camera, 90, 70);
    failures += check(name, "fields, resized", before.column == after.column ? 0 : 1, 0);
    return failures;
}

int check_cuda(const OptionScene& scene) {
    const auto& [folder, model, camera] = scene;
    int failures =
        check("cuda", "kappa",
              worst_of(scene.expected("kappa"),
                       CudaSplat(model, kKappa).render(camera, kOptionWidth, kOptionHeight)),
              kOfTheCpu);
    CudaSplat splat(model);
    const DepthImage before = splat.render(camera, 90, 70);
    (void)splat.render(camera, 640, 480);
    (void)splat.render(camera, 17, 5);
    failures +=
        check("cuda", "resized", splat.render(camera, 90, 70).depth == before.depth ? 0 : 1, 0);
    return failures;
}

#ifdef VOG_OPTIX
/// Rays through the centres of equal parts of pixels are those of a picture that much finer.
int check_samples() {
    constexpr int kSamples = 3;
    const Scene fine{"samples", wide_model(), wide_camera(0), kSamples * kWideWidth,
                     kSamples * kWideHeight};
    const std::vector<double> exact = exact_depth(fine);
    DepthImage mean(kWideWidth, kWideHeight);
    for (int y = 0; y < fine.height; ++y)
        for (int x = 0; x < fine.width; ++x)
            mean.at(x / kSamples, y / kSamples) += static_cast<float>(
                exact[static_cast<std::size_t>(y * fine.width + x)] / (kSamples * kSamples));
    OptixModel optix(fine.model);
    return check(
        "optix", "samples",
        worst_of(mean, optix.render(fine.camera, kWideWidth, kWideHeight, {}, nullptr, kSamples)),
        1e-5);
}

int check_optix(const OptionScene& scene) {
    const auto& [folder, model, camera] = scene;
    int failures = 0;
    const auto against = [&](const std::string& file, const DepthImage& image) {
        failures += check("optix", file, worst_of(scene.expected(file), image), kOfTheCpu);
    };
    const int width = kOptionWidth, height = kOptionHeight;
    against("boxes", OptixModel(model, {kBoxSigma, 0}).render(camera, width, height));
    against("kappa", OptixModel(model, {0, kKappa}).render(camera, width, height));
    OptixModel optix(model);
    against("stop", optix.render(camera, width, height, stopping_rays()));
    failures += check_samples();
    std::ifstream file(folder / "counts.json");
    const auto counts = nlohmann::json::parse(file);
    TraceOptions collect;
    collect.anyhit = AnyHit::collect;
    collect.hits_per_slab = 8;
    TraceReport report;
    (void)optix.render(camera, width, height, collect, &report);
    // Rounding decides at the rims of supports.
    const auto differs = [&](const char* name, double found) {
        const double expected = counts.at(name);
        failures += check("optix", name, std::abs(found - expected) / expected, 1e-4);
    };
    differs("hits", static_cast<double>(report.hits));
    differs("slabs", static_cast<double>(report.slabs));
    failures += check("optix", "most_slabs",
                      std::abs(report.most_slabs - counts.at("most_slabs").get<int>()), 1);
    (void)optix.render(camera, 640, 480);
    against("stop", optix.render(camera, width, height, stopping_rays()));
    return failures;
}
#endif

}  // namespace

double worst_of(const DepthImage& expected, const DepthImage& image) {
    double largest = 0, worst = 0;
    for (std::size_t n = 0; n < expected.depth.size(); ++n) {
        if (std::isnan(expected.depth[n])) continue;
        if (!std::isfinite(image.depth[n])) return HUGE_VAL;
        largest = std::max(largest, std::abs(double{expected.depth[n]}));
        worst = std::max(worst, std::abs(double{image.depth[n]} - double{expected.depth[n]}));
    }
    return largest > 0 ? worst / largest : worst > 0 ? HUGE_VAL : 0;
}

bool check(const std::string& renderer, const std::string& what, double worst, double tolerance) {
    const bool failed = !(worst <= tolerance);
    fmt::print("{} {:<20} {:<26} {:.2e} of {:.0e}\n", failed ? "FAILED" : "ok    ", renderer, what,
               worst, tolerance);
    return failed;
}

int check_options(const std::filesystem::path& folder) {
    const OptionScene scene{folder};
    int failures = check_cuda(scene) + check_pictures(scene, Renderer::cuda) +
                   check_closed_form(Renderer::cuda);
#ifdef VOG_OPTIX
    failures += check_optix(scene) + check_pictures(scene, Renderer::optix) +
                check_closed_form(Renderer::optix);
#endif
    return failures;
}

}  // namespace vog::test
