// spheres.h: signed distance to a union of spheres, and growth of spheres on spheres.
#pragma once

#include <vector>

#include "sample/noise.h"
#include "vog/linear.h"

namespace vog::sampling {

struct Sphere {
    Vec3f center;
    float radius = 0;
};

/// Sphere around the bounding box of the points, slightly enlarged for rounding.
Sphere sphere_around(const LeafPoints& points);

/// Signed distance, negative inside.
inline float distance(const Sphere& sphere, Vec3f point) {
    return length(point - sphere.center) - sphere.radius;
}

/// Union of spheres by the signed distance to the nearest: negative inside, Lipschitz constant 1.
class SphereUnion {
  public:
    explicit SphereUnion(const std::vector<Sphere>& spheres);
    float distance(Vec3f point) const;
    /// Distances at all points of a leaf; spheres that are nearest to none are skipped.
    void distance(const LeafPoints& points, LeafValues out) const;

  private:
    /// Fills `each` with the distance to each sphere; returns the smallest.
    float distances(Vec3f point, std::vector<float>& each) const;

    std::vector<float> x_, y_, z_, radius_;
};

/// Parameters of one generation of spheres that grow on another.
struct Budding {
    int buds = 10;            ///< per sphere
    float reach = 0.85f;      ///< distance of the centres, in parent radii
    float min_radius = 0.3f;  ///< in parent radii
    float max_radius = 0.5f;  ///< in parent radii
    float lowest_y = -0.25f;  ///< lower bound on y of the unit direction of growth
};

/// Spheres in random directions on every sphere of `parents`.
std::vector<Sphere> buds(const std::vector<Sphere>& parents, const Budding& budding,
                         Uniform& uniform);

}  // namespace vog::sampling
