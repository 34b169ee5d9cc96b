// moments_bench.cpp: the moment conversion, without file reading: uniform cuts, the octree, a
// budget, an error, one soft step. Items per second are active voxels per second; peak_over_volume
// is the most memory a conversion held, the volume included, over the volume itself.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/octree.h"
#include "support.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"

namespace {

// Every operator new of the process is counted, the library's among them: the size that malloc
// gave, so that delete can take off the same.
std::atomic<std::size_t> held{0}, peak{0};

void* counted(void* memory) {
    if (!memory) throw std::bad_alloc();
    const std::size_t now = held += malloc_usable_size(memory);
    std::size_t most = peak.load();
    while (now > most && !peak.compare_exchange_weak(most, now)) {
    }
    return memory;
}
void discounted(void* memory) {
    held -= malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t align) {
    const auto a = static_cast<std::size_t>(align);
    return counted(std::aligned_alloc(a, (size + a - 1) / a * a));
}
void operator delete(void* memory) noexcept { discounted(memory); }
void operator delete(void* memory, std::size_t) noexcept { discounted(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { discounted(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { discounted(memory); }

namespace {

using vog::bench::measure;
using vog::bench::volume;

double volume_bytes() {
    return static_cast<double>(volume().leaves.size() * sizeof(vog::Leaf) +
                               volume().tiles.size() * sizeof(vog::Tile));
}

/// Active voxels per second, the model's size, the memory.
void tell(benchmark::State& state, std::size_t count, std::size_t before) {
    state.SetItemsProcessed(state.iterations() *
                            static_cast<std::int64_t>(vog::active_voxels(volume())));
    state.SetLabel(std::filesystem::path(volume().source).filename().string());
    state.counters["gaussians"] = static_cast<double>(count);
    state.counters["threads"] = vog::thread_count();
    state.counters["peak_over_volume"] = 1 + static_cast<double>(peak - before) / volume_bytes();
}

/// Whether the conversion is right: all cells together weigh what the volume does.
bool conserves_mass(const vog::MomentReport& report, const vog::Gaussians& model) {
    const double ratio = vog::mass(model) / vog::mass(volume()) + report.dropped_mass_share;
    return std::abs(report.mass_ratio - 1) < 1e-5 && std::abs(ratio - 1) < 1e-5;
}

void convert(benchmark::State& state, const vog::MomentOptions& options) {
    volume();
    const std::size_t before = held;
    peak = before;
    std::size_t count = 0;
    {
        vog::MomentReport report;
        const vog::Gaussians model = vog::convert_moments(volume(), options, &report);
        count = model.size();
        if (count == 0 || !conserves_mass(report, model) ||
            (options.budget && count > options.budget)) {
            state.SkipWithError("the conversion loses mass, gives no Gaussians or too many");
            return;
        }
    }
    const std::size_t peak_before = before;
    for (auto _ : state) {
        const vog::Gaussians model = vog::convert_moments(volume(), options);
        benchmark::DoNotOptimize(model.mean.data());
    }
    tell(state, count, peak_before);
}

void octree(benchmark::State& state) {
    volume();
    const std::size_t before = held;
    peak = before;
    std::size_t cells = 0;
    for (auto _ : state) {
        const vog::moments::LatticeField field = vog::moments::lattice_field(volume());
        const vog::moments::MomentOctree tree = vog::moments::brick_octree(field.bricks);
        cells = tree.levels.front().cells.size();
        const double mass = double{tree.levels.back().cells[0].mass} * vog::voxel_volume(volume());
        if (std::abs(mass / vog::mass(volume()) - 1) > 1e-5) state.SkipWithError("mass is lost");
    }
    tell(state, cells, before);
}

vog::MomentOptions block(int voxels, int soft_steps = 0) {
    vog::MomentOptions options;
    options.block_voxels = voxels;
    options.soft_steps = soft_steps;
    return options;
}
vog::MomentOptions budget(std::size_t count) {
    vog::MomentOptions options;
    options.budget = count;
    return options;
}

BENCHMARK_CAPTURE(convert, block1, block(1))->Apply(measure);
BENCHMARK_CAPTURE(convert, block2, block(2))->Apply(measure);
BENCHMARK_CAPTURE(convert, block4, block(4))->Apply(measure);
BENCHMARK_CAPTURE(convert, block8, block(8))->Apply(measure);
BENCHMARK_CAPTURE(convert, block32, block(32))->Apply(measure);
BENCHMARK_CAPTURE(convert, block4_one_soft_step, block(4, 1))->Apply(measure);
BENCHMARK(octree)->Apply(measure);
BENCHMARK_CAPTURE(convert, budget3148, budget(3148))->Apply(measure);
BENCHMARK_CAPTURE(convert, budget19936, budget(19936))->Apply(measure);
BENCHMARK_CAPTURE(convert, budget141652, budget(141652))->Apply(measure);
BENCHMARK_CAPTURE(convert, error0_03, vog::MomentOptions{})->Apply(measure);

}  // namespace
