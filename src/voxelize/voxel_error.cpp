// voxel_error.cpp: difference between two volumes of one lattice, voxel by voxel.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/paging.h"
#include "vog/error.h"
#include "vog/voxelize.h"

namespace vog {

namespace {

using Origin = std::tuple<int, int, int>;
Origin origin_of(Vec3i v) { return {v.x, v.y, v.z}; }

/// Sums of the differences.
struct ErrorSums {
    double squares = 0, absolute = 0, worst = 0;
    void add(double difference, double count = 1) {
        squares += count * difference * difference;
        absolute += count * std::abs(difference);
        worst = std::max(worst, std::abs(difference));
    }
};

/// Tiles of a volume by their origin, and the voxels of each that leaves of the other volume cover.
class TileMap {
  public:
    explicit TileMap(const Volume& volume) {
        for (const Tile& tile : volume.tiles)
            tiles_[{tile.edge, origin_of(tile.origin)}] = {tile.value, 0, 0};
    }
    /// Tiles of the other volume.
    /// throws  vog::Error for one where this volume has none of its size
    void compare(const Volume& other) {
        for (const Tile& tile : other.tiles) {
            const auto found = tiles_.find({tile.edge, origin_of(tile.origin)});
            if (found == tiles_.end())
                throw Error(fmt::format(
                    "{}: a tile of {}^3 voxels at {}, {}, {}, expected leaves or tiles of the "
                    "reference",
                    other.source, tile.edge, tile.origin.x, tile.origin.y, tile.origin.z));
            found->second.other = tile.value;
        }
    }
    /// Density at the node of this origin, which lies in one tile or in none; counts the voxels as covered.
    double cover(Vec3i origin, double voxels) {
        for (const int edge : {8, 128, 4096}) {
            const Vec3i corner{origin.x & -edge, origin.y & -edge, origin.z & -edge};
            const auto found = tiles_.find({edge, origin_of(corner)});
            if (found == tiles_.end()) continue;
            found->second.covered += voxels;
            return found->second.value;
        }
        return 0;
    }
    /// Adds the voxels that nothing of the other volume covers.
    void add_rest(ErrorSums& sums) const {
        for (const auto& [place, tile] : tiles_) {
            const double edge = place.first;
            if (tile.covered < edge * edge * edge)
                sums.add(tile.other - tile.value, edge * edge * edge - tile.covered);
        }
    }
    bool empty() const { return tiles_.empty(); }

  private:
    struct Entry {
        double value = 0, other = 0, covered = 0;  ///< densities here and there; number of voxels
    };
    std::map<std::pair<int, Origin>, Entry> tiles_;
};

}  // namespace

VoxelError voxel_error(const Volume& a, const Volume& b) {
    if (!(a.world_from_index == b.world_from_index))
        throw Error(fmt::format("{} and {}: different lattices of voxels, expected one", a.source,
                                b.source));
    double largest = 0, squares = 0;
    for (const Leaf& leaf : a.leaves)
        for (const float value : leaf.value) {
            largest = std::max(largest, double{value});
            squares += double{value} * value;
        }
    for (const Tile& tile : a.tiles) {
        largest = std::max(largest, double{tile.value});
        squares += std::pow(tile.edge, 3.0) * tile.value * tile.value;
    }
    if (!(largest > 0))
        throw Error(fmt::format("{}: all densities are 0, expected one above", a.source));

    // Both are sorted by origin: one pass over the two.
    ErrorSums sums;
    TileMap tiles(a);
    tiles.compare(b);
    std::size_t n = 0, m = 0;
    while (n < a.leaves.size() || m < b.leaves.size()) {
        const bool of_a =
            n < a.leaves.size() && (m == b.leaves.size() ||
                                    origin_of(a.leaves[n].origin) <= origin_of(b.leaves[m].origin));
        const bool of_b =
            m < b.leaves.size() && (n == a.leaves.size() ||
                                    origin_of(b.leaves[m].origin) <= origin_of(a.leaves[n].origin));
        const double tile = of_a ? 0 : tiles.cover(b.leaves[m].origin, kLeafVoxels);
        for (std::size_t voxel = 0; voxel < kLeafVoxels; ++voxel)
            sums.add((of_b ? double{b.leaves[m].value[voxel]} : 0) -
                     (of_a ? double{a.leaves[n].value[voxel]} : tile));
        n += of_a, m += of_b;
        keep_memory_at(n + m);
    }
    tiles.add_rest(sums);
    const auto voxels = static_cast<double>(active_voxels(a));
    VoxelError error;
    error.relative_l2 = std::sqrt(sums.squares / squares);
    error.psnr_db = 20 * std::log10(largest) - 10 * std::log10(sums.squares / voxels);
    error.mean = sums.absolute / voxels / largest;
    error.worst = sums.worst / largest;
    return error;
}

}  // namespace vog
