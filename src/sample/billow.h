// billow.h: shape of clouds and explosions: a union of spheres, warped, its boundary displaced by
// relief noise, cut by a flat base.
#pragma once

#include <array>
#include <span>

#include "sample/spheres.h"

namespace vog::sampling {

/// Parameters of the shape.
struct Billow {
    SphereUnion lobes;
    std::span<const Octave> warp;    ///< displaces the points at which the lobes are evaluated
    float warp_limit = 0;            ///< along each axis, world units
    std::span<const Octave> relief;  ///< displaces the boundary
    float relief_limit = 0;          ///< outwards, world units
    float base_y = -0.5f;            ///< height of the base, world units
    float base_roughness = 0.5f;     ///< share of the relief that displaces the base
    Detail detail;
};
// Limits are near half the sum of the octaves' amplitudes: octaves rarely peak together, and the
// full sum would double the leaves to evaluate. They clamp less than one point in 10^4 (of 2
// million, with the values of cloud.cpp and explosion.cpp).

/// Billow at the voxel centres of a leaf.
struct BillowPoints {
    using Values = std::array<float, kLeafVoxels>;
    LeafPoints bent;            ///< warped positions
    alignas(64) Values depth;   ///< depth below the boundary, world units; negative outside
    alignas(64) Values relief;  ///< outward displacement of the boundary, world units
};

/// Conservative test: false only if no point within `radius` of `center` is inside.
bool may_hold(const Billow& billow, Vec3f center, float radius);

/// Computes depths at `points`; the shape is clipped to [-1/2, 1/2]^3.
/// returns  false if no point is inside; `result` is then undefined
bool find_depths(const Billow& billow, const LeafPoints& points, BillowPoints& result);

/// 3 t^2 - 2 t^3 with t clamped to [0, 1].
inline float smooth_step(float t) {
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

}  // namespace vog::sampling
