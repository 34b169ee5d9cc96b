// level_clip.h: how much of a level's voxels is to be seen, past the levels that hide it.
#pragma once

#include <span>
#include <vector>

#include "data/levels/voxel_lookup.h"

namespace vog {

/// Voxels that hide a level, or outside of which it does not count, in that level's index space.
struct ClipRegion {
    const VoxelLookup* voxels = nullptr;
    bool keeps = false;         ///< true: the level counts inside; false: it is hidden inside
    Affine from_level;          ///< region's index from level's index
    bool parallel = false;      ///< the axes of both lattices are parallel, in any order
    std::array<int, 3> axis{};  ///< parallel: the region's axis along each axis of the level
    std::array<double, 3> ratio{1, 1, 1};  ///< voxels of the region along each edge of the level's
};
ClipRegion clip_region(const VoxelLookup& voxels, bool keeps, const Affine& world_from_region,
                       const Affine& world_from_level);

/// What the regions say of a box of whole voxels.
struct Clip {
    bool hidden = false;                 ///< nothing of it is seen; else
    std::vector<const ClipRegion*> cut;  ///< those it may be divided by; none: all of it is seen
};
Clip clip_box(std::span<const ClipRegion* const> regions, Vec3i lower, Vec3i upper);

/// Into how many pieces along each edge a voxel is to be divided that `regions` cut through: as
/// many as fit the finest lattice, 1 to 8.
/// somewhere  an index of the level, near which lattices are compared
int clip_pieces(std::span<const ClipRegion> regions, Vec3d somewhere);

/// Divides voxels into pieces^3 equal boxes and finds the share of each that is seen.
class VoxelClipper {
  public:
    explicit VoxelClipper(int pieces);
    /// returns the shares, x-major; valid until the next call
    std::span<const double> shares(Vec3i voxel, std::span<const ClipRegion* const> cut);

  private:
    /// A slice of the voxel along an axis, from its lower face on, in its edges.
    struct Slice {
        double middle, width;
        int piece;
    };
    void slice(Vec3i voxel, std::span<const ClipRegion* const> cut, int axis);

    int pieces_;
    std::array<std::vector<Slice>, 3> slices_;
    std::vector<double> planes_, shares_;
};

}  // namespace vog
