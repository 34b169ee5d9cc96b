// soft_division.cpp: shares of voxels by the densities of Gaussians, as the E step has them.
#include "convert/fields/soft_division.h"

#include <cmath>
#include <utility>

#include "convert/moments/periodic_lattice.h"
#include "core/paging.h"

namespace vog::joint {

namespace {

using moments::PackedCells;

/// The model's Gaussians as distributions in a volume's index space: covariance after the cut.
PackedCells cells_of(const Gaussians& model, const Volume& volume,
                     std::span<const moments::Brick> bricks) {
    const Affine index_from_world = inverse(volume.world_from_index);
    const Mat3& back = index_from_world.linear;
    const double within = variance_within(model.cutoff), volume_of_voxel = voxel_volume(volume);
    PackedCells cells(bricks);
    cells.reserve(model.size());
    for (std::size_t i = 0; i < model.size(); ++i) {
        keep_memory_at(i);
        const std::array<double, 6> c = moments::kernel_covariance(model, i);
        const Mat3 world{{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, {c[2], c[4], c[5]}}};
        const Mat3 index = back * world * transpose(back);
        // Gaussians of a finer level may be smaller than this volume's voxels.
        const auto variance = [&](int axis) {
            return std::max(within * index(axis, axis), moments::kBoxVariance);
        };
        cells.push_back({mass(model, i) / volume_of_voxel,
                         index_from_world(world_mean(model, i)),
                         {variance(0), within * index(0, 1), within * index(0, 2), variance(1),
                          within * index(1, 2), variance(2)}});
    }
    return cells;
}

}  // namespace

SoftDivision::SoftDivision(const Gaussians& model, const Volume& volume,
                           const std::optional<Box>& period,
                           std::optional<ValueLikelihood> likelihood)
    : field_bricks_(field_bricks(volume)), likelihood_(std::move(likelihood)) {
    for (const FieldBrick& brick : field_bricks_) bricks_.push_back(brick.brick);
    cells_ = cells_of(model, volume, bricks_);
    solver_.emplace(bricks_, moments::image_shifts(period, volume.world_from_index));
}

void SoftDivision::add(std::size_t width, const PartsOfBrick& parts_of,
                       std::span<double> sums) const {
    solver_->add_shares(
        cells_, width,
        [&](std::size_t b, std::span<const std::uint32_t> gaussian, moments::BrickScratch& scratch,
            std::span<double> parts) {
            std::vector<moments::UncoveredSample> uncovered;
            std::function<void(moments::BrickScratch&)> weigh;
            if (likelihood_)
                weigh = [&](moments::BrickScratch& values) {
                    likelihood_->weigh(field_bricks_[b], gaussian, values);
                };
            moments::divide_samples(bricks_[b], scratch, weigh, uncovered);
            parts_of({&field_bricks_[b], &scratch, uncovered}, gaussian, parts);
        },
        sums);
}

}  // namespace vog::joint
