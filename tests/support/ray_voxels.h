// ray_voxels.h: optical depth of a volume by brute force in double precision: every leaf and tile
// is intersected by slabs, then every active voxel of intersected leaves. Independent of the
// renderers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

#include "vog/volume.h"

namespace vog::test {

/// Ray in index space with the parameter t of the world ray.
struct IndexRay {
    Vec3d origin, direction;
    IndexRay(const Volume& volume, Vec3d world_origin, Vec3d world_direction) {
        // Subtracting the translation first keeps digits if the grid is far from the origin.
        const Mat3 back = inverse(volume.world_from_index.linear);
        origin = back * (world_origin - volume.world_from_index.translation);
        direction = back * world_direction;
    }
    /// Interval of t >= 0 in the box [lower, upper); a ray within a face is in the box above it.
    std::pair<double, double> cut(Vec3d lower, Vec3d upper) const {
        double first = 0, last = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const double to_lower = lower[axis] - origin[axis],
                         to_upper = upper[axis] - origin[axis];
            if (direction[axis] == 0) {
                if (to_lower > 0 || to_upper <= 0) return {0, 0};
                continue;
            }
            first =
                std::max(first, std::min(to_lower / direction[axis], to_upper / direction[axis]));
            last = std::min(last, std::max(to_lower / direction[axis], to_upper / direction[axis]));
        }
        return {first, std::max(first, last)};
    }
    double length_in(Vec3d center, double edge) const {
        const double half = 0.5;  // a voxel at index i covers [i - 1/2, i + 1/2)
        const auto [first, last] = cut(center - Vec3d{half, half, half},
                                       center + Vec3d{edge - half, edge - half, edge - half});
        return last - first;
    }
};

/// T of a volume of constant voxels.
inline double brute_depth(const Volume& volume, Vec3d world_origin, Vec3d world_direction) {
    const IndexRay ray(volume, world_origin, world_direction);
    double sum = 0;
    for (const Tile& tile : volume.tiles)
        sum += tile.value * ray.length_in(vec_cast<double>(tile.origin), tile.edge);
    for (const Leaf& leaf : volume.leaves) {
        const Vec3d origin = vec_cast<double>(leaf.origin);
        if (ray.length_in(origin, kLeafEdge) == 0) continue;
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                sum += leaf.value[static_cast<std::size_t>(n)] *
                       ray.length_in(
                           origin + Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)}, 1);
    }
    return sum * length(world_direction);
}

/// Trilinear interpolation of a volume.
class LinearField {
  public:
    explicit LinearField(const Volume& volume) : volume_(volume) {
        for (const Leaf& leaf : volume.leaves)
            leaves_[{leaf.origin.x, leaf.origin.y, leaf.origin.z}] = &leaf;
    }
    /// Density of a voxel; 0 if inactive.
    double voxel(Vec3i at) const {
        for (const Tile& tile : volume_.tiles) {
            const Vec3i d = at - tile.origin;
            if (std::min({d.x, d.y, d.z}) >= 0 && std::max({d.x, d.y, d.z}) < tile.edge)
                return tile.value;
        }
        const auto found = leaves_.find({at.x & ~7, at.y & ~7, at.z & ~7});
        if (found == leaves_.end()) return 0;
        const int n = leaf_offset(at.x & 7, at.y & 7, at.z & 7);
        return found->second->active(n) ? found->second->value[static_cast<std::size_t>(n)] : 0;
    }
    double operator()(Vec3d index) const {
        const Vec3i cell{static_cast<int>(std::floor(index.x)),
                         static_cast<int>(std::floor(index.y)),
                         static_cast<int>(std::floor(index.z))};
        const Vec3d w = index - vec_cast<double>(cell);
        double sum = 0;
        for (int n = 0; n < 8; ++n)
            sum += voxel(cell + Vec3i{n >> 2, n >> 1 & 1, n & 1}) * (n & 4 ? w.x : 1 - w.x) *
                   (n & 2 ? w.y : 1 - w.y) * (n & 1 ? w.z : 1 - w.z);
        return sum;
    }

  private:
    const Volume& volume_;
    std::map<std::tuple<int, int, int>, const Leaf*> leaves_;
};

/// T of the trilinear field. The ray is divided at every plane of voxel centres; on each piece the
/// field is a cubic, for which Simpson's rule is exact.
inline double brute_linear_depth(const Volume& volume, Vec3d world_origin, Vec3d world_direction) {
    const IndexRay ray(volume, world_origin, world_direction);
    const LinearField field(volume);
    Box box = index_box(volume);
    box.lower = box.lower - Vec3d{0.5, 0.5, 0.5}, box.upper = box.upper + Vec3d{0.5, 0.5, 0.5};
    const auto [first, last] = ray.cut(box.lower, box.upper);
    std::vector<double> cuts{first, last};
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) continue;
        for (double plane = box.lower[axis]; plane <= box.upper[axis]; ++plane) {
            const double t = (plane - ray.origin[axis]) / ray.direction[axis];
            if (t > first && t < last) cuts.push_back(t);
        }
    }
    std::sort(cuts.begin(), cuts.end());
    const auto at = [&](double t) { return field(ray.origin + t * ray.direction); };
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const double a = cuts[i], b = cuts[i + 1];
        sum += (b - a) / 6 * (at(a) + 4 * at(0.5 * (a + b)) + at(b));
    }
    return sum * length(world_direction);
}

}  // namespace vog::test
