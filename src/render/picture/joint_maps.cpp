// joint_maps.cpp: pictures of several processes, each of which has drawn a part of the data.
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/picture/source_renderer.h"
#include "vog/distributed.h"

namespace vog::pictures {

namespace {

using Packets = std::vector<std::vector<float>>;  ///< [processes]

/// Joint column, mean and deviation of one pixel, in double precision.
struct JointMoments {
    double column = 0, mean = 0,
           second = 0;  ///< sums: of columns, and of these times mean and square

    void add(float part_column, float part_mean) {
        if (!(part_column > 0) || std::isnan(part_mean)) return;
        column += double{part_column};
        mean += double{part_column} * double{part_mean};
    }
    /// Squares about the joint mean: nothing cancels.
    void add_square(float part_column, float part_mean, float deviation, double joint) {
        if (!(part_column > 0) || std::isnan(part_mean)) return;
        const double from = double{part_mean} - joint;
        second += double{part_column} * (double{deviation} * double{deviation} + from * from);
    }
};

/// Joins pixels first ... first + count - 1.
/// from  [processes][3][count]
void join(const Packets& from, std::size_t first, std::size_t count, FieldMaps& maps) {
    for (std::size_t n = 0; n < count; ++n) {
        JointMoments sums;
        for (const std::vector<float>& part : from) sums.add(part[n], part[count + n]);
        const std::size_t at = first + n;
        maps.column[at] = static_cast<float>(sums.column);
        if (!(sums.column > 0)) {
            maps.mean[at] = maps.deviation[at] = std::numeric_limits<float>::quiet_NaN();
            continue;
        }
        const double mean = sums.mean / sums.column;
        for (const std::vector<float>& part : from)
            sums.add_square(part[n], part[count + n], part[2 * count + n], mean);
        maps.mean[at] = static_cast<float>(mean);
        maps.deviation[at] = static_cast<float>(std::sqrt(sums.second / sums.column));
    }
}

/// Sends the maps to the root, a run of pixels at a time: the root holds that of every process.
void join(FieldMaps& maps, const Collective& processes) {
    constexpr std::size_t kRun = std::size_t{1} << 18;
    for (std::size_t first = 0; first < maps.column.size(); first += kRun) {
        const std::size_t count = std::min(kRun, maps.column.size() - first);
        Packets to(static_cast<std::size_t>(processes.count));
        for (const std::vector<float>* map : {&maps.column, &maps.mean, &maps.deviation}) {
            const std::span<const float> run = std::span(*map).subspan(first, count);
            to.front().insert(to.front().end(), run.begin(), run.end());
        }
        const Packets from = processes.exchange(to);
        if (processes.is_root()) join(from, first, count, maps);
    }
}

}  // namespace

FieldMaps joint_maps(const FieldChoice& choice, const Collective& processes,
                     const std::function<FieldMaps(const FieldChoice&)>& draw) {
    const auto joint = [&](FieldPart part) {
        FieldMaps maps = draw({choice.field, part});
        join(maps, processes);
        return maps;
    };
    if (choice.part != FieldPart::magnitude) return joint(choice.part);
    // By its components: its deviation is about the joint mean.
    FieldMaps all;
    for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z}) {
        FieldMaps one = joint(part);
        const bool first = all.column.empty();
        for (std::size_t n = 0; n < one.column.size(); ++n) {
            const float square = one.deviation[n] * one.deviation[n];
            one.mean[n] = one.mean[n] * one.mean[n] + square + (first ? 0 : all.mean[n]);
            one.deviation[n] = square + (first ? 0 : all.deviation[n]);
        }
        all = std::move(one);
    }
    for (auto* squares : {&all.mean, &all.deviation})
        for (float& value : *squares) value = std::sqrt(value);
    return all;
}

void sum_over(std::span<float> values, const Collective& processes) {
    // In double precision: floats would round once per process. 8 MB at a time.
    constexpr std::size_t kRun = std::size_t{1} << 20;
    std::vector<double> run;
    for (std::size_t first = 0; first < values.size(); first += kRun) {
        const std::span<float> part = values.subspan(first, std::min(kRun, values.size() - first));
        run.assign(part.begin(), part.end());
        processes.sum(run);
        std::ranges::transform(run, part.begin(),
                               [](double sum) { return static_cast<float>(sum); });
    }
}

}  // namespace vog::pictures
