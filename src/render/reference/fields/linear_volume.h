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
    struct Gradients;

  public:
    /// field   whose component without leaves and tiles is the volume's own values
    /// voxels  step_voxels > 0: spacing of samples
    /// throws  vog::Error for a step of 0, and as voxel_grid does
    LinearVolume(const Volume& volume, const VoxelField& field, const VoxelGridOptions& voxels);

    bool own() const { return !parts_; }

    /// The field at a point.
    class Sample {
      public:
        Sample(const Block::Cell& own, Gradients& gradients)
            : density(own.value()),
              value(density + gradients.of.background_),
              cell_(own),
              gradients_(gradients) {}
        Sample(double own, const Block::Cell& weighted, const Block::Cell& weight,
               Gradients& gradients)
            : density(own),
              value(gradients.of.parts_->lower +
                    gradients.of.parts_->range * weighted.value() / weight.value()),
              cell_(weighted),
              weight_(weight),
              gradients_(gradients) {}

        double density, value;

        /// Of the field, per world unit.
        Vec3d gradient() const {
            const LinearVolume& of = gradients_.of;
            const auto& parts = of.parts_;
            Vec3d per_voxel =
                gradients_.at(parts ? parts->weighted : of.density_, gradients_.own, cell_);
            if (parts) {
                const Vec3d of_weight = gradients_.at(parts->weight, gradients_.weight, *weight_);
                const double by = 1 / weight_->value();
                per_voxel = (parts->range * by) * (per_voxel - by * cell_.value() * of_weight);
            }
            return transpose(of.density_.data().local_from_world) * per_voxel;
        }

      private:
        Block::Cell cell_;
        std::optional<Block::Cell> weight_;
        Gradients& gradients_;
    };

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
            Gradients gradients{of, lower + of.density_.data().corner, {}, {}};
            const auto block_of = [&](const VoxelGrid& grid) {
                return Block(grid.data().tree.root(), gradients.index, lower);
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
                    goes_on = visit(Sample(at, gradients), t, steps.spacing);
                } else if (const Block::Cell near = weight->at(point); near.value() > 0) {
                    goes_on = visit(Sample(at.value(), weighted->at(point), near, gradients), t,
                                    steps.spacing);
                }
            }
        }
    };

    /// Gradients in a block of 8^3 voxels, of the density, or of parts; made where the first light needs one.
    struct Gradients {
        const LinearVolume& of;
        Vec3d index;  ///< of the block's first voxel
        std::optional<BlockGradient> own, weight;

        Vec3d at(const VoxelGrid& grid, std::optional<BlockGradient>& made,
                 const Block::Cell& cell) const {
            if (!made) made.emplace(grid.data().tree.root(), index);
            return (*made)(cell);
        }
    };

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
