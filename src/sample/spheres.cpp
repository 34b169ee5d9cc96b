// spheres.cpp: signed distance to a union of spheres, and growth by budding.
#include "sample/spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vog::sampling {

namespace {

/// Random direction, uniform on the unit sphere.
Vec3f random_direction(Uniform& uniform) {
    // Rejection sampling in the unit ball, without its centre, where rounding dominates.
    while (true) {
        const float x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
        const float squared = x * x + y * y + z * z;
        if (squared <= 1 && squared > 1e-4f) return (1 / std::sqrt(squared)) * Vec3f{x, y, z};
    }
}

}  // namespace

Sphere sphere_around(const LeafPoints& points) {
    const Interval x = interval_of(points.x), y = interval_of(points.y), z = interval_of(points.z);
    const Vec3f lower{x.lower, y.lower, z.lower}, upper{x.upper, y.upper, z.upper};
    return {0.5f * (lower + upper), 0.5f * length(upper - lower) * 1.001f + 1e-6f};
}

SphereUnion::SphereUnion(const std::vector<Sphere>& spheres) {
    for (const Sphere& sphere : spheres) {
        x_.push_back(sphere.center.x);
        y_.push_back(sphere.center.y);
        z_.push_back(sphere.center.z);
        radius_.push_back(sphere.radius);
    }
}

float SphereUnion::distances(Vec3f point, std::vector<float>& each) const {
    each.resize(radius_.size());
    for (std::size_t i = 0; i < each.size(); ++i) {
        const float dx = x_[i] - point.x, dy = y_[i] - point.y, dz = z_[i] - point.z;
        each[i] = std::sqrt(dx * dx + dy * dy + dz * dz) - radius_[i];
    }
    return *std::min_element(each.begin(), each.end());
}

float SphereUnion::distance(Vec3f point) const {
    thread_local std::vector<float> each;
    return distances(point, each);
}

void SphereUnion::distance(const LeafPoints& points, LeafValues out) const {
    // Distances at a point differ from those at the centre by at most the radius.
    const Sphere around = sphere_around(points);
    thread_local std::vector<float> each;
    const float least = distances(around.center, each);

    // From the nearest sphere on, a sphere is evaluated only if it can be nearer to some point.
    const auto lower = [&](std::size_t i) {
        const float x = x_[i], y = y_[i], z = z_[i], radius = radius_[i];
        for (std::size_t n = 0; n < kLeafVoxels; ++n) {
            const float dx = points.x[n] - x, dy = points.y[n] - y, dz = points.z[n] - z;
            const float d = std::sqrt(dx * dx + dy * dy + dz * dz) - radius;
            out[n] = d < out[n] ? d : out[n];
        }
        return interval_of(out).upper;
    };
    std::fill(out.begin(), out.end(), std::numeric_limits<float>::max());
    const auto nearest = std::find(each.begin(), each.end(), least) - each.begin();
    float farthest = lower(static_cast<std::size_t>(nearest));
    for (std::size_t i = 0; i < each.size(); ++i)
        if (each[i] - around.radius < farthest) farthest = lower(i);
}

std::vector<Sphere> buds(const std::vector<Sphere>& parents, const Budding& budding,
                         Uniform& uniform) {
    std::vector<Sphere> result;
    for (const Sphere& parent : parents)
        for (int bud = 0; bud < budding.buds; ++bud) {
            Vec3f direction = random_direction(uniform);
            while (direction.y < budding.lowest_y) direction = random_direction(uniform);
            const float radius = uniform(budding.min_radius, budding.max_radius);
            result.push_back({parent.center + budding.reach * parent.radius * direction,
                              parent.radius * radius});
        }
    return result;
}

}  // namespace vog::sampling
