// reference.cpp: Optical depth of volumes by traversal of their voxels along rays.
#include "render/reference/reference.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "render/pixel_tiles.h"
#include "render/reference/fields/box_view.h"
#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference_grid.h"
#include "render/reference/reference_levels.h"
#include "render/reference/reference_linear.h"
#include "vog/error.h"

namespace vog {

using namespace reference;

namespace {

/// Visitor that integrates voxels of constant value.
struct ConstantSum {
    const GridRay& ray;
    double sum = 0;

    void leaf(const NanoLeaf& leaf, Vec3d lower, Segment segment) {
        const float* values = leaf.data()->mValues;
        for_each_cell<3>(ray, lower, 1, segment, [&](std::uint32_t offset, Segment part) {
            sum += values[offset] * (part.last - part.first);
        });
    }
    void tile(Vec3d, int, float value, Segment segment) {
        sum += value * (segment.last - segment.first);
    }
};

double depth_along(const VoxelGrid::Data& grid, Vec3d origin, Vec3d direction,
                   Segment within = {}) {
    // t is the same in both spaces: a length in world units is t times the length of `direction`.
    double sum = 0;
    if (grid.options.interpolation == Interpolation::constant) {
        const GridRay ray = grid.voxel_ray(origin, direction);
        ConstantSum constant{ray};
        march(grid.root_cells, ray, constant, within);
        sum = constant.sum;
    } else {
        sum = linear_sum(grid, grid.center_ray(origin, direction), within);
    }
    return sum * length(direction);
}

void check_ray(Vec3d origin, Vec3d direction) {
    if (!finite(origin) || !finite(direction) || length(direction) == 0)
        throw Error(
            "optical_depth: origin or direction is not finite or the direction is 0, expected a "
            "ray");
}

}  // namespace

void reference::check_samples(int samples) {
    constexpr int kMostSamples = 64;  // 4096 rays: the mean changes by less than a float's rounding
    if (samples < 1 || samples > kMostSamples)
        throw Error(fmt::format("reference: {} x {} samples in a pixel, expected 1 to {}", samples,
                                samples, kMostSamples));
}

std::span<const std::byte> VoxelGrid::bytes() const {
    return {data_->tree.buffer.data(), data_->tree.buffer.size()};
}

void VoxelGrid::Data::set_tree(NanoTree made, bool of_part) {
    tree = std::move(made);
    const auto& box = tree.root().bbox();
    corner = {};
    if (!box.empty()) corner = {double(box.min()[0]), double(box.min()[1]), double(box.min()[2])};
    constexpr double kSpacing = 1 << 20;
    if (of_part)
        for (int axis = 0; axis < 3; ++axis)
            corner[axis] = kSpacing * std::round(corner[axis] / kSpacing);
    root_cells = RootCells(tree.root(), corner);
}

namespace {

VoxelGrid grid_of(const Volume& volume, const VoxelGridOptions& options, bool of_part) {
    // Shorter steps change no digit of a float, and would take hours.
    constexpr double kLeastStep = 1e-3;
    const double step = options.step_voxels;
    if (!(step == 0 || (step >= kLeastStep && std::isfinite(step))))
        throw Error(
            fmt::format("step {} voxels, expected 0 (exact) or at least {}", step, kLeastStep));
    validate(volume);
    auto data = std::make_shared<VoxelGrid::Data>();
    data->options = options;
    data->set_tree(nano_tree(volume, options.interpolation == Interpolation::linear), of_part);
    data->world_corner = volume.world_from_index(data->corner);
    data->local_from_world = inverse(volume.world_from_index.linear);
    return VoxelGrid(std::move(data));
}

}  // namespace

VoxelGrid voxel_grid(const Volume& volume, const VoxelGridOptions& options) {
    return grid_of(volume, options, false);
}

VoxelGrid reference::voxel_grid_of_part(const Volume& volume) { return grid_of(volume, {}, true); }

double optical_depth(const VoxelGrid& grid, Vec3d origin, Vec3d direction) {
    check_ray(origin, direction);
    return depth_along(grid.data(), origin, direction);
}

double optical_depth(const LevelGrids& levels, Vec3d origin, Vec3d direction) {
    check_ray(origin, direction);
    return depth_along(levels.data(), origin, direction);
}

DepthImage render_reference(std::span<const VoxelGrid> grids, const Camera& camera, int width,
                            int height, const ReferenceOptions& options) {
    std::vector<DepthGrid> constant;
    for (const VoxelGrid& grid : grids)
        if (grid.data().options.interpolation == Interpolation::constant)
            constant.emplace_back(grid.data());
    const CameraFrame frame = frame_of(camera, width, height);
    if (constant.size() == grids.size())
        if (const DividedGrids<DepthGrid> parts(constant, frame, options); !parts.boxes.empty()) {
            const auto add_ray = [](const DepthGrid& grid, Vec3d origin, Vec3d direction,
                                    FirstRelative& pixel) {
                pixel.sums.column += depth_along(grid.data(), origin, direction);
            };
            DepthImage image(width, height);
            parts.for_each_pixel(frame, 0, height, options.progress, add_ray,
                                 [&](int column, int row, const FirstRelative& pixel) {
                                     image.at(column, row) = static_cast<float>(pixel.sums.column);
                                 });
            return image;
        }
    const auto depth = [&](Vec3d origin, Vec3d direction, Segment within) {
        double sum = 0;
        for (const VoxelGrid& grid : grids)
            sum += depth_along(grid.data(), origin, direction, within);
        return sum;
    };
    return render_rays(depth, camera, width, height, options);
}

DepthImage render_reference(const LevelGrids& levels, const Camera& camera, int width, int height,
                            const ReferenceOptions& options) {
    const auto depth = [&](Vec3d origin, Vec3d direction, Segment within) {
        return depth_along(levels.data(), origin, direction, within);
    };
    return render_rays(depth, camera, width, height, options);
}

}  // namespace vog
