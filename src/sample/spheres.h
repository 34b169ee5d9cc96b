// spheres.h: the union of many spheres, and how clouds grow one: spheres upon spheres.
#pragma once

#include <vector>

#include "sample/noise.h"
#include "vog/linear.h"

namespace vog::sampling {

struct Sphere {
    Vec3f center;
    float radius = 0;
};

/// A sphere that holds every point: about their box, or a little more.
Sphere sphere_around(const LeafPoints& points);

inline float distance(const Sphere& sphere, Vec3f point) {
    return length(point - sphere.center) - sphere.radius;
}

/// Distance to the nearest of some spheres, negative inside. It changes by no more than the point
/// moves.
class SphereUnion {
  public:
    explicit SphereUnion(const std::vector<Sphere>& spheres);
    float distance(Vec3f point) const;
    /// The same for each point of a leaf, in less time: few spheres are the nearest of any.
    void distance(const LeafPoints& points, LeafValues out) const;

  private:
    /// Distance of `point` from each sphere, and the smallest.
    float distances(Vec3f point, std::vector<float>& each) const;

    std::vector<float> x_, y_, z_, radius_;
};

/// How one generation of spheres grows on another.
struct Budding {
    int buds = 10;            ///< on each sphere
    float reach = 0.85f;      ///< distance of the centres, in parent radii
    float min_radius = 0.3f;  ///< in parent radii
    float max_radius = 0.5f;  ///< in parent radii
    float lowest_y = -0.25f;  ///< of the unit direction in which a bud grows
};

/// Buds on every sphere of `parents`, in random directions.
std::vector<Sphere> buds(const std::vector<Sphere>& parents, const Budding& budding,
                         Uniform& uniform);

}  // namespace vog::sampling
