// field_sampler.h: values of a field's grid at the voxels of a volume.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/fields/field_grid.h"
#include "vog/volume.h"

namespace vog::field_files {

/// Values at the active voxels of one leaf.
struct LeafSamples {
    std::array<std::array<float, kLeafVoxels>, 3> value{};  ///< [component], 0 where not active
    std::array<std::uint64_t, 8> covered{};  ///< bits: the grid is active at the voxel's centre
};

/// Values in one tile.
struct TileSample {
    bool varies = false;
    std::array<float, 3> value{};  ///< [component], where it does not vary
    double covered = 0;            ///< share of the tile where the grid is active, [0, 1]
};

/// Reads a grid at the voxels of a volume, whatever the type of its values.
class FieldSampler {
  public:
    virtual ~FieldSampler() = default;
    virtual std::size_t components() const = 0;  ///< 1 or 3
    /// Samples leaves one by one. Several threads may do so at once.
    /// receive  called with the index in `leaves` and the samples of each
    virtual void leaves(
        std::span<const Leaf> leaves,
        const std::function<void(std::size_t, const LeafSamples&)>& receive) const = 0;
    /// Values in the cube of edge^3 voxels at `origin`.
    virtual TileSample tile(Vec3i origin, std::int32_t edge) const = 0;
};

/// Sampler of a grid, which must outlive it.
/// volume  defines the lattice and its extent
/// throws  vog::Error for a grid that holds neither numbers nor vectors
std::unique_ptr<FieldSampler> make_sampler(const FieldGrid& field, const Volume& volume);

/// Samples a grid at the voxels of a volume, whose tiles are divided where it varies: read_field without the
/// file.
VoxelField sampled_field(const FieldGrid& grid, Volume& volume, std::span<VoxelField> others,
                         std::vector<std::string>* notes, FieldCoverage* coverage = nullptr);

}  // namespace vog::field_files
