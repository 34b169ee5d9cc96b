// lattice_field.cpp: alignment of lattices, and division of bricks that overlap.
#include "convert/moments/cells/lattice_field.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "core/paging.h"
#include "vog/levels.h"

namespace vog::moments {

namespace {

/// A volume's lattice as a subdivision of a coarser one.
struct Division {
    int log2 = 0;  ///< coarse voxel edge = 2^log2 fine ones
    Vec3i corner;  ///< voxel of the volume in the lower corner of voxel 0 of the coarse lattice
};

struct Member {
    const Volume* volume;
    Division division;
};

/// Volumes of one field.
struct Lattice {
    Affine coarsest;
    int finest_log2 = 0;
    std::vector<Member> members;  ///< coarsest first
};

bool is_whole(double number) {
    constexpr double kRounding = 1e-4;  // voxels; transforms are often stored as float32
    return std::abs(number - std::round(number)) < kRounding;
}

/// The subdivision of the lattice `coarse` that `volume` lies on; none unless the voxel edges
/// differ by a power of two, the axes agree and corners of voxels coincide.
std::optional<Division> find_division(const Affine& coarse, const Volume& volume) {
    const Mat3 back = inverse(volume.world_from_index.linear);
    const Affine fine_from_coarse{
        back * coarse.linear, back * (coarse.translation - volume.world_from_index.translation)};
    constexpr double kSame = 1e-6;
    constexpr int kMostHalvings = 16;
    const double ratio = fine_from_coarse.linear(0, 0);
    const int log2 = ratio > 0.5 ? static_cast<int>(std::lround(std::log2(ratio))) : -1;
    if (log2 < 0 || log2 > kMostHalvings) return {};
    const double edge = std::ldexp(1.0, log2);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (std::abs(fine_from_coarse.linear(row, column) - (row == column ? edge : 0)) >
                kSame * edge)
                return {};
    // Corners are compared near the middle of the volume, where the error of the ratio adds up
    // least.
    const Vec3d middle = inverse(fine_from_coarse)(index_box(volume).center());
    const Vec3d near{std::round(middle.x), std::round(middle.y), std::round(middle.z)};
    const Vec3d half{0.5, 0.5, 0.5};
    const Vec3d corner = fine_from_coarse(near - half) + half;
    Division division{log2, {}};
    for (int axis = 0; axis < 3; ++axis) {
        const double at_zero = std::round(corner[axis]) - edge * near[axis];
        if (!is_whole(corner[axis]) || std::abs(at_zero) > (1 << 28)) return {};
        division.corner[axis] = static_cast<std::int32_t>(at_zero);
    }
    for (const Tile& tile : volume.tiles)  // bricks of large tiles must stay aligned
        for (int axis = 0; axis < 3; ++axis)
            if (tile.edge > kLeafEdge && division.corner[axis] % tile.edge != 0) return {};
    return division;
}

std::vector<Lattice> find_lattices(std::span<const Volume> parts) {
    std::vector<std::size_t> order = finest_first(parts);
    std::reverse(order.begin(), order.end());
    std::vector<Lattice> lattices;
    for (const std::size_t n : order) {
        bool placed = false;
        for (Lattice& lattice : lattices) {
            const auto division = find_division(lattice.coarsest, parts[n]);
            if (!division) continue;
            lattice.members.push_back({&parts[n], *division});
            lattice.finest_log2 = std::max(lattice.finest_log2, division->log2);
            placed = true;
            break;
        }
        if (!placed) lattices.push_back({parts[n].world_from_index, 0, {{&parts[n], {}}}});
    }
    return lattices;
}

struct OriginHash {
    std::size_t operator()(Vec3i v) const {
        const auto mix = [](std::int32_t value, std::uint64_t factor) {
            return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value)) * factor;
        };
        const std::uint64_t sum = mix(v.x, 0x9e3779b97f4a7c15u) ^ mix(v.y, 0xc2b2ae3d27d4eb4fu) ^
                                  mix(v.z, 0x165667b19e3779f9u);
        return sum ^ sum >> 29;
    }
};

Leaf& new_leaf(LatticeField& field, Vec3i origin) {
    keep_memory();
    Leaf& leaf = field.leaves.add();
    leaf.origin = origin;
    return leaf;
}

/// Bricks by size and origin; divide() makes them disjoint.
class BrickMap {
  public:
    explicit BrickMap(LatticeField& field) : field_(field) {}

    struct Samples {
        const Leaf* leaf;
        float value;     ///< density of every sample, if leaf is null
        int voxel_size;  ///< the data's voxels are 2^voxel_size of the finest wide
    };
    /// Adds 8^3 samples of 2^size voxels; sums the densities where a brick has this size and
    /// origin.
    void add(int size, Vec3i origin, const Samples& samples) {
        const auto& [leaf, value, voxel_size] = samples;
        if (static_cast<std::size_t>(size) >= sizes_.size())
            sizes_.resize(static_cast<std::size_t>(size) + 1);
        auto [place, is_new] = sizes_[static_cast<std::size_t>(size)].try_emplace(origin, samples);
        if (is_new) return;
        Leaf& sum = new_leaf(field_, origin);
        for (int n = 0; n < kLeafVoxels; ++n) {
            const auto at = static_cast<std::size_t>(n);
            const Samples& other = place->second;
            sum.value[at] = (leaf ? leaf->value[at] : value) +
                            (other.leaf ? other.leaf->value[at] : other.value);
        }
        place->second = {&sum, 0, std::min(voxel_size, place->second.voxel_size)};
    }

    /// Divides every brick that contains a smaller one.
    void divide() {
        std::vector<std::unordered_set<Vec3i, OriginHash>> has_smaller(sizes_.size());
        for (std::size_t size = 0; size < sizes_.size(); ++size)
            for (const auto& [origin, samples] : sizes_[size])
                for (std::size_t larger = size + 1; larger < sizes_.size(); ++larger)
                    has_smaller[larger].insert(around(origin, larger));
        for (std::size_t size = sizes_.size(); size-- > 1;) {
            std::vector<std::pair<Vec3i, Samples>> divided;
            for (const auto& [origin, samples] : sizes_[size])
                if (has_smaller[size].contains(origin)) divided.push_back({origin, samples});
            for (const auto& [origin, samples] : divided) {
                sizes_[size].erase(origin);
                add_eighths(static_cast<int>(size), origin, samples);
            }
        }
    }

    BigVector<Brick> bricks() const {
        BigVector<Brick> all;
        for (std::size_t size = 0; size < sizes_.size(); ++size)
            for (const auto& [origin, samples] : sizes_[size])
                all.push_back({origin, std::ldexp(1.0, static_cast<int>(size)), samples.leaf,
                               samples.value, std::ldexp(1.0, samples.voxel_size)});
        std::sort(all.begin(), all.end(),
                  [](const Brick& a, const Brick& b) { return morton_less(a.origin, b.origin); });
        // After sorting: nearby leaves are read together, which saves paging under a memory limit.
        std::erase_if(all, [](const Brick& brick) {
            keep_memory();
            return brick.leaf ? std::ranges::none_of(brick.leaf->value,
                                                     [](float value) { return value > 0; })
                              : !(brick.value > 0);
        });
        return all;
    }

  private:
    static Vec3i around(Vec3i origin, std::size_t size) {
        const int shift = static_cast<int>(size) + 3;
        for (int axis = 0; axis < 3; ++axis) origin[axis] = origin[axis] >> shift << shift;
        return origin;
    }

    /// Adds the eight octants of a brick, each sample repeated 2^3 times; empty parts
    /// are left out.
    void add_eighths(int size, Vec3i origin, const Samples& samples) {
        for (int eighth = 0; eighth < 8; ++eighth) {
            const Vec3i half{eighth >> 2, eighth >> 1 & 1, eighth & 1};
            const Vec3i at = origin + (kLeafEdge << (size - 1)) * half;
            if (!samples.leaf) {
                add(size - 1, at, samples);
                continue;
            }
            Leaf& fine = new_leaf(field_, at);
            float largest = 0;
            for (int n = 0; n < kLeafVoxels; ++n) {
                const Vec3i from = 4 * half + Vec3i{n >> 7, n >> 4 & 3, n >> 1 & 3};
                const float value =
                    samples.leaf
                        ->value[static_cast<std::size_t>(leaf_offset(from.x, from.y, from.z))];
                fine.value[static_cast<std::size_t>(n)] = value;
                largest = std::max(largest, value);
            }
            if (largest > 0)
                add(size - 1, at, {&fine, 0, samples.voxel_size});
            else
                field_.leaves.remove_last();
        }
    }

    LatticeField& field_;
    std::vector<std::unordered_map<Vec3i, Samples, OriginHash>> sizes_;
};

/// Copies a volume's leaves and small tiles voxel by voxel into leaves of the field's alignment.
void add_moved(const Volume& volume, Vec3i corner, int size, LatticeField& field, BrickMap& map) {
    std::unordered_map<Vec3i, Leaf*, OriginHash> moved;
    const auto set = [&](Vec3i index, float value) {
        const Vec3i origin{index.x & ~7, index.y & ~7, index.z & ~7};
        Leaf*& leaf = moved[origin];
        if (!leaf) leaf = &new_leaf(field, origin);
        leaf->value[static_cast<std::size_t>(leaf_offset(index.x & 7, index.y & 7, index.z & 7))] =
            value;
    };
    for (const Leaf& leaf : volume.leaves) {
        keep_memory();
        for (int n = 0; n < kLeafVoxels; ++n)
            if (const float value = leaf.value[static_cast<std::size_t>(n)]; value > 0)
                set(leaf.origin - corner + Vec3i{n >> 6, n >> 3 & 7, n & 7}, value);
    }
    for (const Tile& tile : volume.tiles)
        if (tile.edge == kLeafEdge)
            for (int n = 0; n < kLeafVoxels; ++n)
                set(tile.origin - corner + Vec3i{n >> 6, n >> 3 & 7, n & 7}, tile.value);
    for (const auto& [origin, leaf] : moved) map.add(size, (1 << size) * origin, {leaf, 0, size});
}

void add_member(const Member& member, int size, LatticeField& field, BrickMap& map) {
    const Volume& volume = *member.volume;
    const Vec3i corner = member.division.corner;
    const bool whole_leaves = ((corner.x | corner.y | corner.z) & 7) == 0;
    if (!whole_leaves) add_moved(volume, corner, size, field, map);
    for (const Leaf& leaf : volume.leaves) {
        keep_memory();
        if (whole_leaves) map.add(size, (1 << size) * (leaf.origin - corner), {&leaf, 0, size});
    }
    for (const Tile& tile : volume.tiles)
        if (whole_leaves || tile.edge > kLeafEdge)
            map.add(size + std::countr_zero(static_cast<unsigned>(tile.edge / kLeafEdge)),
                    (1 << size) * (tile.origin - corner), {nullptr, tile.value, size});
}

}  // namespace

Leaf& StableLeaves::add() {
    if (runs_.empty() || runs_.back().size() == runs_.back().capacity()) {
        const std::size_t size = runs_.empty() ? 64 : 2 * runs_.back().capacity();
        runs_.emplace_back().reserve(size);
    }
    return runs_.back().emplace_back();
}

LatticeStep::LatticeStep(const Volume& volume, const LatticeField& field) {
    if (field.volumes.size() == 1) return;
    const double ratio = voxel_volume(volume) / field.voxel_volume();
    edge = std::exp2(std::round(std::log2(ratio) / 3));
    first = inverse(field.world_from_index)(volume.world_from_index.translation);
    for (int axis = 0; axis < 3; ++axis) first[axis] = 0.5 * std::round(2 * first[axis]);
}

Moments LatticeStep::operator()(const MomentSums& sums, Vec3d center) const {
    Moments cell = moments_of(sums);
    cell.mass *= edge * edge * edge;
    cell.mean = first + edge * (cell.mean + center);
    for (double& c : cell.covariance) c *= edge * edge;
    return cell;
}

LatticeField lattice_field(const Volume& volume) {
    return {volume_bricks(volume, morton_nodes(volume)), {}, volume.world_from_index, {&volume}};
}

std::vector<LatticeField> lattice_fields(std::span<const Volume> parts) {
    std::vector<LatticeField> fields;
    for (const Lattice& lattice : find_lattices(parts)) {
        LatticeField& field = fields.emplace_back();
        // Voxels 0 of the finest and of the coarsest lattice share their lower corner.
        const double edge = std::ldexp(1.0, -lattice.finest_log2), shift = 0.5 * edge - 0.5;
        field.world_from_index = lattice.coarsest;
        field.world_from_index.translation = lattice.coarsest({shift, shift, shift});
        for (Vec3d& row : field.world_from_index.linear.row) row = edge * row;
        BrickMap map(field);
        for (const Member& member : lattice.members) {
            add_member(member, lattice.finest_log2 - member.division.log2, field, map);
            field.volumes.push_back(member.volume);
        }
        map.divide();
        field.bricks = map.bricks();
    }
    return fields;
}

}  // namespace vog::moments
