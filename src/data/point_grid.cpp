// point_grid.cpp: mean spacing of particles, and their sorting by Morton and leaf keys.
#include "data/point_grid.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "core/morton.h"
#include "core/paging.h"
#include "core/parallel.h"

namespace vog {

namespace {

/// tbb::parallel_sort of an array that may be larger than memory.
/// less  a total order, or the result depends on the threads
template <class Values, class Less>
void sort_parallel(Values& values, const Less& less) {
    if (!memory_limited()) {
        tbb::parallel_sort(values.begin(), values.end(), less);
        return;
    }
    tbb::parallel_sort(values.begin(), values.end(), [&less](const auto& a, const auto& b) {
        thread_local std::size_t turns = 0;
        keep_memory_at(turns++);
        return less(a, b);
    });
}

/// Sorts particles by key_of(particle), then by index.
template <class KeyOf>
void sort_by_key(std::size_t count, const KeyOf& key_of, BigVector<std::uint64_t>& key,
                 BigVector<std::uint32_t>& index) {
    struct Entry {
        std::uint64_t key;
        std::uint32_t index;
    };
    BigVector<Entry> entries;
    resize_kept(entries, count);
    vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
        entries[n] = {key_of(n), static_cast<std::uint32_t>(n)};
    });
    sort_parallel(entries, [](const Entry& a, const Entry& b) {
        return a.key != b.key ? a.key < b.key : a.index < b.index;
    });
    resize_kept(key, count);
    resize_kept(index, count);
    vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
        key[n] = entries[n].key;
        index[n] = entries[n].index;
    });
}

/// Mean spacing of `count` uniformly scattered particles in a box of one to three dimensions.
double uniform_spacing(const Box& box, std::size_t count) {
    const Vec3d size = box.upper - box.lower;
    const double largest = std::max({size.x, size.y, size.z});
    if (!(largest > 0)) return 1;
    constexpr double kFlat = 1e-6;
    double product = 1;
    int dimensions = 0;
    for (int axis = 0; axis < 3; ++axis)
        if (size[axis] > kFlat * largest) {
            product *= size[axis] / largest;
            ++dimensions;
        }
    return largest * std::pow(product / static_cast<double>(count), 1.0 / dimensions);
}

/// Number of octree cells of a level that hold particles; level 0 has the finest.
std::size_t occupied_cells(const PointGrid& grid, int level) {
    const int shift = 3 * level;
    std::size_t count = 1;
    for (std::size_t n = 1; n < grid.size(); ++n) {
        count += grid.key[n] >> shift != grid.key[n - 1] >> shift;
        keep_memory_at(n);
    }
    return count;
}

/// Halves the voxel size while that brings the mean number of particles in an occupied voxel nearer
/// to that of a uniform scatter: clustered particles get smaller voxels.
void refine_voxels(PointGrid& grid) {
    // Poisson scatter of one particle per voxel: 1 / (1 - 1/e) = 1.582 per occupied voxel. The
    // distance to it is measured in factors, on a logarithmic scale.
    constexpr double kPoissonMean = 1.582;
    const auto count = static_cast<double>(grid.size());
    const auto distance = [&](int root_log2) {
        const int level = kKeyBits - root_log2;
        const double mean = count / static_cast<double>(occupied_cells(grid, level));
        return std::abs(std::log(mean / kPoissonMean));
    };
    double best = distance(grid.root_log2);
    while (grid.root_log2 < kKeyBits) {
        const double finer = distance(grid.root_log2 + 1);
        if (finer >= best) break;
        best = finer;
        ++grid.root_log2;
        grid.voxel_size *= 0.5;
    }
}

}  // namespace

PointGrid point_grid(const Points& points) {
    const Box box = bounds(points);
    const Vec3d size = box.upper - box.lower;
    PointGrid grid;
    grid.origin = box.lower;
    grid.voxel_size = uniform_spacing(box, points.size());
    const double largest = std::max({size.x, size.y, size.z});
    while (std::ldexp(grid.voxel_size, grid.root_log2) < largest && grid.root_log2 < kKeyBits)
        ++grid.root_log2;

    grid.voxel_size = std::max(grid.voxel_size, std::ldexp(largest, -grid.root_log2));

    // Particles on the upper faces of the root belong to its last cells.
    const double scale = std::ldexp(1.0, kKeyBits - grid.root_log2) / grid.voxel_size;
    constexpr double kLast = (1 << kKeyBits) - 1;
    sort_by_key(
        points.size(),
        [&](std::size_t n) {
            const Vec3d at = scale * (points.position[n] - box.lower);
            const auto cell = [&](int axis) {
                return static_cast<std::uint64_t>(std::min(at[axis], kLast));
            };
            return morton_code(cell(0), cell(1), cell(2));
        },
        grid.key, grid.index);
    refine_voxels(grid);
    return grid;
}

Vec3i LeafOrder::voxel(std::uint64_t key) {
    // From the root down: 9 bits an axis of 4096^3, then 5, 4 and 3.
    Vec3i voxel;
    int shift = 63;
    for (const int bits : {9, 5, 4, 3})
        for (int axis = 0; axis < 3; ++axis) {
            shift -= bits;
            voxel[axis] =
                voxel[axis] << bits | static_cast<std::int32_t>(key >> shift & ((1u << bits) - 1));
        }
    return voxel;
}

LeafOrder leaf_order(const Points& points, double voxel_size) {
    const Box box = bounds(points);
    LeafOrder order;
    order.origin = box.lower + Vec3d{0.5 * voxel_size, 0.5 * voxel_size, 0.5 * voxel_size};
    constexpr double kLast = (1 << kKeyBits) - 1;
    sort_by_key(
        points.size(),
        [&](std::size_t n) {
            const Vec3d at = (1 / voxel_size) * (points.position[n] - box.lower);
            std::uint64_t key = 0;
            int left = kKeyBits;
            for (const int bits : {9, 5, 4, 3}) {
                left -= bits;
                for (int axis = 0; axis < 3; ++axis) {
                    const auto index = static_cast<std::uint64_t>(std::min(at[axis], kLast));
                    key = key << bits | (index >> left & ((1u << bits) - 1));
                }
            }
            return key;
        },
        order.key, order.index);
    return order;
}

double point_voxel_size(const Points& points) {
    validate(points);
    return point_grid(points).voxel_size;
}

}  // namespace vog
