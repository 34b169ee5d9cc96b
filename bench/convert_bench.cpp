// convert_bench.cpp: the paper's conversion, each level of detail and strategy, without file
// reading. Items per second are active voxels per second.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>

#include "support.h"
#include "vog/convert_paper.h"

namespace {

using vog::bench::measure;
using vog::bench::volume;

/// Whether the conversion is right: with the mass amplitude and no threshold the model weighs what
/// the volume does, to the rounding of float32.
bool conserves_mass(vog::PaperOptions options) {
    options.amplitude = vog::Amplitude::mass;
    options.opacity_threshold = 0;
    const double ratio = vog::mass(vog::convert_paper(volume(), options)) / vog::mass(volume());
    return std::abs(ratio - 1) < 1e-5;
}

void convert(benchmark::State& state, const vog::PaperOptions& options) {
    const std::size_t count = vog::convert_paper(volume(), options).size();
    if (count == 0 || !conserves_mass(options)) {
        state.SkipWithError("the conversion loses mass or gives no Gaussians");
        return;
    }
    for (auto _ : state) {
        const vog::Gaussians model = vog::convert_paper(volume(), options);
        benchmark::DoNotOptimize(model.mean.data());
    }
    state.SetItemsProcessed(state.iterations() *
                            static_cast<std::int64_t>(vog::active_voxels(volume())));
    state.SetLabel(std::filesystem::path(volume().source).filename().string());
    state.counters["gaussians"] = static_cast<double>(count);
    state.counters["threads"] = vog::thread_count();
}

vog::PaperOptions companion(vog::Strategy strategy) {
    vog::PaperOptions options;
    options.strategy = strategy;
    return options;
}

BENCHMARK_CAPTURE(convert, lod1, vog::paper_lod(1))->Apply(measure);
BENCHMARK_CAPTURE(convert, lod2, vog::paper_lod(2))->Apply(measure);
BENCHMARK_CAPTURE(convert, lod3, vog::paper_lod(3))->Apply(measure);
BENCHMARK_CAPTURE(convert, lod4, vog::paper_lod(4))->Apply(measure);
BENCHMARK_CAPTURE(convert, lod5, vog::paper_lod(5))->Apply(measure);
BENCHMARK_CAPTURE(convert, variance, companion(vog::Strategy::variance_clusters))->Apply(measure);
BENCHMARK_CAPTURE(convert, neighbours, companion(vog::Strategy::leaf_clusters))->Apply(measure);
BENCHMARK_CAPTURE(convert, tree, companion(vog::Strategy::tree_mirror))->Apply(measure);

}  // namespace
