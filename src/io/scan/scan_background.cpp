// scan_background.cpp: peaks of air and of noise in the histogram of a dense image.
#include "io/scan/scan_background.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog::scan {

namespace {

constexpr std::size_t kVoxelsPerTask = std::size_t{1} << 16;

/// Value of air in Hounsfield units.
constexpr double kAir = -1000;
/// Values of voxels that scanners leave out reach down to -3024; cropped scans of lungs end above -1000.
constexpr double kLeastPadding = -3100, kMostAir = -900;
/// Half width of the peak of air: 12-bit scanners store it as -1024.
constexpr double kAirWidth = 64;
constexpr std::size_t kMostBins = std::size_t{1} << 16;

/// Finite values of an image.
struct Summary {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    std::uint64_t count = 0, zeros = 0, air = 0, above_air = 0;
    bool integers = true;

    void add(float v) {
        if (!std::isfinite(v)) return;
        least = std::min(least, double{v}), most = std::max(most, double{v});
        ++count, zeros += v == 0;
        integers = integers && v == std::floor(v);
        air += std::abs(double{v} - kAir) <= kAirWidth;
        above_air += std::abs(double{v} - kAir - 2 * kAirWidth) < kAirWidth;
    }
    static Summary sum(Summary a, const Summary& b) {
        a.least = std::min(a.least, b.least), a.most = std::max(a.most, b.most);
        a.count += b.count, a.zeros += b.zeros, a.air += b.air, a.above_air += b.above_air;
        a.integers = a.integers && b.integers;
        return a;
    }
};

Summary summary_of(const BigVector<float>& value) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, value.size(), kVoxelsPerTask), Summary{},
        [&](const auto& range, Summary found) {
            for (std::size_t n = range.begin(); n < range.end(); ++n) found.add(value[n]);
            keep_memory();
            return found;
        },
        Summary::sum);
}

/// Whether values are Hounsfield units.
bool is_hounsfield(const std::string& unit, const Summary& all) {
    if (unit == "HU" || unit == "[hnsf'U]" || unit == "Hounsfield") return all.least < 0;
    // Air is more frequent than lungs and fat beside it; differences and velocities have no peak there.
    return unit.empty() && all.least >= kLeastPadding && all.least <= kMostAir &&
           200 * all.air >= all.count && 2 * all.air >= 3 * all.above_air;
}

/// Numbers of voxels by value.
class Histogram {
  public:
    Histogram(const BigVector<float>& value, const Summary& all)
        : least_(all.least), voxels_(double(all.count)) {
        const double range = all.most - all.least;
        const bool unit_bins = all.integers && range < kMostBins;
        const std::size_t bins = unit_bins ? static_cast<std::size_t>(range) + 1 : kMostBins;
        width_ = unit_bins ? 1 : range / kMostBins;
        using Counts = std::vector<double>;
        below_ = tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, value.size(), 64 * kVoxelsPerTask), Counts(bins + 1),
            [&](const auto& part, Counts counts) {
                for (std::size_t n = part.begin(); n < part.end(); ++n)
                    if (std::isfinite(value[n])) {
                        const double bin = (double{value[n]} - least_) / width_;
                        ++counts[1 + std::min(static_cast<std::size_t>(bin), bins - 1)];
                    }
                keep_memory();
                return counts;
            },
            [](Counts a, const Counts& b) {
                for (std::size_t n = 0; n < a.size(); ++n) a[n] += b[n];
                return a;
            });
        for (std::size_t n = 1; n <= bins; ++n) below_[n] += below_[n - 1];
        middle_ = unit_bins ? 0 : 0.5;
    }

    /// Share of the voxels below a value.
    double below(double value) const {
        const double at = (value - least_) / width_ + (0.5 - middle_);
        if (at <= 0) return 0;
        const auto bin = static_cast<std::size_t>(at);
        if (bin + 1 >= below_.size()) return 1;
        return (below_[bin] + (at - double(bin)) * (below_[bin + 1] - below_[bin])) / voxels_;
    }
    double between(double from, double to) const { return below(to) - below(from); }
    /// Value below which a share of the voxels lies.
    double quantile(double share) const {
        const auto found = std::ranges::lower_bound(below_, share * voxels_);
        const auto bin = std::max<std::ptrdiff_t>(found - below_.begin(), 1) - 1;
        return least_ + width_ * (double(bin) + middle_);
    }
    /// Middle of the shortest interval with a quarter of the voxels: the mode of the highest peak.
    double mode() const {
        std::size_t first = 0, best = 0, shortest = below_.size();
        for (std::size_t end = 1; end < below_.size(); ++end) {
            while (below_[end] - below_[first + 1] >= voxels_ / 4) ++first;
            if (below_[end] - below_[first] >= voxels_ / 4 && end - first < shortest)
                shortest = end - first, best = first;
        }
        return least_ + width_ * (double(best) + 0.5 * double(shortest) - (0.5 - middle_));
    }

  private:
    double least_, width_ = 1, voxels_;
    double middle_ = 0.5;        ///< a bin's value in the bin
    std::vector<double> below_;  ///< [bins + 1] voxels below the bin
};

/// mode + 4 deviations of a noise peak at the low end; 0 unless there is one.
double noise_of(const BigVector<float>& value, const Summary& all) {
    constexpr std::uint64_t kFewest = 4096;
    if (all.count < kFewest || all.least < 0 || !(all.most > all.least) ||
        20 * all.zeros >= all.count)
        return 0;
    const Histogram histogram(value, all);
    const double mode = histogram.mode(), high = histogram.quantile(0.999);
    // Below the mode of a normal distribution 31.7 % of the values are further than a deviation from it.
    const double deviation = mode - histogram.quantile(0.317 * histogram.below(mode));
    const double peak = histogram.between(mode - deviation, mode + deviation);
    const double left = histogram.between(mode - deviation, mode), right = peak - left;
    const double beside = histogram.between(mode + 3 * deviation, mode + 5 * deviation);
    // Distributions of one peak, log-normal ones of simulations for example, fall off more slowly or end sooner.
    const bool is_noise =
        deviation > 0 && histogram.between(mode - 2 * deviation, mode + 2 * deviation) >= 0.4 &&
        left <= 2 * right && right <= 2 * left && beside <= 0.15 * peak &&
        histogram.below(mode - 4 * deviation) <= 0.05 && high >= mode + 16 * deviation;
    if (!is_noise) return 0;
    const double background = mode + 4 * deviation;
    return all.integers ? std::round(background) : std::stod(fmt::format("{:.4g}", background));
}

}  // namespace

double background_of(const ScanGrid& grid, const BigVector<float>& value) {
    const Summary all = summary_of(value);
    if (is_hounsfield(grid.value_unit, all)) return kAir;
    return noise_of(value, all);
}

void subtract_background(double background, BigVector<float>& value) {
    vog::parallel_for(
        std::size_t{0}, (value.size() + kVoxelsPerTask - 1) / kVoxelsPerTask,
        [&](std::size_t task) {
            const std::size_t end = std::min((task + 1) * kVoxelsPerTask, value.size());
            for (std::size_t n = task * kVoxelsPerTask; n < end; ++n)
                if (std::isfinite(value[n]))
                    value[n] = static_cast<float>(std::max(double{value[n]} - background, 0.0));
        });
}

}  // namespace vog::scan
