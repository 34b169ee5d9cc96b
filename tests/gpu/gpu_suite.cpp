// gpu_suite.cpp: Every GPU renderer against the closed form on the shared scenes and against the CPU's
// pictures; with --bench, their speed. vog_gpu_suite FOLDER [--bench OUT.json]
// Times are by CUDA events: median, minimum and maximum of 20 pictures after a warm-up.
#include <cuda_runtime_api.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "option_checks.h"
#include "option_scene.h"
#include "pfm.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/shown_field.h"
#include "support/scenes.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

struct GpuRenderer {
    std::string name;
    /// Draws one picture and sets `ms` to its device time.
    std::function<DepthImage(const Gaussians&, const Camera&, int, int)> once;
    /// Prepares the model for many pictures.
    std::function<std::function<double(const Camera&, int, int)>(const Gaussians&)> timed;
};

std::vector<GpuRenderer> renderers() {
    std::vector<GpuRenderer> all;
    all.push_back({"cuda",
                   [](const Gaussians& model, const Camera& camera, int width, int height) {
                       return CudaSplat(model).render(camera, width, height);
                   },
                   [](const Gaussians& model) {
                       auto splat = std::make_shared<CudaSplat>(model);
                       return [splat](const Camera& camera, int width, int height) {
                           (void)splat->render(camera, width, height);
                           return splat->gpu_ms();
                       };
                   }});
#ifdef VOG_OPTIX
    const auto optix = [&](const std::string& name, TraceOptions options) {
        all.push_back(
            {name,
             [options](const Gaussians& model, const Camera& camera, int width, int height) {
                 return OptixModel(model).render(camera, width, height, options);
             },
             [options](const Gaussians& model) {
                 auto scene = std::make_shared<OptixModel>(model);
                 return [scene, options](const Camera& camera, int width, int height) {
                     (void)scene->render(camera, width, height, options);
                     return scene->gpu_ms();
                 };
             }});
    };
    TraceOptions collect;
    collect.anyhit = AnyHit::collect;
    optix("optix_accumulate", {});
    optix("optix_collect", collect);
    collect.hits_per_slab = 16;
    optix("optix_collect_by_16", collect);
#endif
    return all;
}

/// Largest difference relative to the largest T; infinite if a value is not finite.
double worst_of(const std::vector<double>& expected, const DepthImage& image) {
    double largest = 0, worst = 0;
    for (std::size_t n = 0; n < expected.size(); ++n) {
        if (!std::isfinite(image.depth[n]) || image.depth[n] < 0) return HUGE_VAL;
        largest = std::max(largest, expected[n]);
        worst = std::max(worst, std::abs(double{image.depth[n]} - expected[n]));
    }
    return largest > 0 ? worst / largest : worst > 0 ? HUGE_VAL : 0;
}

const std::vector<std::string> kModels{"lod1", "lod2",     "lod3",     "lod4",
                                       "lod5", "moments2", "moments4", "moments8"};

/// The only grid of an uncompressed file written by prepare.cpp, in aligned memory.
struct VoxelFile {
    struct alignas(32) Block {
        std::byte bytes[32];
    };
    std::vector<Block> blocks;
    std::size_t size = 0;

    explicit VoxelFile(const std::filesystem::path& file) {
        // A segment's head is 16 bytes, a grid's description 176 and its name.
        constexpr std::size_t kHead = 16, kDescription = 176, kNameBytesAt = 136;
        std::ifstream in(file, std::ios::binary);
        char head[kHead + kDescription] = {};
        in.read(head, sizeof(head));
        std::uint16_t grids = 0, codec = 0;
        std::uint64_t grid_bytes = 0;
        std::uint32_t name_bytes = 0;
        std::memcpy(&grids, head + 12, 2);
        std::memcpy(&codec, head + 14, 2);
        std::memcpy(&grid_bytes, head + kHead, 8);
        std::memcpy(&name_bytes, head + kHead + kNameBytesAt, 4);
        if (!in || grids != 1 || codec != 0)
            throw Error(file.string() + ": expected one uncompressed grid");
        in.ignore(name_bytes);
        size = grid_bytes;
        blocks.resize((size + sizeof(Block) - 1) / sizeof(Block));
        in.read(reinterpret_cast<char*>(blocks.data()), static_cast<std::streamsize>(size));
        if (!in) throw Error(file.string() + ": truncated");
    }
    std::span<const std::byte> bytes() const {
        return {reinterpret_cast<const std::byte*>(blocks.data()), size};
    }
};

int accuracy(const std::filesystem::path& folder) {
    int failures = 0;
    for (const Scene& scene : scenes()) {
        const std::vector<double> exact = exact_depth(scene);
        for (const GpuRenderer& renderer : renderers())
            failures += check(renderer.name, scene.name,
                              worst_of(exact, renderer.once(scene.model, scene.camera, scene.width,
                                                            scene.height)),
                              scene.tolerance);
    }
    constexpr double kOfTheCpu = 1e-4;
    for (const std::string& name : kModels) {
        const Gaussians model = read_ply(folder / (name + ".ply"));
        const DepthImage cpu = read_pfm(folder / (name + ".pfm"));
        const std::vector<double> expected(cpu.depth.begin(), cpu.depth.end());
        for (const GpuRenderer& renderer : renderers())
            failures += check(renderer.name, name,
                              worst_of(expected, renderer.once(model, paper_view(view_box(model)),
                                                               cpu.width, cpu.height)),
                              kOfTheCpu);
    }
    failures += check_options(folder);
#ifdef VOG_OPTIX
    failures += check_volumes();
    for (const std::string name : {"voxels", "skewed"}) {
        const VoxelFile voxels(folder / (name + ".nvdb"));
        const DepthImage cpu = read_pfm(folder / (name + ".pfm"));
        const std::vector<double> expected(cpu.depth.begin(), cpu.depth.end());
        OptixVolume volume(voxels.bytes());
        const Camera camera = read_camera(folder / (name + ".json"));
        failures += check("optix_volume", name,
                          worst_of(expected, volume.render(camera, cpu.width, cpu.height)), 1e-5);
    }
#endif
    fmt::print("{} failures\n", failures);
    return failures;
}

struct Row {
    std::string renderer, model;
    std::size_t gaussians;
    int width, height;
    double min_ms, median_ms, max_ms;
};

Row measure(const std::string& renderer, const std::string& model, std::size_t gaussians, int width,
            int height, const std::function<double(int, int)>& draw) {
    constexpr int kRepeats = 20;
    for (int n = 0; n < 3; ++n) (void)draw(width, height);  // warm-up
    std::vector<double> ms;
    for (int n = 0; n < kRepeats; ++n) ms.push_back(draw(width, height));
    std::sort(ms.begin(), ms.end());
    const double median = 0.5 * (ms[kRepeats / 2 - 1] + ms[kRepeats / 2]);
    fmt::print("{:<20} {:<10} {:>9} {:>5}x{:<5} {:9.4f} ms  {:9.1f} frames/s\n", renderer, model,
               gaussians, width, height, median, 1000 / median);
    return {renderer, model, gaussians, width, height, ms.front(), median, ms.back()};
}

constexpr std::pair<int, int> kSizes[] = {{512, 512}, {1024, 1024}, {1920, 1080}};

void bench_model(const std::string& name, const Gaussians& model, std::vector<Row>& rows) {
    const Camera camera = paper_view(view_box(model));
    for (const GpuRenderer& renderer : renderers()) {
        const auto draw = renderer.timed(model);
        for (const auto& [width, height] : kSizes)
            rows.push_back(measure(renderer.name, name, model.size(), width, height,
                                   [&](int w, int h) { return draw(camera, w, h); }));
    }
}

/// Maps, volumes and maxima of options.ply, whose transfer function the GPU has after the first picture.
void bench_pictures(const std::filesystem::path& folder, std::vector<Row>& rows) {
    const Gaussians model = read_ply(folder / "options.ply");
    const ScalarField& field = model.fields.scalar.front();
    const FieldChoice choice{field.name, FieldPart::value};
    const Camera camera = paper_view(view_box(model));
    const ValueTransfer transfer = option_transfer(field, view_box(model).radius() / 50);
    VolumeLook lit = option_look(model);
    lit.clip = {};
    std::vector<Renderer> gpus{Renderer::cuda};
#ifdef VOG_OPTIX
    gpus.push_back(Renderer::optix);
#endif
    for (const Renderer gpu : gpus) {
        GpuPictures pictures(gpu, model);
        const auto time = [&](const std::string& what, const std::function<void(int, int)>& draw) {
            for (const auto& [width, height] : kSizes)
                rows.push_back(measure(std::string(info_of(gpu).name) + "_" + what, "options",
                                       model.size(), width, height, [&](int w, int h) {
                                           draw(w, h);
                                           return pictures.gpu_ms();
                                       }));
        };
        time("clipped_T",
             [&](int w, int h) { (void)pictures.depth(camera, w, h, option_clip(model)); });
        time("mean", [&](int w, int h) { (void)pictures.fields(choice, camera, w, h); });
        time("volume",
             [&](int w, int h) { (void)pictures.volume(field.name, transfer, camera, w, h); });
        time("lit_volume", [&](int w, int h) {
            (void)pictures.volume(field.name, transfer, camera, w, h, 32, lit);
        });
        time("maximum", [&](int w, int h) { (void)pictures.maximum(field.name, camera, w, h); });
    }
}

void bench(const std::filesystem::path& folder, const std::filesystem::path& out) {
    std::vector<Row> rows;
    for (const std::string& name : kModels)
        bench_model(name, read_ply(folder / (name + ".ply")), rows);
    // A synthetic model as dense on screen as a fine one, each Gaussian a few pixels wide.
    bench_model("random1M", random_gaussians(1'000'000, 0.002, 0.006, 31), rows);
    bench_model("random5M", random_gaussians(5'000'000, 0.001, 0.004, 32), rows);
    bench_pictures(folder, rows);
#ifdef VOG_OPTIX
    const VoxelFile voxels(folder / "voxels.nvdb");
    OptixVolume volume(voxels.bytes());
    const Camera camera = read_camera(folder / "voxels.json");
    for (const auto& [width, height] : kSizes)
        rows.push_back(measure("optix_volume", "voxels", 0, width, height, [&](int w, int h) {
            (void)volume.render(camera, w, h);
            return volume.gpu_ms();
        }));
#endif
    cudaDeviceProp device{};
    if (cudaGetDeviceProperties(&device, 0) != cudaSuccess) throw Error("cuda: no device");
    int driver = 0;
    (void)cudaDriverGetVersion(&driver);
    const char* commit = std::getenv("VOG_COMMIT");
    nlohmann::ordered_json json = {{"machine", device.name},
                                   {"cuda", CUDART_VERSION},
                                   {"driver_cuda", driver},
                                   {"commit", commit ? commit : ""},
                                   {"rows", nlohmann::ordered_json::array()}};
    for (const Row& row : rows)
        json["rows"].push_back(
            {{"renderer", row.renderer},
             {"model", row.model},
             {"gaussians", row.gaussians},
             {"width", row.width},
             {"height", row.height},
             {"ms", {{"min", row.min_ms}, {"median", row.median_ms}, {"max", row.max_ms}}},
             {"frames_per_second", 1000 / row.median_ms}});
    std::ofstream file(out);
    file << json.dump(2) << "\n";
    if (!file.flush()) throw Error(out.string() + ": cannot write");
}

}  // namespace

}  // namespace vog::test

int main(int count, char** arguments) {
    const bool timed = count == 4 && std::strcmp(arguments[2], "--bench") == 0;
    if (count != 2 && !timed) {
        fmt::print(stderr, "usage: vog_gpu_suite FOLDER [--bench OUT.json]\n");
        return 2;
    }
    try {
        // The result is verified before it is timed.
        if (vog::test::accuracy(arguments[1]) > 0) return 1;
        if (timed) vog::test::bench(arguments[1], arguments[3]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "vog_gpu_suite: {}\n", error.what());
        return 1;
    }
}
