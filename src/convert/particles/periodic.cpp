// periodic.cpp: positions and Gaussians of periodic boxes.
#include "vog/periodic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "core/paging.h"
#include "vog/dense.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog {

namespace {

/// Whole edges by which an interval is moved to meet [lower, upper], from the first to the last.
struct Shifts {
    int first = 0, last = 0;
};
Shifts shifts_of(double begin, double end, double lower, double upper) {
    const double edge = upper - lower;
    // Those that touch a face do not enter.
    return {static_cast<int>(std::floor((lower - end) / edge)) + 1,
            static_cast<int>(std::ceil((upper - begin) / edge)) - 1};
}

}  // namespace

void wrap(Points& points, const Box& box) {
    for (std::size_t n = 0; n < points.size(); ++n) {
        for (int axis = 0; axis < 3; ++axis) {
            const double edge = box.upper[axis] - box.lower[axis];
            double& at = points.position[n][axis];
            at -= edge * std::floor((at - box.lower[axis]) / edge);
            if (!(at < box.upper[axis])) at = box.lower[axis];  // rounded up to the face
        }
        keep_memory_at(n);
    }
}

Box domain_box(std::span<const Volume> volumes, const Collective* collective) {
    const Collective& all = collective_or_single(collective);
    double largest = 0;
    for (const Volume& volume : volumes)
        if (!volume.empty()) largest = std::max(largest, voxel_volume(volume));
    all.max(std::span(&largest, 1));
    double count = 0;
    // Ends of the index box and of the world box of the coarsest volume, the lower ones negative.
    std::array<double, 12> ends;
    ends.fill(-std::numeric_limits<double>::infinity());
    const auto coarsest = std::ranges::find_if(volumes, [&](const Volume& volume) {
        return !volume.empty() && voxel_volume(volume) == largest;
    });
    if (coarsest != volumes.end()) {
        const IndexBox cells = active_box(*coarsest);
        const Box box = world_box(*coarsest);
        for (int axis = 0; axis < 3; ++axis) {
            const auto n = static_cast<std::size_t>(axis);
            ends[n] = -cells.lower[axis], ends[n + 3] = cells.upper[axis];
            ends[n + 6] = -box.lower[axis], ends[n + 9] = box.upper[axis];
        }
        count = static_cast<double>(active_voxels(*coarsest));
    }
    all.sum(count);
    all.max(ends);
    double cells = 1;
    for (std::size_t n = 0; n < 3; ++n) cells *= 1 + ends[n + 3] + ends[n];
    if (count == 0 || count != cells) return {};
    return {{-ends[6], -ends[7], -ends[8]}, {ends[9], ends[10], ends[11]}};
}

void add_periodic_images(Gaussians& model, const Box& box) {
    const std::size_t count = model.size();
    std::vector<std::size_t> index;
    std::vector<Vec3f> moved;
    constexpr int kMost = 2;
    for (std::size_t i = 0; i < count; ++i) {
        keep_memory_at(i);
        index.push_back(i);
        moved.push_back(model.mean[i]);
        const Box support = support_box(model, i);
        std::array<Shifts, 3> along;
        for (int axis = 0; axis < 3; ++axis) {
            Shifts& one = along[static_cast<std::size_t>(axis)];
            one = shifts_of(support.lower[axis], support.upper[axis], box.lower[axis],
                            box.upper[axis]);
            if (one.last - one.first > kMost)
                throw Error(fmt::format("{}: Gaussian {} is wider than the periodic box",
                                        model.source.empty() ? "model" : model.source, i));
        }
        const Vec3d edges = box.upper - box.lower;
        for (int x = along[0].first; x <= along[0].last; ++x)
            for (int y = along[1].first; y <= along[1].last; ++y)
                for (int z = along[2].first; z <= along[2].last; ++z) {
                    if (x == 0 && y == 0 && z == 0) continue;
                    index.push_back(i);
                    moved.push_back(vec_cast<float>(vec_cast<double>(model.mean[i]) +
                                                    Vec3d{x * edges.x, y * edges.y, z * edges.z}));
                }
    }
    Gaussians all = select(model, index);
    std::ranges::copy(moved, all.mean.begin());
    all.source_voxels = model.source_voxels;
    all.summary = model.summary;
    all.box = box;
    all.options = fmt::format("{}{}{}{},{},{},{},{},{}", model.options,
                              model.options.empty() ? "" : " ", kPeriodicOption, box.lower.x,
                              box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
    model = std::move(all);
}

namespace {

bool is_inside(const Box& box, Vec3d at) {
    for (int axis = 0; axis < 3; ++axis)
        if (at[axis] < box.lower[axis] || at[axis] >= box.upper[axis]) return false;
    return true;
}

}  // namespace

Gaussians without_images(Gaussians model) {
    const std::optional<Box> period = periodic_box(model);
    if (!period) return model;
    std::vector<std::size_t> inside;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (is_inside(*period, world_mean(model, i))) inside.push_back(i);
    return select(model, inside);
}

double mass_without_images(const Gaussians& model) {
    const std::optional<Box> period = periodic_box(model);
    if (!period) return mass(model);
    double sum = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        if (is_inside(*period, world_mean(model, i))) sum += mass(model, i);
        keep_memory_at(i);
    }
    return sum;
}

}  // namespace vog
