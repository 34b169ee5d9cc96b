// view_errors.cpp: cameras along the axes of the grid, its diagonals and elsewhere.
#include "support/view_errors.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <span>

#include "vog/camera.h"
#include "vog/reference.h"
#include "vog/splat.h"

namespace vog::test {

namespace {

struct NamedDirection {
    const char* name;
    double azimuth_degrees, elevation_degrees;
};
constexpr double kCubeDegrees = 35.26438968;  // elevation of a cube's diagonal
constexpr std::array<NamedDirection, 13> kDirections{
    {{"paper", kPaperAzimuthDegrees, kPaperElevationDegrees},
     {"x", 0, 0},
     {"-x", 180, 0},
     {"y", 0, 90},
     {"z", 90, 0},
     {"xz", 45, 0},
     {"xy", 0, 45},
     {"yz", 90, -45},
     {"xyz", 45, kCubeDegrees},
     {"-x-yz", 135, -kCubeDegrees},
     {"126, 6", 126, 6},
     {"229, -52", 229, -52},
     {"309, 40", 309, 40}}};
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
            const Camera camera = orbit_view(
                world_box(volume),
                {from.azimuth_degrees, from.elevation_degrees, distance, kPaperFovDegrees});
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
