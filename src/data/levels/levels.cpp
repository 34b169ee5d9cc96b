// levels.cpp: composition of AMR levels into volumes that do not overlap.
#include "vog/levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "core/paging.h"
#include "core/parallel.h"
#include "data/levels/arrangement.h"
#include "data/levels/level_clip.h"
#include "vog/error.h"
#include "vog/units.h"

namespace vog {

namespace {

/// Visible part of one level: whole voxels, and pieces of cut ones.
struct LevelPart {
    Volume whole, pieces;
    std::uint64_t voxels = 0;         ///< active voxels with a visible part
    std::uint64_t hidden = 0;         ///< active voxels without one
    std::uint64_t partly_hidden = 0;  ///< visible ones that were cut
};

/// Clips one level by regions.
class LevelCut {
  public:
    LevelCut(const Volume& level, std::vector<ClipRegion> regions)
        : level_(level), regions_(std::move(regions)) {
        for (const ClipRegion& region : regions_) all_.push_back(&region);
        pieces_ = clip_pieces(regions_, index_box(level).center());
    }

    LevelPart cut() {
        LevelPart part;
        for (Volume* volume : {&part.whole, &part.pieces}) {
            volume->world_from_index = level_.world_from_index;
            volume->name = level_.name;
            volume->source = level_.source;
            volume->units = level_.units;
            volume->background = level_.background, volume->is_image = level_.is_image;
        }
        // Piece j of n along an edge has the level's index (j + 1/2)/n - 1/2.
        Affine& map = part.pieces.world_from_index;
        const double shift = 0.5 / pieces_ - 0.5;
        map.translation = map({shift, shift, shift});
        for (Vec3d& row : map.linear.row) row = (1.0 / pieces_) * row;

        // Reserved at once: growing copies the whole array.
        part.whole.leaves.reserve(level_.leaves.size());
        std::vector<Leaf> of_tiles;
        for (const Tile& tile : level_.tiles) cut_tile(tile, part, of_tiles);
        cut_leaves(level_.leaves, part);
        cut_leaves(of_tiles, part);
        sort_nodes(part.whole);
        sort_nodes(part.pieces);
        return part;
    }

  private:
    /// Keeps a tile, drops it, or divides it if a region cuts it: into smaller tiles, then leaves.
    void cut_tile(const Tile& tile, LevelPart& part, std::vector<Leaf>& leaves) const {
        const std::int32_t last = tile.edge - 1;
        const Clip clip = clip_box(all_, tile.origin, tile.origin + Vec3i{last, last, last});
        const auto voxels = static_cast<std::uint64_t>(tile.edge) *
                            static_cast<std::uint64_t>(tile.edge) *
                            static_cast<std::uint64_t>(tile.edge);
        if (clip.hidden) {
            part.hidden += voxels;
        } else if (clip.cut.empty()) {
            part.whole.tiles.push_back(tile);
            part.voxels += voxels;
        } else if (tile.edge == kLeafEdge) {
            Leaf& leaf = leaves.emplace_back();
            leaf.origin = tile.origin;
            leaf.mask.fill(~std::uint64_t{0});
            leaf.value.fill(tile.value);
        } else {
            const int edge = tile.edge == 128 ? 8 : 128;
            for (int x = 0; x < tile.edge; x += edge)
                for (int y = 0; y < tile.edge; y += edge)
                    for (int z = 0; z < tile.edge; z += edge)
                        cut_tile({tile.origin + Vec3i{x, y, z}, edge, tile.value}, part, leaves);
        }
    }

    struct LeafPart {
        Leaf whole;
        std::vector<Leaf> pieces;
        std::uint64_t voxels = 0, hidden = 0, partly_hidden = 0;
    };

    void cut_leaves(std::span<const Leaf> leaves, LevelPart& part) const {
        // Batches bound the memory held twice: a leaf and eight leaves of pieces are 19 kB.
        constexpr std::size_t kBatch = 512;
        std::vector<LeafPart> cut;
        for (std::size_t first = 0; first < leaves.size(); first += kBatch) {
            cut.assign(std::min(kBatch, leaves.size() - first), {});
            vog::parallel_for(std::size_t{0}, cut.size(),
                              [&](std::size_t n) { cut_leaf(leaves[first + n], cut[n]); });
            for (LeafPart& leaf : cut) {
                keep_memory();
                if (leaf.whole.active_count() > 0) part.whole.leaves.push_back(leaf.whole);
                part.pieces.leaves.insert(part.pieces.leaves.end(), leaf.pieces.begin(),
                                          leaf.pieces.end());
                part.voxels += leaf.voxels;
                part.hidden += leaf.hidden;
                part.partly_hidden += leaf.partly_hidden;
            }
        }
    }

    void cut_leaf(const Leaf& leaf, LeafPart& part) const {
        const Clip around = clip_box(all_, leaf.origin, leaf.origin + Vec3i{7, 7, 7});
        part.whole.origin = leaf.origin;
        if (!around.hidden && around.cut.empty()) {
            part.whole = leaf;
            part.voxels = static_cast<std::uint64_t>(leaf.active_count());
            return;
        }
        if (around.hidden) {
            part.hidden = static_cast<std::uint64_t>(leaf.active_count());
            return;
        }
        VoxelClipper clipper(pieces_);
        std::vector<int> place(static_cast<std::size_t>(pieces_ * pieces_ * pieces_), -1);
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const float value = leaf.value[static_cast<std::size_t>(n)];
            const Vec3i local{n >> 6, n >> 3 & 7, n & 7}, voxel = leaf.origin + local;
            const Clip clip = clip_box(around.cut, voxel, voxel);
            std::span<const double> shares;
            double visible = clip.hidden ? 0 : 1;
            if (!clip.hidden && !clip.cut.empty()) {
                shares = clipper.shares(voxel, clip.cut);
                visible = std::accumulate(shares.begin(), shares.end(), 0.0) /
                          static_cast<double>(shares.size());
            }
            ++(visible > 0 ? part.voxels : part.hidden);
            if (visible >= 1)
                part.whole.set(n, value);
            else if (visible > 0)
                add_pieces(leaf.origin, local, value, shares, place, part);
        }
    }

    /// Adds the visible pieces of one voxel, their density scaled by `shares`.
    /// local  voxel in its leaf
    /// place  [pieces^3], index in part.pieces of each leaf of pieces in this leaf; -1: none yet
    void add_pieces(Vec3i leaf_origin, Vec3i local, float value, std::span<const double> shares,
                    std::vector<int>& place, LeafPart& part) const {
        ++part.partly_hidden;
        for (int n = 0; n < pieces_ * pieces_ * pieces_; ++n) {
            const double share = shares[static_cast<std::size_t>(n)];
            if (share <= 0) continue;
            const Vec3i piece = pieces_ * local +
                                Vec3i{n / (pieces_ * pieces_), n / pieces_ % pieces_, n % pieces_};
            const Vec3i in{piece.x >> 3, piece.y >> 3, piece.z >> 3};
            int& at = place[static_cast<std::size_t>((in.x * pieces_ + in.y) * pieces_ + in.z)];
            if (at < 0) {
                at = static_cast<int>(part.pieces.size());
                part.pieces.emplace_back().origin = pieces_ * leaf_origin + kLeafEdge * in;
            }
            part.pieces[static_cast<std::size_t>(at)].set(
                leaf_offset(piece.x & 7, piece.y & 7, piece.z & 7),
                static_cast<float>(value * share));
        }
    }

    const Volume& level_;
    std::vector<ClipRegion> regions_;
    std::vector<const ClipRegion*> all_;
    int pieces_ = 1;
};

}  // namespace

void validate(const Levels& levels) {
    if (levels.volumes.empty()) throw Error("levels: no volume, expected at least one");
    if (!levels.masks.empty() && levels.masks.size() != levels.volumes.size())
        throw Error(fmt::format("levels: {} masks for {} volumes, expected one for each, or none",
                                levels.masks.size(), levels.volumes.size()));
    for (const Volume& volume : levels.volumes) validate(volume);
    for (const Volume& mask : levels.masks) validate(mask);
    const auto label = [](const Volume& volume) {
        return volume_label(volume.source, volume.name);
    };
    for (const auto* several : {&levels.volumes, &levels.masks})
        for (const Volume& volume : *several)
            require_same_length(volume.units.length, label(volume),
                                levels.volumes.front().units.length, label(levels.volumes.front()));
}

bool same_voxel_volume(double a, double b) {
    constexpr double kSame = 1e-4;
    return std::max(a, b) <= (1 + kSame) * std::min(a, b);
}

std::vector<std::size_t> finest_first(std::span<const Volume> volumes) {
    std::vector<std::size_t> order(volumes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto size = [&](std::size_t n) { return voxel_volume(volumes[n]); };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) < size(b); });
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first + 1;
        while (last < order.size() && same_voxel_volume(size(order[last]), size(order[first])))
            ++last;
        std::sort(order.begin() + static_cast<std::ptrdiff_t>(first),
                  order.begin() + static_cast<std::ptrdiff_t>(last));
        first = last;
    }
    return order;
}

Composite composite(const Levels& levels) {
    validate(levels);
    const std::vector<Volume>& domains = levels.masks.empty() ? levels.volumes : levels.masks;
    std::deque<VoxelLookup> lookups;
    for (const Volume& domain : domains) lookups.emplace_back(domain);

    Composite result;
    for (const Volume& level : levels.volumes) result.box.include(world_box(level));
    result.content = content_of(levels.volumes, result.box);
    const std::vector<std::size_t> order = finest_first(levels.volumes);
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        const Volume& level = levels.volumes[order[rank]];
        std::vector<ClipRegion> regions;
        const auto add_region = [&](std::size_t of, bool keeps) {
            regions.push_back(clip_region(lookups[of], keeps, domains[of].world_from_index,
                                          level.world_from_index));
        };
        if (!levels.masks.empty()) add_region(order[rank], true);
        for (std::size_t finer = 0; finer < rank; ++finer) add_region(order[finer], false);

        LevelPart part = LevelCut(level, std::move(regions)).cut();
        result.voxels += part.voxels;
        result.hidden += part.hidden;
        result.partly_hidden += part.partly_hidden;
        for (Volume* volume : {&part.whole, &part.pieces})
            if (!volume->empty()) result.parts.push_back(std::move(*volume));
    }
    return result;
}

}  // namespace vog
