// view_errors.cpp: cameras along the axes of the grid, its diagonals and elsewhere.
#include "support/view_errors.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "vog/camera.h"
#include "vog/reference.h"
#include "vog/splat.h"

namespace vog::test {

namespace {

/// Azimuth and elevation, rad, as orbit_view.
struct NamedDirection {
    const char* name;
    double azimuth, elevation;
};
constexpr double kRight = std::numbers::pi / 2, kHalf = std::numbers::pi / 4;
const double kCube = std::atan(1 / std::numbers::sqrt2);  // elevation of a cube's diagonal
const std::array<NamedDirection, 13> kDirections{{{"paper", kPaperAzimuthRad, kPaperElevationRad},
                                                  {"x", 0, 0},
                                                  {"-x", 2 * kRight, 0},
                                                  {"y", 0, kRight},
                                                  {"z", kRight, 0},
                                                  {"xz", kHalf, 0},
                                                  {"xy", 0, kHalf},
                                                  {"yz", kRight, -kHalf},
                                                  {"xyz", kHalf, kCube},
                                                  {"-x-yz", 3 * kHalf, -kCube},
                                                  {"2.2, 0.1", 2.2, 0.1},
                                                  {"4.0, -0.9", 4.0, -0.9},
                                                  {"5.4, 0.7", 5.4, 0.7}}};
constexpr std::array<double, 3> kDistances{kPaperDistanceRadii, 1.5, 6};

double relative_l2(const DepthImage& exact, const DepthImage& image) {
    double error2 = 0, norm2 = 0;
    for (std::size_t n = 0; n < exact.depth.size(); ++n) {
        const double t = exact.depth[n], d = image.depth[n] - t;
        error2 += d * d, norm2 += t * t;
    }
    return std::sqrt(error2 / norm2);
}

}  // namespace

std::vector<ViewError> view_errors(const Volume& volume, const Gaussians& model, int size_px) {
    const VoxelGrid grid = voxel_grid(volume);
    const VoxelGrid linear = voxel_grid(volume, {Interpolation::linear, 0.5});
    SplatRenderer renderer(model);
    std::vector<ViewError> errors;
    for (const double distance : kDistances) {
        const int size = distance > kPaperDistanceRadii ? 2 * size_px : size_px;
        for (const NamedDirection& from : kDirections) {
            const Camera camera = orbit_view(world_box(volume), from.azimuth, from.elevation,
                                             distance, kPaperFovDegrees);
            const DepthImage exact = render_reference(std::span(&grid, 1), camera, size, size);
            errors.push_back(
                {fmt::format("{} at {} radii", from.name, distance),
                 relative_l2(exact, renderer.render(camera, size, size)),
                 relative_l2(exact, render_reference(std::span(&linear, 1), camera, size, size))});
        }
    }
    return errors;
}

}  // namespace vog::test
