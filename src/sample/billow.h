// billow.h: the shape that clouds and explosions share: a union of spheres, bent by a warp, its
// boundary displaced by relief, cut by a flat base.
#pragma once

#include <array>
#include <span>

#include "sample/spheres.h"

namespace vog::sampling {

struct Billow {
    SphereUnion lobes;
    std::span<const Octave> warp;    ///< moves the points at which the lobes are looked up
    float warp_limit = 0;            ///< along each axis, world units
    std::span<const Octave> relief;  ///< moves the boundary out and in
    float relief_limit = 0;          ///< outwards, world units
    float base_y = -0.5f;            ///< nothing lies below, but for the roughness
    float base_roughness = 0.5f;     ///< share of the relief that moves the base
    Detail detail;
};
// The limits are for speed: octaves do not peak together, and bounds from the sum of their
// amplitudes would send twice the leaves into evaluation. With limits near half that sum, less than
// one point in 10^4 is affected (of 2 million, at the values cloud.cpp and explosion.cpp take).

/// A billow seen from a leaf.
struct BillowPoints {
    using Values = std::array<float, kLeafVoxels>;
    LeafPoints bent;            ///< the points, warped
    alignas(64) Values depth;   ///< below the boundary, world units; negative outside
    alignas(64) Values relief;  ///< how far out the boundary is moved there, world units
};

/// False only if no point within `radius` of `center` is inside.
bool may_hold(const Billow& billow, Vec3f center, float radius);

/// False, and nothing useful in `result`, if no point is inside. Depths end at the faces of
/// [-1/2, 1/2]^3, so nothing is outside that cube.
bool find_depths(const Billow& billow, const LeafPoints& points, BillowPoints& result);

/// 0 to 1 as t goes from 0 to 1, flat at both ends.
inline float smooth_step(float t) {
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

}  // namespace vog::sampling
