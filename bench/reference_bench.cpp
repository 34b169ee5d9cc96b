// reference_bench.cpp: Speed of the reference renderer on the `paper` view, without file reading.
// Items per second are rays per second. The volume is $VOG_BENCH_VOLUME (and $VOG_BENCH_GRID), else
// smoke.vdb, else sample_cloud().
#include <benchmark/benchmark.h>

#include <cmath>
#include <sstream>

#include "../tests/support/ray_voxels.h"
#include "render/reference/reference.h"
#include "support.h"

namespace {

using vog::bench::measure;
using vog::bench::volume;

/// True if 64 pixels agree with brute force over constant voxels in double precision: to a relative
/// 1e-5, or for linear interpolation, a different field, their mean to 1 %.
bool is_right(const vog::VoxelGrid& grid, const vog::Camera& camera, bool linear) {
    constexpr int kEdge = 8;
    const vog::CameraFrame frame = vog::frame_of(camera, kEdge, kEdge);
    const vog::DepthImage image = vog::render_reference({&grid, 1}, camera, kEdge, kEdge);
    double mean = 0, expected_mean = 0;
    for (int row = 0; row < kEdge; ++row)
        for (int column = 0; column < kEdge; ++column) {
            const double depth = image.at(column, row);
            const double expected =
                vog::test::brute_depth(volume(), frame.eye, frame.direction(column, row));
            if (!linear && std::abs(depth - expected) > 1e-5 * expected) return false;
            mean += depth, expected_mean += expected;
        }
    return expected_mean > 0 && std::abs(mean / expected_mean - 1) < 0.01;
}

void render(benchmark::State& state, const vog::VoxelGridOptions& options) {
    const auto size = static_cast<int>(state.range(0));
    const vog::ThreadLimit limit(static_cast<int>(state.range(1)));
    const vog::VoxelGrid grid = vog::voxel_grid(volume(), options);
    const vog::Camera camera = vog::paper_view(vog::world_box(volume()));
    if (!is_right(grid, camera, options.interpolation == vog::Interpolation::linear)) {
        state.SkipWithError("the picture does not agree with the brute force");
        return;
    }
    for (auto _ : state) {
        const vog::DepthImage image = vog::render_reference({&grid, 1}, camera, size, size);
        benchmark::DoNotOptimize(image.depth.data());
    }
    state.SetItemsProcessed(state.iterations() * size * size);
    // The same view for OpenVDB's vdb_render: bench/vdb_render.sh.
    std::ostringstream view;
    view.precision(9);
    const auto [eye, at] = std::pair(camera.eye, camera.look_at);
    view << "-translate " << eye.x << ',' << eye.y << ',' << eye.z << " -lookat " << at.x << ','
         << at.y << ',' << at.z << " -fov " << camera.fov_degrees << " -name " << volume().name;
    state.SetLabel(view.str());
    state.counters["threads"] = vog::thread_count();
}

void build(benchmark::State& state, const vog::VoxelGridOptions& options) {
    std::size_t bytes = 0;
    for (auto _ : state) bytes = vog::voxel_grid(volume(), options).memory_bytes();
    state.SetItemsProcessed(state.iterations() *
                            static_cast<std::int64_t>(vog::active_voxels(volume())));
    state.counters["bytes"] = static_cast<double>(bytes);
    state.counters["threads"] = vog::thread_count();
}

void sizes(benchmark::internal::Benchmark* bench) {
    measure(bench);
    bench->ArgNames({"size", "threads"})->Args({512, 1})->Args({512, 0})->Args({1024, 0});
}

constexpr auto kLinear = vog::Interpolation::linear;
BENCHMARK_CAPTURE(render, constant, {})->Apply(sizes);
BENCHMARK_CAPTURE(render, linear_quarter, {kLinear, 0.25})->Apply(sizes);
BENCHMARK_CAPTURE(render, linear_exact, {kLinear, 0})->Apply(sizes);
BENCHMARK_CAPTURE(build, constant, {})->Apply(measure);
BENCHMARK_CAPTURE(build, linear, {kLinear, 0.25})->Apply(measure);

}  // namespace
