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
    /// Differences of other voxels, `weight` times as large as one that counts 1.
    void join(const ErrorSums& other, double weight) {
        squares += weight * other.squares;
        absolute += weight * other.absolute;
        worst = std::max(worst, other.worst);
    }
};

/// Sums over the voxels of a reference.
struct ReferenceSums {
    double largest = 0, squares = 0;
};
ReferenceSums reference_sums(const Volume& volume) {
    ReferenceSums sums;
    for (const Leaf& leaf : volume.leaves)
        for (const float value : leaf.value) {
            sums.largest = std::max(sums.largest, double{value});
            sums.squares += double{value} * value;
        }
    for (const Tile& tile : volume.tiles) {
        sums.largest = std::max(sums.largest, double{tile.value});
        sums.squares += std::pow(tile.edge, 3.0) * tile.value * tile.value;
    }
    return sums;
}

/// voxels  number of active voxels of the reference, or their volume
VoxelError error_of(const ErrorSums& sums, const ReferenceSums& reference, double voxels) {
    VoxelError error;
    error.relative_l2 = std::sqrt(sums.squares / reference.squares);
    error.psnr_db = 20 * std::log10(reference.largest) - 10 * std::log10(sums.squares / voxels);
    error.mean = sums.absolute / voxels / reference.largest;
    error.worst = sums.worst / reference.largest;
    return error;
}

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
        const auto found = tile_at(origin);
        if (found == tiles_.end()) return 0;
        found->second.covered += voxels;
        return found->second.value;
    }
    /// Whether a tile holds the node of this origin.
    bool holds(Vec3i origin) { return tile_at(origin) != tiles_.end(); }
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
    using Tiles = std::map<std::pair<int, Origin>, Entry>;
    Tiles::iterator tile_at(Vec3i origin) {
        for (const int edge : {8, 128, 4096}) {
            const Vec3i corner{origin.x & -edge, origin.y & -edge, origin.z & -edge};
            const auto found = tiles_.find({edge, origin_of(corner)});
            if (found != tiles_.end()) return found;
        }
        return tiles_.end();
    }
    Tiles tiles_;
};

/// Differences of all voxels. Leaves of both are sorted by origin: one pass over the two.
ErrorSums differences(const Volume& a, const Volume& b) {
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
    return sums;
}

/// Sets voxels of `volume`, which has no tiles, to 0 where those of `part` are not active.
void keep_active(Volume& volume, const Volume& part) {
    TileMap tiles(part);
    auto own = part.leaves.begin();
    std::erase_if(volume.leaves, [&](Leaf& leaf) {
        while (own != part.leaves.end() && origin_of(own->origin) < origin_of(leaf.origin)) ++own;
        if (own == part.leaves.end() || own->origin != leaf.origin)
            return !tiles.holds(leaf.origin);
        for (int n = 0; n < kLeafVoxels; ++n)
            if (!own->active(n)) leaf.value[static_cast<std::size_t>(n)] = 0;
        return false;
    });
}

}  // namespace

VoxelError voxel_error(const Volume& a, const Volume& b) {
    if (!(a.world_from_index == b.world_from_index))
        throw Error(fmt::format("{} and {}: different lattices of voxels, expected one", a.source,
                                b.source));
    const ReferenceSums reference = reference_sums(a);
    if (!(reference.largest > 0))
        throw Error(fmt::format("{}: all densities are 0, expected one above", a.source));
    return error_of(differences(a, b), reference, static_cast<double>(active_voxels(a)));
}

VoxelError voxel_error(std::span<const Volume> parts, const Gaussians& model) {
    ErrorSums sums;
    ReferenceSums reference;
    double volume = 0;
    for (const Volume& part : parts) {
        const double voxel = std::abs(determinant(part.world_from_index.linear));
        const ReferenceSums own = reference_sums(part);
        reference.largest = std::max(reference.largest, own.largest);
        reference.squares += voxel * own.squares;
        volume += voxel * static_cast<double>(active_voxels(part));
        VoxelizeOptions options;
        options.extent = active_box(part);
        Volume sampled = voxelize(model, part.world_from_index, options).volume;
        keep_active(sampled, part);
        sums.join(differences(part, sampled), voxel);
    }
    if (!(reference.largest > 0))
        throw Error(fmt::format("{}: all densities are 0, expected one above",
                                parts.empty() ? "no volume" : parts.front().source));
    return error_of(sums, reference, volume);
}

}  // namespace vog
