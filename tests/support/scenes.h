// scenes.h: models and cameras for comparing every renderer with the closed form.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "render/splat/splat.h"

namespace vog::test {

/// Model and view.
struct Scene {
    std::string name;
    Gaussians model;
    Camera camera;
    int width = 64, height = 64;
    double tolerance = 1e-5;  ///< of single-precision renderers, relative to the image maximum
};
/// The name stands for the scene in test listings.
inline void PrintTo(const Scene& scene, std::ostream* out) { *out << scene.name; }

/// Deterministic uniform numbers in [0, 1), the same on every machine.
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

/// Appends a Gaussian; a default quaternion keeps an axis-aligned model axis-aligned.
void add(Gaussians& model, Vec3f mean, Vec3f scale, float density, Quat rotation = {});
/// N Gaussians in the cube [-1, 1]^3, scales in [low, high], rotated, densities in (0, 1].
Gaussians random_gaussians(int count, double low, double high, std::uint64_t seed,
                           float cutoff = 2.25f);

/// Scenes with wide angles; eyes near, inside and in front of Gaussians; sub-pixel, elongated,
/// rotated and off-axis Gaussians; tiny and huge world units; several cutoffs; an empty model; one
/// pixel; thousands of Gaussians on one ray or around the eye; rays along axes and within faces of
/// boxes.
std::vector<Scene> scenes();

/// T per pixel as the sum of the closed form in double precision, of Gaussians as pixel_mean.h draws
/// them: the integral of vog::optical_depth, which optical_depth_test.cpp compares with quadrature.
std::vector<double> exact_depth(const Scene& scene);

}  // namespace vog::test
