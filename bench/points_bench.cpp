// points_bench.cpp: particles: text to Points, one Gaussian each, the best 1 in 100. The argument
// is the number of particles along an edge of the sample: 100 for 1 M, 216 for 10 M. Items per
// second are particles per second; peak_mb is the largest memory of the process so far.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "support.h"
#include "vog/convert_points.h"
#include "vog/progress.h"
#include "vog/sample.h"

namespace {

using vog::bench::repeat;

const vog::Points& particles(std::int64_t edge) {
    static std::map<std::int64_t, vog::Points> made;
    auto found = made.find(edge);
    if (found == made.end()) {
        made.clear();  // one set in memory
        vog::ParticleSampleOptions options;
        options.size = static_cast<int>(edge);
        found = made.emplace(edge, vog::sample_particles(options)).first;
    }
    return found->second;
}

/// The particles as a text file in the folder of temporary files, removed at the end.
class TextFile {
  public:
    explicit TextFile(const vog::Points& points) { vog::write_points(path_, points); }
    ~TextFile() { std::filesystem::remove(path_); }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_ = std::filesystem::temp_directory_path() / "vog-points-bench.xyz";
};

void count(benchmark::State& state, std::size_t number) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(number));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    state.counters["peak_mb"] = static_cast<double>(usage.ru_maxrss) / 1e3;
    state.counters["threads"] = vog::thread_count();
}

void read(benchmark::State& state) {
    const vog::Points& points = particles(state.range(0));
    const TextFile file(points);
    if (vog::read_points(file.path()).position != points.position) {
        state.SkipWithError("what is read is not what was written");
        return;
    }
    for (auto _ : state) benchmark::DoNotOptimize(vog::read_points(file.path()).position.data());
    state.SetBytesProcessed(state.iterations() *
                            static_cast<std::int64_t>(std::filesystem::file_size(file.path())));
    count(state, points.size());
}

void convert(benchmark::State& state, std::size_t reduction) {
    const vog::Points& points = particles(state.range(0));
    vog::PointOptions options;
    if (reduction > 1) options.budget = points.size() / reduction;
    const double mass = vog::mass(vog::convert_points(points, options));
    if (std::abs(mass / static_cast<double>(points.size()) - 1) > 1e-6) {
        state.SkipWithError("the conversion loses mass");
        return;
    }
    for (auto _ : state) benchmark::DoNotOptimize(vog::convert_points(points, options).mean.data());
    count(state, points.size());
}

void edges(benchmark::internal::Benchmark* bench) {
    repeat(bench, 3)->Iterations(1)->Arg(100)->Arg(216);
}

BENCHMARK(read)->Apply(edges);
BENCHMARK_CAPTURE(convert, one_each, 1)->Apply(edges);
BENCHMARK_CAPTURE(convert, one_in_100, 100)->Apply(edges);

}  // namespace
