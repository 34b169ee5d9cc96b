// linear_volume.h: A volume and a scalar field, trilinear between voxel centres, sampled along rays.
#pragma once

#include <optional>

#include "render/reference/linear_block.h"
#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"
#include "vog/voxel_field.h"

namespace vog::reference {

/// Density between voxel centres, inactive voxels being 0, and a field: the density itself plus its background, or the mean of the active
/// voxels around a point by their trilinear weights.
class LinearVolume {
  public:
    /// field   whose component without leaves and tiles is the volume's own values
    /// voxels  step_voxels > 0: spacing of samples
    /// throws  vog::Error for a step of 0, and as voxel_grid does
    LinearVolume(const Volume& volume, const VoxelField& field, const VoxelGridOptions& voxels);

    bool own() const { return !parts_; }

    /// The field at a point.
    struct Sample {
        double density = 0, value = 0;
        Vec3d gradient;  ///< of the interpolated field, per voxel
    };
    /// Gradient per world unit.
    Vec3d world_gradient(const Sample& sample) const {
        return transpose(density_.data().local_from_world) * sample.gradient;
    }

    /// Calls visit(Sample, t, dt) at the middles of equal steps of the ray, front to back, wherever an active voxel is near,
    /// until it returns false.
    template <class Visit>
    void walk(Vec3d origin, Vec3d direction, Segment within, Visit&& visit) const {
        const VoxelGrid::Data& grid = density_.data();
        const GridRay ray = grid.center_ray(origin, direction);
        const auto& box = grid.tree.root().bbox();
        const Vec3d size{double(box.dim()[0]), double(box.dim()[1]), double(box.dim()[2])};
        const Segment whole = clip(ray, {0, 0, 0}, size, within);
        if (whole.empty()) return;
        const double interval = whole.last - whole.first;
        const double steps = std::ceil(interval * length(ray.direction) / grid.options.step_voxels);
        march_in_order(grid.root_cells, ray,
                       Walk<Visit>{*this, ray, {whole.first, interval / steps}, visit}, whole);
    }

  private:
    template <class Visit>
    struct Walk {
        const LinearVolume& of;
        const GridRay& ray;
        Midpoints steps;
        Visit& visit;
        bool goes_on = true;

        void leaf(const NanoLeaf&, Vec3d lower, Segment segment) { block(lower, segment); }
        void tile(Vec3d lower, int edge, float, Segment segment) {
            for_each_block(ray, lower, edge, segment,
                           [&](Vec3d at, Segment part) { block(at, part); });
        }
        void block(Vec3d lower, Segment segment) {
            const double end = steps.first(segment.last);
            double k = steps.first(segment.first);
            if (!goes_on || !(k < end)) return;
            const Vec3d index = lower + of.density_.data().corner;
            const auto block_of = [&](const VoxelGrid& grid) {
                return Block(grid.data().tree.root(), index, lower);
            };
            const Block density = block_of(of.density_);
            std::optional<Block> weighted, weight;
            if (of.parts_)
                weighted.emplace(block_of(of.parts_->weighted)),
                    weight.emplace(block_of(of.parts_->weight));
            for (; k < end && goes_on; ++k) {
                const double t = steps.start + (k + 0.5) * steps.spacing;
                const Vec3d point = ray.origin + t * ray.direction;
                const Block::Cell at = density.at(point);
                if (!of.parts_) {
                    const double value = at.value();
                    goes_on = visit(Sample{value, value + of.background_, at.gradient()}, t,
                                    steps.spacing);
                } else if (const Block::Cell near = weight->at(point); near.value() > 0) {
                    goes_on =
                        visit(of.mean(at.value(), weighted->at(point), near), t, steps.spacing);
                }
            }
        }
    };
    Sample mean(double density, const Block::Cell& weighted, const Block::Cell& weight) const {
        const double by = 1 / weight.value(), share = by * weighted.value();
        return {density, parts_->lower + parts_->range * share,
                (parts_->range * by) * (weighted.gradient() - share * weight.gradient())};
    }

    /// A field that is not the density: shares of its range, and 1, at active voxels.
    struct Parts {
        double lower, range;
        VoxelGrid weighted, weight;
    };
    VoxelGrid density_;
    std::optional<Parts> parts_;
    double background_;  ///< value of the density itself as a field where the density is 0
};

}  // namespace vog::reference
