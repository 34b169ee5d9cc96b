// evaluated_volumes.cpp: statistics of the evaluated data.
#include "evaluate/evaluated_volumes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <utility>

#include "vog/text.h"

namespace vog::evaluation {

namespace {

/// Name of the processor by Linux's /proc; unknown elsewhere.
std::string processor_name() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown processor";
}

/// Voxels in the bounding box of all processes' active voxels: the paper's measure of size.
std::uint64_t box_voxels(const Volume& volume, const Collective& collective) {
    std::array<std::int64_t, 3> lower, upper;
    lower.fill(std::numeric_limits<std::int64_t>::max());
    upper.fill(std::numeric_limits<std::int64_t>::min());
    const auto include = [&](Vec3i origin, int x, int y, int z, int edge) {
        const std::array<std::int64_t, 3> first = {
            std::int64_t{origin.x} + x, std::int64_t{origin.y} + y, std::int64_t{origin.z} + z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], first[axis]);
            upper[axis] = std::max(upper[axis], first[axis] + edge);
        }
    };
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n)) include(leaf.origin, n >> 6, n >> 3 & 7, n & 7, 1);
    for (const Tile& tile : volume.tiles) include(tile.origin, 0, 0, 0, tile.edge);
    // Indices are exact in doubles, except for the limits of an empty part, which change no
    // maximum.
    std::array<double, 6> bounds;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bounds[axis] = -static_cast<double>(lower[axis]);
        bounds[axis + 3] = static_cast<double>(upper[axis]);
    }
    collective.max(bounds);
    double voxels = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) voxels *= bounds[axis + 3] + bounds[axis];
    return static_cast<std::uint64_t>(std::max(voxels, 0.0));
}

Scene scene_of_source(const Box& box, Source source, const Collective* collective) {
    Scene scene;
    scene.sources.push_back(std::move(source));
    scene.subject = box;
    scene.collective = collective;
    return scene;
}

}  // namespace

Scene scene_in(const Box& box, VoxelSource voxels, const Collective* collective) {
    return scene_of_source(box, std::move(voxels), collective);
}

Scene scene_in(const Box& box, const Gaussians& model, const Collective* collective) {
    return scene_of_source(box, ModelSource{borrowed(model)}, collective);
}

void allreduce_sum(const Collective& collective, std::uint64_t& count) {
    auto sum = static_cast<double>(count);
    collective.sum(sum);
    count = static_cast<std::uint64_t>(sum);
}

Box box_of(std::span<const Volume> volumes, const Collective& collective) {
    Box box;
    for (const Volume& volume : volumes)
        if (!volume.empty()) box.include(world_box(volume));
    std::array<double, 6> bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds[static_cast<std::size_t>(axis)] = -box.lower[axis];
        bounds[static_cast<std::size_t>(axis) + 3] = box.upper[axis];
    }
    collective.max(bounds);
    return {{-bounds[0], -bounds[1], -bounds[2]}, {bounds[3], bounds[4], bounds[5]}};
}

Evaluation begin_evaluation(std::span<const Volume> volumes, const EvaluateOptions& options) {
    Evaluation evaluation;
    for (const Volume& volume : volumes) {
        evaluation.title += evaluation.title.empty() ? "" : ", ";
        evaluation.title +=
            std::filesystem::path(volume.source).filename().string() + " " + volume.name;
        evaluation.active_voxels += active_voxels(volume);
        evaluation.bounding_voxels += box_voxels(volume, collective_or_single(options.collective));
        evaluation.leaves += volume.leaves.size();
        for (const Leaf& leaf : volume.leaves) evaluation.dense_leaves += leaf.dense();
        evaluation.tiles += volume.tiles.size();
        evaluation.mass += mass(volume);
    }
    allreduce_sum(collective_or_single(options.collective), evaluation.active_voxels);
    allreduce_sum(collective_or_single(options.collective), evaluation.leaves);
    allreduce_sum(collective_or_single(options.collective), evaluation.dense_leaves);
    allreduce_sum(collective_or_single(options.collective), evaluation.tiles);
    collective_or_single(options.collective).sum(evaluation.mass);
    evaluation.width = options.width;
    evaluation.height = options.height;
    evaluation.tf = printable(options.tf);
    evaluation.extinction = options.extinction > 0 ? fmt::format("{}", options.extinction) : "auto";
    evaluation.machine = processor_name();
    evaluation.threads = thread_count();
    return evaluation;
}

}  // namespace vog::evaluation
