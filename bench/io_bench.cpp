// io_bench.cpp: reading a .vdb, writing and reading a model as PLY and .vogz. Files lie in the system's
// temporary folder and in its cache: this times our code, not a disk.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "support.h"
#include "vog/convert_moments.h"
#include "vog/ply.h"
#include "vog/vogz.h"
#include "vog/volume_io.h"

namespace {

using vog::bench::measure;
using vog::bench::volume;
using vog::bench::volume_file;

namespace fs = std::filesystem;

/// A folder that goes when the bench ends.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("vog_io_bench_" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};
const fs::path& folder() {
    static const Folder folder;
    return folder.path;
}

/// The benches' volume as a file.
const fs::path& vdb_file() {
    static const fs::path file = [] {
        if (const fs::path named = volume_file(); !named.empty()) return named;
        const fs::path sample = folder() / "cloud.vdb";
        vog::write_vdb(sample, volume());
        return sample;
    }();
    return file;
}

const vog::Gaussians& model() {
    static const vog::Gaussians model =
        vog::convert_moments(vog::read_vdb(vdb_file()), {.block_voxels = 2});
    return model;
}

void rate(benchmark::State& state, const fs::path& file) {
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(fs::file_size(file)));
    state.counters["bytes"] = static_cast<double>(fs::file_size(file));
}

void read_vdb(benchmark::State& state) {
    if (vog::active_voxels(vog::read_vdb(vdb_file())) == 0) {
        state.SkipWithError("no voxels were read");
        return;
    }
    for (auto _ : state) {
        const vog::Volume volume = vog::read_vdb(vdb_file());
        benchmark::DoNotOptimize(volume.leaves.data());
    }
    rate(state, vdb_file());
}

void write_ply(benchmark::State& state) {
    const fs::path file = folder() / "model.ply";
    for (auto _ : state) vog::write_ply(file, model());
    if (vog::read_ply(file).density != model().density) {
        state.SkipWithError("the model is not what was written");
        return;
    }
    rate(state, file);
}

void read_ply(benchmark::State& state) {
    const fs::path file = folder() / "model.ply";
    vog::write_ply(file, model());
    if (vog::read_ply(file).mean != model().mean) {
        state.SkipWithError("the model is not what was written");
        return;
    }
    for (auto _ : state) {
        const vog::Gaussians read = vog::read_ply(file);
        benchmark::DoNotOptimize(read.mean.data());
    }
    rate(state, file);
}

/// Whether a compact model has the mass of the bench's own, to 1e-6.
bool whole(const vog::Gaussians& read) {
    const double mass = vog::mass(model());
    return std::abs(vog::mass(read) - mass) <= 1e-6 * mass;
}

/// Gaussians a second, as counted by the files' loops.
void gaussian_rate(benchmark::State& state, const fs::path& file) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(model().size()));
    state.counters["bytes"] = static_cast<double>(fs::file_size(file));
}

void write_vogz(benchmark::State& state) {
    const fs::path file = folder() / "model.vogz";
    for (auto _ : state) vog::write_vogz(file, model());
    if (!whole(vog::read_vogz(file))) {
        state.SkipWithError("the model has another mass than that written");
        return;
    }
    gaussian_rate(state, file);
}

void read_vogz(benchmark::State& state) {
    const fs::path file = folder() / "model.vogz";
    vog::write_vogz(file, model());
    if (!whole(vog::read_vogz(file))) {
        state.SkipWithError("the model has another mass than that written");
        return;
    }
    for (auto _ : state) {
        const vog::Gaussians read = vog::read_vogz(file);
        benchmark::DoNotOptimize(read.mean.data());
    }
    gaussian_rate(state, file);
}

BENCHMARK(read_vdb)->Apply(measure);
BENCHMARK(write_ply)->Apply(measure);
BENCHMARK(read_ply)->Apply(measure);
BENCHMARK(write_vogz)->Apply(measure);
BENCHMARK(read_vogz)->Apply(measure);

}  // namespace
