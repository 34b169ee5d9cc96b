// scenes.h: models and cameras that every renderer is held against the closed form with.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "vog/splat.h"

namespace vog::test {

struct Scene {
    std::string name;
    Gaussians model;
    Camera camera;
    int width = 64, height = 64;
    double tolerance = 1e-5;  ///< of the image maximum, for single-precision renderers
};
/// The name stands for the scene in test listings.
inline void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

/// Deterministic uniform numbers in [0, 1): the same on every machine.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    double operator()();
    double operator()(double low, double high) { return low + (high - low) * (*this)(); }
    Vec3d in_cube(double half_edge);
    Quat rotation();

  private:
    std::uint64_t state_;
};

/// One Gaussian appended; a default quaternion keeps the model axis-aligned if it was.
void add(Gaussians& model, Vec3f mean, Vec3f scale, float density, Quat rotation = {});
/// N Gaussians in the cube [-1, 1]^3, scales in [low, high], rotated, densities in (0, 1].
Gaussians random_gaussians(int count, double low, double high, std::uint64_t seed,
                           float cutoff = 2.25f);

/// Wide angles, eyes near, inside and in front of Gaussians, sub-pixel, elongated, rotated,
/// off-axis, tiny and huge world units, several cutoffs, an empty model, an image of one pixel;
/// thousands on one ray or around the eye, rays along axes and within faces of boxes, boxes
/// without depth.
std::vector<Scene> scenes();

/// T by the sum of the closed form in double precision, pixel by pixel (the integral behind
/// vog::optical_depth, which optical_depth_test.cpp holds against quadrature).
std::vector<double> exact_depth(const Scene& scene);

}  // namespace vog::test
