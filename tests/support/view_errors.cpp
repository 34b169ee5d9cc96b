// view_errors.cpp: cameras along the axes of the grid, its diagonals and elsewhere.
#include "support/view_errors.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <span>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "vog/camera.h"

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

std::vector<ExactView> exact_views(const Volume& volume, const ExactViewOptions& options) {
    const VoxelGrid grid = voxel_grid(volume);
    const VoxelGrid linear = voxel_grid(volume, {Interpolation::linear, 0.5});
    std::vector<ExactView> views;
    const auto add = [&](const NamedDirection& from, Orbit orbit, const std::string& name) {
        orbit.azimuth_degrees = from.azimuth_degrees;
        orbit.elevation_degrees = from.elevation_degrees;
        const Camera camera = orbit_view(world_box(volume), orbit);
        const bool far = orbit.distance_radii > kPaperDistanceRadii;
        const int size = far ? 2 * options.size_px : options.size_px;
        ReferenceOptions rays;
        rays.samples = options.samples;
        ExactView view{fmt::format("{} {}", from.name, name), camera,
                       render_reference(std::span(&grid, 1), camera, size, size, rays), 0};
        if (options.faces)
            view.faces = relative_l2(
                view.exact, render_reference(std::span(&linear, 1), camera, size, size, rays));
        views.push_back(std::move(view));
    };
    if (options.orthographic) {
        for (const NamedDirection& from : kDirections) {
            Orbit orbit;
            orbit.orthographic = true;
            add(from, orbit, "orthographic");
        }
        return views;
    }
    for (const double distance : kDistances)
        for (const NamedDirection& from : kDirections) {
            Orbit orbit;
            orbit.distance_radii = distance;
            add(from, orbit, fmt::format("at {} radii", distance));
        }
    return views;
}

std::vector<double> view_errors(std::span<const ExactView> views, const Gaussians& model) {
    SplatRenderer renderer(model);
    std::vector<double> errors;
    for (const ExactView& view : views)
        errors.push_back(relative_l2(
            view.exact, renderer.render(view.camera, view.exact.width, view.exact.height)));
    return errors;
}

}  // namespace vog::test
