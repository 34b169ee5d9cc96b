// level_clip.h: visible share of a level's voxels, clipped by masks and finer levels.
#pragma once

#include <span>
#include <vector>

#include "data/levels/voxel_lookup.h"

namespace vog {

/// Region that clips a level: inside a finer level it is hidden, outside its own mask too.
struct ClipRegion {
    const VoxelLookup* voxels = nullptr;
    bool keeps = false;         ///< true: the level is visible inside; false: it is hidden inside
    Affine from_level;          ///< region's index from level's index
    bool parallel = false;      ///< the axes of both lattices are parallel, in any order
    std::array<int, 3> axis{};  ///< if parallel: region's axis along each axis of the level
    std::array<double, 3> ratio{1, 1, 1};  ///< level's voxel edge in voxels of the region, per axis
};
ClipRegion clip_region(const VoxelLookup& voxels, bool keeps, const Affine& world_from_region,
                       const Affine& world_from_level);

/// Result of clipping a box of whole voxels.
struct Clip {
    bool hidden = false;                 ///< no part is visible
    std::vector<const ClipRegion*> cut;  ///< regions whose faces may cut it; empty: all visible
};
/// Clips the level's voxels lower to upper, both included.
Clip clip_box(std::span<const ClipRegion* const> regions, Vec3i lower, Vec3i upper);

/// Pieces along each edge into which a cut voxel is divided: enough to fit the finest lattice.
/// somewhere  index of the level near which lattices are compared
/// returns    1 to 8
int clip_pieces(std::span<const ClipRegion> regions, Vec3d somewhere);

/// Divides voxels into pieces^3 equal boxes and computes the visible share of each one's volume.
class VoxelClipper {
  public:
    explicit VoxelClipper(int pieces);
    /// returns  shares in [0, 1], [pieces]^3 with x slowest; valid until the next call
    std::span<const double> shares(Vec3i voxel, std::span<const ClipRegion* const> cut);

  private:
    /// Slice of the voxel perpendicular to an axis; lengths in voxel edges from its lower face.
    struct Slice {
        double middle, width;
        int piece;  ///< piece along the axis that holds it
    };
    void slice(Vec3i voxel, std::span<const ClipRegion* const> cut, int axis);

    int pieces_;
    std::array<std::vector<Slice>, 3> slices_;
    std::vector<double> planes_, shares_;
};

}  // namespace vog
