// periodic.cpp: positions and Gaussians of periodic boxes.
#include "vog/periodic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/paging.h"
#include "vog/dense.h"
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

Box domain_box(std::span<const Volume> volumes) {
    const Volume* coarsest = nullptr;
    double largest = 0;
    for (const Volume& volume : volumes)
        if (const double size = std::abs(determinant(volume.world_from_index.linear));
            !volume.empty() && size > largest) {
            largest = size;
            coarsest = &volume;
        }
    if (!coarsest) return {};
    const IndexBox cells = active_box(*coarsest);
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) count *= double{1} + cells.upper[axis] - cells.lower[axis];
    return static_cast<double>(active_voxels(*coarsest)) == count ? world_box(*coarsest) : Box{};
}

void add_periodic_images(Gaussians& model, const Box& box) {
    const std::size_t count = model.size();
    std::vector<std::size_t> index;
    std::vector<Vec3f> moved;
    for (std::size_t i = 0; i < count; ++i) {
        index.push_back(i);
        moved.push_back(model.mean[i]);
        keep_memory_at(i);
    }
    constexpr int kMost = 2;
    for (std::size_t i = 0; i < count; ++i) {
        keep_memory_at(i);
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
