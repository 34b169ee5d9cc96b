// support.h: what the benches share: their volume, and how they count.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::bench {

inline std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// $VOG_BENCH_VOLUME, else smoke.vdb in $VOG_DATA or ../shared/data; empty where that is absent.
inline std::filesystem::path volume_file() {
    namespace fs = std::filesystem;
    if (const std::string named = variable("VOG_BENCH_VOLUME"); !named.empty()) return named;
    const std::string folder = variable("VOG_DATA");
    const fs::path file =
        (folder.empty() ? fs::path(VOG_SOURCE_DIR) / ".." / "shared" / "data" : fs::path(folder)) /
        "smoke.vdb";
    return fs::exists(file) ? file : fs::path{};
}

/// The grid $VOG_BENCH_GRID, or the default one, of that file; a cloud from nothing without one.
inline const Volume& volume() {
    static const Volume volume = [] {
        const std::filesystem::path file = volume_file();
        if (file.empty()) return sample_cloud({.size = 128});
        VdbOptions options;
        options.grid = variable("VOG_BENCH_GRID");
        return read_vdb(file, options);
    }();
    return volume;
}

/// Reports min and max beside the median of repetitions, in milliseconds.
inline benchmark::internal::Benchmark* repeat(benchmark::internal::Benchmark* bench, int times) {
    const auto least = [](const std::vector<double>& all) {
        return *std::ranges::min_element(all);
    };
    const auto most = [](const std::vector<double>& all) { return *std::ranges::max_element(all); };
    return bench->UseRealTime()
        ->Unit(benchmark::kMillisecond)
        ->Repetitions(times)
        ->ReportAggregatesOnly()
        ->ComputeStatistics("min", least)
        ->ComputeStatistics("max", most);
}

/// For Apply: five repetitions.
inline void measure(benchmark::internal::Benchmark* bench) { repeat(bench, 5); }

}  // namespace vog::bench
