// trace_bench.cpp: Speed of the ray tracer on the `paper` view, and of the splat on the same picture in
// the same run, for their ratio. Items per second are rays per second.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support.h"
#include "vog/convert_moments.h"

namespace {

using vog::bench::repeat;
using vog::bench::volume;

const vog::Gaussians& moments(int block_voxels) {
    static std::map<int, vog::Gaussians> models;
    if (!models.contains(block_voxels))
        models[block_voxels] = vog::convert_moments(volume(), {.block_voxels = block_voxels});
    return models[block_voxels];
}

/// Largest difference of the two renderers relative to the largest T; the documented bound is 1e-4.
double apart(const vog::DepthImage& a, const vog::DepthImage& b) {
    double largest = 0, worst = 0;
    for (std::size_t n = 0; n < a.depth.size(); ++n) {
        largest = std::max(largest, double{a.depth[n]});
        worst = std::max(worst, std::abs(double{a.depth[n]} - double{b.depth[n]}));
    }
    return largest > 0 ? worst / largest : 1;
}

constexpr int kSize = 1024;

void finish(benchmark::State& state, const vog::Gaussians& model) {
    state.SetItemsProcessed(state.iterations() * kSize * kSize);
    state.counters["gaussians"] = static_cast<double>(model.size());
    state.counters["threads"] = vog::thread_count();
}

void trace(benchmark::State& state, const vog::TraceOptions& options) {
    const vog::Gaussians& model = moments(static_cast<int>(state.range(0)));
    const vog::Camera camera = vog::paper_view(model.box);
    const vog::TraceScene scene = vog::trace_scene(model);
    vog::TraceReport report;
    const double difference =
        apart(vog::render_splat(model, camera, kSize, kSize),
              vog::render_trace(scene, camera, kSize, kSize, options, &report));
    if (!(difference <= 1e-4)) {
        state.SkipWithError("the picture is not the splat's");
        return;
    }
    for (auto _ : state) {
        const vog::DepthImage image = vog::render_trace(scene, camera, kSize, kSize, options);
        benchmark::DoNotOptimize(image.depth.data());
    }
    finish(state, model);
    state.counters["difference"] = difference;
    state.counters["hits_per_ray"] = static_cast<double>(report.hits) / (kSize * kSize);
}

void splat(benchmark::State& state) {
    const vog::Gaussians& model = moments(static_cast<int>(state.range(0)));
    const vog::Camera camera = vog::paper_view(model.box);
    for (auto _ : state) {
        const vog::DepthImage image = vog::render_splat(model, camera, kSize, kSize);
        benchmark::DoNotOptimize(image.depth.data());
    }
    finish(state, model);
}

void build(benchmark::State& state) {
    const vog::Gaussians& model = moments(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(vog::trace_scene(model).size());
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(model.size()));
    state.counters["threads"] = vog::thread_count();
}

void blocks(benchmark::internal::Benchmark* bench) {
    repeat(bench, 5)->MinTime(0.01)->ArgName("block")->Arg(8)->Arg(4)->Arg(2);
}

BENCHMARK(splat)->Apply(blocks);
BENCHMARK_CAPTURE(trace, accumulate, {})->Apply(blocks);
BENCHMARK_CAPTURE(trace, collect, {.anyhit = vog::AnyHit::collect})->Apply(blocks);
BENCHMARK(build)->Apply(blocks);

}  // namespace
