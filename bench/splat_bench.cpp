// splat_bench.cpp: Speed of the splat renderer on every SIMD target, thread count and scale, and of the
// reference on the same volume in the same run. The `paper` view of models by moments from smoke.vdb,
// or from sample_cloud() where that is absent. Each picture is verified against the closed form in
// double precision before it is timed. --quick: few sizes, short times.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/splat/splat_kernels.h"
#include "render/trace/small_gaussians.h"
#include "support.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"

namespace {

using vog::bench::repeat;
using vog::bench::volume;

struct Size {
    int width, height;
};

/// 64 splitmix bits a call (Steele, Lea & Flood 2014), as a number in [-1, 1).
double uniform(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

/// `count` rotated Gaussians in [-1, 1]^3 whose standard deviations are about `scale`.
vog::Gaussians cube(std::size_t count, double scale) {
    vog::Gaussians model;
    model.box = {{-1, -1, -1}, {1, 1, 1}};
    std::uint64_t state = 7;
    const auto number = [&] { return static_cast<float>(uniform(state)); };
    const auto width = [&] { return static_cast<float>(scale * (1 + 0.5 * uniform(state))); };
    for (std::size_t n = 0; n < count; ++n) {
        model.mean.push_back(count == 1 ? vog::Vec3f{} : vog::Vec3f{number(), number(), number()});
        model.scale.push_back({width(), width(), width()});
        model.rotation.push_back({1.5f + number(), number(), number(), number()});
        model.density.push_back(1.5f + number());
    }
    return model;
}

/// Models by name. block2 ... block8: of the volume; dust: 5 million smaller than a pixel; screen: one
/// Gaussian over the whole picture.
const vog::Gaussians& model(const std::string& name) {
    static std::map<std::string, vog::Gaussians> models;
    const auto known = models.find(name);
    if (known != models.end()) return known->second;
    if (name == "dust") return models[name] = cube(5'000'000, 0.0005);
    if (name == "screen") return models[name] = cube(1, 1);
    vog::MomentOptions options;
    options.block_voxels = name.back() - '0';
    return models[name] = vog::convert_moments(volume(), options);
}

/// True if sampled pixels are the sum of the closed form, to 1e-4 of the largest T. Gaussians smaller
/// than a pixel (docs/method.md) are those of the ray tracers.
bool is_right(const vog::Gaussians& gaussians, const vog::DepthImage& image,
              const vog::Camera& camera) {
    const vog::CameraFrame frame = vog::frame_of(camera, image.width, image.height);
    const vog::trace::TraceModel packed = vog::trace::trace_model(gaussians, 0, 0);
    const vog::device::Camera scene = vog::trace::scene_camera(frame, packed.unit);
    const vog::trace::SmallGaussians small = vog::trace::small_gaussians(packed, scene);
    vog::DepthImage widened(image.width, image.height);
    vog::trace::draw_splats(small.splats, packed.kernel.kernel, scene, widened);
    const double largest = *std::max_element(image.depth.begin(), image.depth.end());
    const int samples = gaussians.size() > 1'000'000 ? 4 : 32;
    std::uint64_t state = 3;
    for (int n = 0; n < samples; ++n) {
        // The middle of the picture, where the models are.
        const int x = static_cast<int>(image.width * (0.5 + 0.3 * uniform(state)));
        const int y = static_cast<int>(image.height * (0.5 + 0.3 * uniform(state)));
        double exact = packed.depth_unit * double{widened.at(x, y)};
        for (std::size_t i = 0; i < gaussians.size(); ++i) {
            const float share = small.shares.empty() ? 1.0f : small.shares[i];
            if (share > 0)
                exact += share * vog::optical_depth(gaussians, i, frame.eye, frame.direction(x, y));
        }
        if (!(std::abs(image.at(x, y) - exact) <= 1e-4 * largest)) return false;
    }
    return largest > 0;
}

/// Terms of the cost of a view: splats, and rows of 16 pixels of which they cover at least one, in
/// tiles 16 pixels wide.
struct Work {
    double splats = 0, rows = 0, pixels = 0;
};
Work work_of(const vog::Gaussians& gaussians, const vog::Camera& camera, Size size) {
    const vog::CameraFrame frame = vog::frame_of(camera, size.width, size.height);
    constexpr std::size_t kRun = 4096;
    std::vector<vog::splat::FarSplat> far(kRun);
    std::vector<vog::splat::PixelBounds> bounds(kRun);
    std::vector<vog::splat::NearSplat> near;
    Work work;
    for (std::size_t first = 0; first < gaussians.size(); first += kRun) {
        vog::splat::SplatRun run{far.data(), bounds.data(), 0, &near};
        vog::splat::best_splat_kernels().project({&gaussians, 1, gaussians.cutoff}, frame, first,
                                                 std::min(first + kRun, gaussians.size()), run);
        work.splats += static_cast<double>(run.count);
        for (std::size_t n = 0; n < run.count; ++n) {
            const vog::splat::FarSplat& s = far[n];
            for (int y = s.bounds.y0; y <= s.bounds.y1; ++y) {
                const double from_row = y - s.row, b = s.by * from_row + s.b0;
                const double half = std::sqrt(std::max(0.0, s.f0 - b * b)) / s.ax;
                const double middle = s.column - (s.ay * from_row + s.a0) / s.ax;
                const double x0 = std::max(std::ceil(middle - half), double(s.bounds.x0));
                const double x1 = std::min(std::floor(middle + half), double(s.bounds.x1));
                if (x1 < x0) continue;
                work.pixels += x1 - x0 + 1;
                work.rows += std::floor(x1 / 16) - std::floor(x0 / 16) + 1;
            }
        }
    }
    return work;
}

double peak_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Check and cost of a case, computed once: the library calls a benchmark many times.
struct Case {
    bool right = false;
    Work work;
};

void splat(benchmark::State& state, const std::string& name, const std::string& target, Size size,
           int threads) {
    const vog::ThreadLimit limit(threads);
    const vog::Gaussians& gaussians = model(name);
    const vog::Camera camera = vog::paper_view(vog::view_box(gaussians));
    vog::SplatRenderer renderer(gaussians, {.simd_target = target});
    vog::DepthImage image;
    renderer.render(camera, size.width, size.height, image);
    static std::map<std::string, Case> cases;
    const std::string text =
        name + target + std::to_string(size.width) + "x" + std::to_string(size.height);
    const auto [known, first] = cases.try_emplace(text);
    if (first)
        known->second = {is_right(gaussians, image, camera), work_of(gaussians, camera, size)};
    if (!known->second.right) {
        state.SkipWithError("the picture is not the closed form");
        return;
    }
    for (auto _ : state) {
        renderer.render(camera, size.width, size.height, image);
        benchmark::DoNotOptimize(image.depth.data());
    }
    const Work& work = known->second.work;
    const auto frames = static_cast<double>(state.iterations());
    state.counters["threads"] = vog::thread_count();
    state.counters["gaussians"] = static_cast<double>(gaussians.size());
    state.counters["splats"] = work.splats;
    state.counters["rows"] = work.rows;
    state.counters["pixels"] = work.pixels;
    state.counters["rows_per_second"] =
        benchmark::Counter(work.rows * frames, benchmark::Counter::kIsRate);
    state.counters["peak_mib"] = peak_mib();
}

void reference(benchmark::State& state, Size size, int threads) {
    const vog::ThreadLimit limit(threads);
    static const vog::VoxelGrid grid = vog::voxel_grid(volume());
    const vog::Camera camera = vog::paper_view(vog::world_box(volume()));
    for (auto _ : state) {
        const vog::DepthImage image =
            vog::render_reference({&grid, 1}, camera, size.width, size.height);
        benchmark::DoNotOptimize(image.depth.data());
    }
    state.counters["threads"] = vog::thread_count();
}

/// Projection alone, on one thread: time per item is time per Gaussian.
void project(benchmark::State& state, const std::string& name, const std::string& target) {
    const vog::Gaussians& gaussians = model(name);
    const vog::CameraFrame frame =
        vog::frame_of(vog::paper_view(vog::view_box(gaussians)), 1024, 1024);
    const vog::splat::SplatKernels& kernels = vog::splat::splat_kernels(target);
    std::vector<vog::splat::FarSplat> far(gaussians.size());
    std::vector<vog::splat::PixelBounds> bounds(gaussians.size());
    std::vector<vog::splat::NearSplat> near;
    for (auto _ : state) {
        vog::splat::SplatRun run{far.data(), bounds.data(), 0, &near};
        kernels.project({&gaussians, 1, gaussians.cutoff}, frame, 0, gaussians.size(), run);
        benchmark::DoNotOptimize(run.count);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(gaussians.size()));
}

/// The inner loop alone, in first-level cache, on one thread: one splat over all rows of a tile. Time
/// per item is time per row of 16 pixels.
void rows(benchmark::State& state, const std::string& target) {
    const vog::Gaussians& gaussians = model("screen");
    const vog::CameraFrame frame = vog::frame_of(vog::paper_view(gaussians.box), 2048, 2048);
    const vog::splat::SplatKernels& kernels = vog::splat::splat_kernels(target);
    const vog::KernelPolynomial kernel = vog::fit_kernel(gaussians.cutoff);
    vog::splat::FarSplat far;
    vog::splat::PixelBounds bounds;
    std::vector<vog::splat::NearSplat> near;
    vog::splat::SplatRun run{&far, &bounds, 0, &near};
    kernels.project({&gaussians, 1, gaussians.cutoff}, frame, 0, 1, run);
    vog::splat::TilePixels tile;
    tile.column = tile.row = 1024;
    const std::uint32_t only = 0;
    for (auto _ : state) {
        kernels.add_far(&far, &only, 1, kernel, tile);
        benchmark::DoNotOptimize(tile.depth[0][0]);
    }
    state.SetItemsProcessed(state.iterations() * vog::splat::kTileHeight * vog::splat::kTileWidth /
                            16);
}

template <class Run>
void add(const std::string& name, bool quick, const Run& run) {
    auto* bench = benchmark::RegisterBenchmark(name.c_str(), run);
    repeat(bench, quick ? 3 : 5)->MeasureProcessCPUTime()->MinTime(quick ? 0.01 : 0.06);
}

void add_splat(const std::string& name, const std::string& target, Size size, int threads,
               bool quick) {
    const std::string text = "splat/" + name + "/" + target + "/" + std::to_string(size.width) +
                             "x" + std::to_string(size.height) +
                             "/threads:" + std::to_string(threads);
    add(text, quick, [=](benchmark::State& state) { splat(state, name, target, size, threads); });
}

void add_all(bool quick) {
    const std::vector<std::string> targets = vog::splat_targets();
    const std::string& best = targets.front();
    const Size square = quick ? Size{256, 256} : Size{1024, 1024};
    add(quick ? "reference/256x256" : "reference/1024x1024", quick,
        [=](benchmark::State& state) { reference(state, square, 0); });
    // Every target on one thread; two threads and all on the best.
    for (const std::string name : {"block2", "block4", "block8"}) {
        for (const std::string& target : targets) add_splat(name, target, square, 1, quick);
        for (const int threads : {2, 0}) add_splat(name, best, square, threads, quick);
    }
    // Every scale.
    for (const Size size : {Size{256, 256}, Size{1920, 1080}, Size{3840, 2160}}) {
        if (quick && size.width > 256) continue;
        for (const std::string name : {"block2", "block8", "screen"})
            if (!quick || name == "screen") add_splat(name, best, size, 0, quick);
    }
    if (!quick) add_splat("dust", best, {1920, 1080}, 0, quick);
    // The stages.
    for (const std::string& target : targets) {
        add("project/block2/" + target, quick,
            [=](benchmark::State& state) { project(state, "block2", target); });
        add("rows/" + target, quick, [=](benchmark::State& state) { rows(state, target); });
    }
}

}  // namespace

int main(int argc, char** argv) {
    bool quick = false;
    for (int n = 1; n < argc; ++n)
        if (std::strcmp(argv[n], "--quick") == 0) {
            quick = true;
            std::rotate(argv + n, argv + n + 1, argv + argc--);
        }
    add_all(quick);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
