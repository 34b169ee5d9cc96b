// slice_voxels.cpp: Voxels on a plane: those that hold the points of pixels.
#include <algorithm>
#include <cmath>
#include <deque>

#include "data/levels/voxel_lookup.h"
#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/reference_grid.h"
#include "render/shown_field.h"
#include "render/slice/slice.h"
#include "render/slice/slice_points.h"
#include "vog/error.h"

namespace vog {

using namespace slices;

namespace {

/// Voxel that holds a point. Points on a face, to rounding, count in the voxel above it.
Vec3i voxel_of(const Affine& index_from_world, Vec3d point) {
    constexpr double kFar = 1 << 30, kRounding = 1e-7;
    const Vec3d index = index_from_world(point);
    Vec3i voxel;
    for (int axis = 0; axis < 3; ++axis)
        voxel[axis] = static_cast<std::int32_t>(
            std::floor(std::clamp(index[axis] + 0.5 + kRounding, -kFar, kFar)));
    return voxel;
}

/// Volumes with a field, and their voxels at points.
class VoxelsAt {
  public:
    /// fields  [set.volumes], or none
    VoxelsAt(const VolumeSet& set, std::span<const VoxelField> fields, FieldPart part)
        : set_(set), fields_(fields), part_(part) {
        if (!fields.empty()) reference::check_fields(set.volumes, fields, part);
        for (const Volume& volume : set.volumes) {
            from_world_.push_back(inverse(volume.world_from_index));
            voxels_.emplace_back(volume);
        }
        if (!set.is_mesh()) return;
        order_ = finest_first(set.volumes);
        for (const Volume& mask : set.masks) {
            mask_from_world_.push_back(inverse(mask.world_from_index));
            masks_.emplace_back(mask);
        }
    }

    /// Adds what lies at a point.
    /// towards  direction of the ray, unit length
    void add(Vec3d point, Vec3d towards, device::FirstRelative& to) const {
        if (!set_.is_mesh()) {
            for (std::size_t n = 0; n < voxels_.size(); ++n) add_volume(n, point, towards, to);
            return;
        }
        for (const std::size_t n : order_) {
            if (masks_.empty()) {
                if (add_volume(n, point, towards, to)) return;
            } else if (masks_[n].active(voxel_of(mask_from_world_[n], point))) {
                add_volume(n, point, towards, to);
                return;
            }
        }
    }

  private:
    /// returns  whether a voxel of the volume is active there
    bool add_volume(std::size_t n, Vec3d point, Vec3d towards, device::FirstRelative& to) const {
        const Vec3i index = voxel_of(from_world_[n], point);
        const VoxelLookup::Block block = voxels_[n].find(index);
        const int offset = VoxelLookup::offset_of(index);
        if (!block.tile && !(block.leaf && block.leaf->active(offset))) return false;
        const float density =
            block.tile ? block.tile->value : block.leaf->value[static_cast<std::size_t>(offset)];
        const double value =
            fields_.empty() ? 0 : value_at(n, block, offset, towards, double{density});
        to.add(double{std::max(density, kLeastDensity)}, value);
        return true;
    }
    double value_at(std::size_t n, const VoxelLookup::Block& block, int offset, Vec3d towards,
                    double density) const {
        const VoxelField& field = fields_[n];
        if (reference::is_own(field)) return density + field.background;
        const Volume& volume = set_.volumes[n];
        const auto component = [&](int c) {
            const VoxelValues& values = field.component[static_cast<std::size_t>(c)];
            if (block.tile)
                return double{
                    values.tile[static_cast<std::size_t>(block.tile - volume.tiles.data())]};
            const auto leaf = static_cast<std::size_t>(block.leaf - volume.leaves.data());
            return double{values.leaf[leaf][static_cast<std::size_t>(offset)]};
        };
        if (part_ == FieldPart::view)
            return dot(towards, Vec3d{component(0), component(1), component(2)});
        return component(part_ == FieldPart::y ? 1 : part_ == FieldPart::z ? 2 : 0);
    }

    const VolumeSet& set_;
    std::span<const VoxelField> fields_;
    FieldPart part_;
    std::vector<Affine> from_world_, mask_from_world_;
    std::deque<VoxelLookup> voxels_, masks_;  ///< [volumes]
    std::vector<std::size_t> order_;          ///< of levels, finest first
};

}  // namespace

FieldMaps slice_voxels(std::span<const VolumeSet* const> sets,
                       std::span<const std::span<const VoxelField>> fields, FieldPart part,
                       const Camera& camera, int width, int height, const SliceOptions& options) {
    if (part == FieldPart::magnitude)
        return magnitude_maps(options.progress, [&](FieldPart one, const Progress& progress) {
            SliceOptions of_one = options;
            of_one.progress = progress;
            return slice_voxels(sets, fields, one, camera, width, height, of_one);
        });
    reference::check_samples(options.samples);
    validate(options.clip);
    const CameraFrame frame = frame_of(camera, width, height);
    const SlicePoints points(frame, options.plane, options.clip);
    std::deque<VoxelsAt> parts;
    for (std::size_t n = 0; n < sets.size(); ++n)
        parts.emplace_back(*sets[n], fields.empty() ? std::span<const VoxelField>{} : fields[n],
                           part);
    FieldMaps maps = empty_maps(width, height);
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        device::FirstRelative pixel;
        for (int n = 0; n < samples * samples; ++n) {
            const double x = column + reference::sample_offset(n % samples, samples);
            const double y = row + reference::sample_offset(n / samples, samples);
            if (const auto point = points.at(x, y))
                for (const VoxelsAt& voxels : parts)
                    voxels.add(*point, normalized(frame.direction(x, y)), pixel);
        }
        set_pixel(maps,
                  static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column),
                  pixel.sums,
                  std::max(pixel.sums.column / (samples * samples),
                           pixel.met ? double{kLeastDensity} : 0.0),
                  pixel.reference, 1);
    });
    return maps;
}

}  // namespace vog
