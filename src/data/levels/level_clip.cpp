// level_clip.cpp: visible volume of voxels cut by the faces of other lattices.
// If lattices are parallel, the faces of all regions divide a voxel into boxes, and each box is
// visible exactly if its centre is: volumes are exact for any ratio and offset, also where regions
// overlap. Otherwise 16^3 equal boxes sample the voxel.
#include "data/levels/level_clip.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace vog {

namespace {

/// Offsets below this are rounding: transforms are often stored as float32.
constexpr double kSnap_voxels = 1e-4;
/// Slices per axis of a voxel if lattices are not parallel.
constexpr int kSamples = 16;
constexpr int kMostPieces = 8;

/// Index of the voxel that holds a coordinate, clamped to +-2^30.
std::int32_t voxel_at(double coordinate) {
    constexpr double kFar = 1 << 30;
    return static_cast<std::int32_t>(std::floor(std::clamp(coordinate + 0.5, -kFar, kFar)));
}
Vec3i voxel_at(Vec3d point) { return {voxel_at(point.x), voxel_at(point.y), voxel_at(point.z)}; }

/// Region's voxels that overlap a box of the level's voxels; touching does not count.
struct IndexRange {
    Vec3i lower, upper;
};
IndexRange range_of(const ClipRegion& region, Vec3i lower, Vec3i upper) {
    const Vec3d half{0.5, 0.5, 0.5};
    const Box box = transformed(region.from_level,
                                {vec_cast<double>(lower) - half, vec_cast<double>(upper) + half});
    const Vec3d snap{kSnap_voxels, kSnap_voxels, kSnap_voxels};
    return {voxel_at(box.lower + snap), voxel_at(box.upper - snap)};
}

bool is_whole(double number) { return std::abs(number - std::round(number)) < kSnap_voxels; }

/// Whether each of the level's voxels is divided evenly into whole voxels of the region.
bool lattices_fit(const ClipRegion& region, Vec3d somewhere) {
    if (!region.parallel) return false;
    const Vec3d corner = vec_cast<double>(voxel_at(somewhere)) - Vec3d{0.5, 0.5, 0.5};
    const Vec3d at = region.from_level(corner);
    for (int axis = 0; axis < 3; ++axis)
        if (!is_whole(region.ratio[static_cast<std::size_t>(axis)]) || !is_whole(at[axis] + 0.5))
            return false;
    return true;
}

}  // namespace

ClipRegion clip_region(const VoxelLookup& voxels, bool keeps, const Affine& world_from_region,
                       const Affine& world_from_level) {
    ClipRegion region{&voxels, keeps, {}};
    // The difference of the translations first: far from the origin, this loses fewer digits.
    const Mat3 back = inverse(world_from_region.linear);
    region.from_level = {back * world_from_level.linear,
                         back * (world_from_level.translation - world_from_region.translation)};
    // Off-axis terms below this move a face by less than 1e-3 voxels over 1000 voxels.
    constexpr double kParallel = 1e-6;
    const Mat3& linear = region.from_level.linear;
    region.parallel = true;
    for (int column = 0; column < 3; ++column) {
        const Vec3d step = linear.column(column);
        int along = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (std::abs(step[axis]) > std::abs(step[along])) along = axis;
        for (int axis = 0; axis < 3; ++axis)
            region.parallel &=
                axis == along || std::abs(step[axis]) <= kParallel * std::abs(step[along]);
        region.axis[static_cast<std::size_t>(column)] = along;
        region.ratio[static_cast<std::size_t>(column)] = length(step);
    }
    return region;
}

Clip clip_box(std::span<const ClipRegion* const> regions, Vec3i lower, Vec3i upper) {
    Clip clip;
    for (const ClipRegion* region : regions) {
        const IndexRange range = range_of(*region, lower, upper);
        const bool outside = !region->voxels->meets(range.lower, range.upper);
        if (outside && !region->keeps) continue;
        const bool inside = !outside && region->voxels->covers(range.lower, range.upper);
        if (inside && region->keeps) continue;
        if (outside || inside) return {true, {}};
        clip.cut.push_back(region);
    }
    return clip;
}

int clip_pieces(std::span<const ClipRegion> regions, Vec3d somewhere) {
    bool fit = true;
    long pieces = 1;
    double finest = 1;
    for (const ClipRegion& region : regions) {
        fit = fit && lattices_fit(region, somewhere);
        for (const double ratio : region.ratio) {
            finest = std::max(finest, ratio);
            if (fit && pieces <= kMostPieces)
                pieces = std::lcm(pieces, std::max(1L, std::lround(ratio)));
        }
    }
    if (fit && pieces <= kMostPieces) return static_cast<int>(pieces);
    // Twice the finest lattice, so that visible mass is placed to half a fine voxel.
    if (finest >= kMostPieces / 2) return kMostPieces;
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(2 * finest))));
}

VoxelClipper::VoxelClipper(int pieces)
    : pieces_(pieces), shares_(static_cast<std::size_t>(pieces) * pieces * pieces) {}

void VoxelClipper::slice(Vec3i voxel, std::span<const ClipRegion* const> cut, int axis) {
    planes_.clear();
    for (int n = 0; n <= pieces_; ++n) planes_.push_back(static_cast<double>(n) / pieces_);
    const auto add = [&](double plane, double tolerance) {
        const double from_piece = plane * pieces_ - std::round(plane * pieces_);
        if (plane > 0 && plane < 1 && std::abs(from_piece) > tolerance * pieces_)
            planes_.push_back(plane);
    };
    for (const ClipRegion* region : cut) {
        if (!region->parallel) {
            for (int n = 1; n < kSamples; ++n) add(static_cast<double>(n) / kSamples, 0);
            continue;
        }
        // Faces are at integers + 1/2 of the region's index, which is `first` at the lower face
        // and changes by `step` along the edge.
        const int along = region->axis[static_cast<std::size_t>(axis)];
        const double step = region->from_level.linear(along, axis);
        const double first = region->from_level(vec_cast<double>(voxel))[along] - 0.5 * step;
        const double low = std::min(first, first + step), high = std::max(first, first + step);
        for (double face = std::ceil(low - 0.5) + 0.5; face <= high; ++face)
            add((face - first) / step, kSnap_voxels / std::abs(step));
    }
    std::sort(planes_.begin(), planes_.end());
    slices_[static_cast<std::size_t>(axis)].clear();
    for (std::size_t n = 0; n + 1 < planes_.size(); ++n) {
        const double width = planes_[n + 1] - planes_[n];
        if (width <= 0) continue;
        const double middle = planes_[n] + 0.5 * width;
        slices_[static_cast<std::size_t>(axis)].push_back(
            {middle, width, static_cast<int>(middle * pieces_)});
    }
}

std::span<const double> VoxelClipper::shares(Vec3i voxel, std::span<const ClipRegion* const> cut) {
    for (int axis = 0; axis < 3; ++axis) slice(voxel, cut, axis);
    std::fill(shares_.begin(), shares_.end(), 0.0);
    const Vec3d corner = vec_cast<double>(voxel) - Vec3d{0.5, 0.5, 0.5};
    const double piece_volume = 1.0 / (pieces_ * pieces_ * pieces_);
    for (const Slice& x : slices_[0])
        for (const Slice& y : slices_[1])
            for (const Slice& z : slices_[2]) {
                const Vec3d at = corner + Vec3d{x.middle, y.middle, z.middle};
                const bool visible =
                    std::all_of(cut.begin(), cut.end(), [&](const ClipRegion* region) {
                        return region->voxels->active(voxel_at(region->from_level(at))) ==
                               region->keeps;
                    });
                if (visible)
                    shares_[static_cast<std::size_t>((x.piece * pieces_ + y.piece) * pieces_ +
                                                     z.piece)] +=
                        x.width * y.width * z.width / piece_volume;
            }
    // A fully visible piece has share 1 exactly: the sum of its parts is rounded.
    for (double& share : shares_)
        if (share > 1 - 1e-9) share = 1;
    return shares_;
}

}  // namespace vog
