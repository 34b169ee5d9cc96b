// option_checks.cpp: Pictures of options.ply by GPU renderers and the CPU's, written by prepare.cpp.
#include "option_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "option_scene.h"
#include "pfm.h"
#include "vog/gpu.h"
#include "vog/gpu_pictures.h"
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

int check_pictures(const OptionScene& scene, Renderer renderer) {
    const std::string name = info_of(renderer).name;
    const auto& [folder, model, camera] = scene;
    const Clipping clip = option_clip(model);
    GpuPictures pictures(renderer, model);
    int failures = 0;
    const auto against = [&](const std::string& file, const DepthImage& image, double tolerance) {
        failures += check(name, file, worst_of(scene.expected(file), image), tolerance);
    };
    const int width = kOptionWidth, height = kOptionHeight;
    against("clip", pictures.depth(camera, width, height, clip), kOfTheCpu);
    const ScalarField& field = model.fields.scalar.front();
    for (const bool clipped : {false, true}) {
        const FieldMaps maps = pictures.fields({field.name, FieldPart::value}, camera, width,
                                               height, clipped ? clip : Clipping{});
        const std::string of = clipped ? "clipped_" : "";
        against(of + "column", as_image(maps.column), kOfTheCpu);
        against(of + "mean", as_image(maps.mean), 1e-3);
        against(of + "deviation", as_image(maps.deviation), 1e-3);
    }
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
        if (std::isnan(expected.depth[n])) continue;
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
    against("samples", optix.render(camera, width, height, {}, nullptr, kSamples));
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
    int failures = check_cuda(scene) + check_pictures(scene, Renderer::cuda);
#ifdef VOG_OPTIX
    failures += check_optix(scene) + check_pictures(scene, Renderer::optix);
#endif
    return failures;
}

}  // namespace vog::test
