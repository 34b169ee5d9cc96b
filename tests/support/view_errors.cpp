// view_errors.cpp: cameras along the axes of the grid, its diagonals and elsewhere.
#include "support/view_errors.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "vog/reference.h"
#include "vog/splat.h"

namespace vog::test {

namespace {

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
constexpr std::array<double, 3> kDistances{1.5, kPaperDistanceRadii, 6};

}  // namespace

std::span<const NamedDirection> directions() { return kDirections; }

std::vector<std::vector<double>> view_errors(const Volume& volume, const Gaussians& model,
                                             int paper_size_px) {
    const VoxelGrid grid = voxel_grid(volume);
    SplatRenderer renderer(model);
    std::vector<std::vector<double>> errors;
    for (const double distance : kDistances) {
        errors.emplace_back();
        // From afar more pixels: an image that samples every second voxel measures its own aliasing.
        const auto size_px = static_cast<int>(paper_size_px * std::max(1.0, distance / 3));
        for (const NamedDirection& from : kDirections) {
            const Camera camera = orbit_view(world_box(volume), from.azimuth, from.elevation,
                                             distance, kPaperFovDegrees);
            const DepthImage exact =
                render_reference(std::span(&grid, 1), camera, size_px, size_px);
            const DepthImage image = renderer.render(camera, size_px, size_px);
            double error2 = 0, norm2 = 0;
            for (std::size_t n = 0; n < exact.depth.size(); ++n) {
                const double t = exact.depth[n], d = image.depth[n] - t;
                error2 += d * d, norm2 += t * t;
            }
            errors.back().push_back(std::sqrt(error2 / norm2));
        }
    }
    return errors;
}

WorstError worst_error(const Volume& volume, const Gaussians& model, int paper_size_px) {
    const auto errors = view_errors(volume, model, paper_size_px);
    WorstError worst;
    worst.paper = errors[1][0];
    for (std::size_t d = 0; d < errors.size(); ++d)
        for (std::size_t n = 0; n < errors[d].size(); ++n)
            if (errors[d][n] > worst.worst)
                worst.worst = errors[d][n],
                worst.view = fmt::format("{} at {} radii", kDirections[n].name, kDistances[d]);
    return worst;
}

}  // namespace vog::test
