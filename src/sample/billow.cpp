// billow.cpp: depth below a billow's boundary at the voxels of a leaf.
#include "sample/billow.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vog::sampling {

namespace {

/// Largest displacement by a warp with at most `along_axis` along each axis.
float warp_distance(float along_axis) { return std::sqrt(3.0f) * along_axis; }

std::array<float, kLeafVoxels> moved(const std::array<float, kLeafVoxels>& from,
                                     const std::array<float, kLeafVoxels>& by, float limit) {
    std::array<float, kLeafVoxels> result;
    for (std::size_t n = 0; n < kLeafVoxels; ++n)
        result[n] = from[n] + std::clamp(by[n], -limit, limit);
    return result;
}

}  // namespace

bool may_hold(const Billow& billow, Vec3f center, float radius) {
    const float below_base = billow.base_y - center.y - radius;
    if (below_base > billow.base_roughness * billow.relief_limit) return false;
    const float nearest = billow.lobes.distance(center) - radius - warp_distance(billow.warp_limit);
    return nearest <= billow.relief_limit;
}

bool find_depths(const Billow& billow, const LeafPoints& points, BillowPoints& result) {
    // Warp. Most leaves end here: they are farther from the lobes than the rest of warp and relief.
    LeafPoints warp{};
    for (std::size_t done = 0; done < billow.warp.size(); ++done) {
        add_warp(points, billow.warp[done], billow.detail, warp);
        result.bent.x = moved(points.x, warp.x, billow.warp_limit);
        result.bent.y = moved(points.y, warp.y, billow.warp_limit);
        result.bent.z = moved(points.z, warp.z, billow.warp_limit);
        const Sphere around = sphere_around(result.bent);
        const float left = warp_distance(upper_bound_of(billow.warp.subspan(done + 1)));
        if (billow.lobes.distance(around.center) - around.radius - left > billow.relief_limit)
            return false;
    }

    // Depth below the displaced boundary.
    alignas(64) std::array<float, kLeafVoxels> outside;
    billow.lobes.distance(result.bent, outside);
    for (std::size_t n = 0; n < kLeafVoxels; ++n) result.depth[n] = -outside[n];
    if (!add_noise_above_zero(result.bent, billow.relief, billow.detail, result.depth))
        return false;
    for (std::size_t n = 0; n < kLeafVoxels; ++n) {
        result.relief[n] = std::min(result.depth[n] + outside[n], billow.relief_limit);
        result.depth[n] = result.relief[n] - outside[n];
    }

    // Cut at the base and at the faces of the cube.
    for (std::size_t n = 0; n < kLeafVoxels; ++n) {
        const float base = points.y[n] - billow.base_y + billow.base_roughness * result.relief[n];
        const float face =
            0.5f - std::max({std::abs(points.x[n]), std::abs(points.y[n]), std::abs(points.z[n])});
        result.depth[n] = std::min({result.depth[n], base, face});
    }
    return true;
}

}  // namespace vog::sampling
