// overlapping_cells.cpp: voxels around a leaf, sums of half cells, separable windows.
#include "convert/moments/cells/overlapping_cells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "convert/moments/periodic_lattice.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Window along an axis: weights of the four half cells from one half before a cell to one behind.
constexpr std::array<double, 4> kWindow{kOuterWeight, 1 - kOuterWeight, 1 - kOuterWeight,
                                        kOuterWeight};

/// The voxels of a leaf's cells and of one ring of cells around.
template <int edge>
struct Around {
    static constexpr int cells = kLeafEdge / edge + 2;  ///< along the gathered cube
    static constexpr int reach = cells * edge, halves = 2 * cells;
    static constexpr std::size_t kVoxels = std::size_t{reach} * reach * reach;
};

/// Window times powers of the distance from the cell's centre.
struct WindowPowers {
    std::array<double, 4> w0, w1, w2;
    explicit WindowPowers(double half) {
        for (std::size_t n = 0; n < 4; ++n) {
            const double at = (static_cast<double>(n) - 1.5) * half;
            w0[n] = kWindow[n], w1[n] = kWindow[n] * at, w2[n] = kWindow[n] * at * at;
        }
    }
};

double weighted(const std::array<double, 4>& w, const double* first, std::size_t step) {
    return w[0] * first[0] + w[1] * first[step] + w[2] * first[2 * step] + w[3] * first[3 * step];
}

/// Sums of the cube of `edge` voxels at `first` about its centre.
/// reach  voxels along the array
MomentSums sums_of_cube(const float* first, int edge, int reach) {
    MomentSums sums;
    const double middle = 0.5 * (edge - 1);
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
            for (int z = 0; z < edge; ++z) {
                const double m = first[(x * reach + y) * reach + z];
                if (m == 0) continue;
                const double px = x - middle, py = y - middle, pz = z - middle;
                sums.mass += m;
                sums.first = sums.first + m * Vec3d{px, py, pz};
                sums.second[0] += m * px * px, sums.second[1] += m * px * py;
                sums.second[2] += m * px * pz, sums.second[3] += m * py * py;
                sums.second[4] += m * py * pz, sums.second[5] += m * pz * pz;
            }
    for (const std::size_t n : {0, 3, 5}) sums.second[n] += kBoxVariance * sums.mass;
    return sums;
}

}  // namespace

OverlappingCells::OverlappingCells(const Volume& volume, std::span<const MortonNode> nodes,
                                   int edge, std::optional<IndexBox> period)
    : volume_(volume), neighbours_(nodes, period), edge_(edge) {}

template <int edge, class LeafOf, class TileOf>
void OverlappingCells::gather_around(const MortonNode& node, const LeafOf& leaf_of,
                                     const TileOf& tile_of, std::vector<float>& values) const {
    constexpr int reach = Around<edge>::reach;
    values.assign(Around<edge>::kVoxels, 0);
    const LeafNeighbours::Around around = neighbours_.around(node.origin);
    for (int n = 0; n < 27; ++n) {
        const Vec3i side{n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
        const MortonNode* found = around[static_cast<std::size_t>(n)];
        if (!found) continue;
        const float value = found->tile ? tile_of(found->index) : 0;
        const float* leaf = found->tile ? nullptr : leaf_of(found->index);
        // Voxels [first, end) of the neighbour lie in the gathered cube.
        Vec3i first, end, to;
        for (int axis = 0; axis < 3; ++axis) {
            first[axis] = side[axis] < 0 ? kLeafEdge - edge : 0;
            end[axis] = side[axis] > 0 ? edge : kLeafEdge;
            to[axis] = edge + kLeafEdge * side[axis];
        }
        for (int x = first.x; x < end.x; ++x)
            for (int y = first.y; y < end.y; ++y) {
                float* row =
                    values.data() + ((to.x + x) * reach + to.y + y) * reach + to.z + first.z;
                const float* from = leaf ? leaf + leaf_offset(x, y, first.z) : nullptr;
                // Rows of 8 floats and less, for which calls of memmove cost more than a loop.
                if (end.z - first.z == kLeafEdge)
                    for (int z = 0; z < kLeafEdge; ++z) row[z] = from ? from[z] : value;
                else
                    for (int z = 0; z < edge; ++z) row[z] = from ? from[z] : value;
            }
    }
}

void OverlappingCells::gather(const MortonNode& node, const VoxelValues& field,
                              std::vector<float>& values) const {
    const auto leaf_of = [&](std::size_t index) { return field.leaf[index].data(); };
    const auto tile_of = [&](std::size_t index) { return field.tile[index]; };
    if (edge_ == 1) return gather_around<1>(node, leaf_of, tile_of, values);
    if (edge_ == 2) return gather_around<2>(node, leaf_of, tile_of, values);
    if (edge_ == 4) return gather_around<4>(node, leaf_of, tile_of, values);
    gather_around<8>(node, leaf_of, tile_of, values);
}

template <int edge>
void OverlappingCells::find_joined(OverlapScratch& scratch) const {
    constexpr int cells = Around<edge>::cells, reach = Around<edge>::reach;
    constexpr std::size_t count = std::size_t{cells} * cells * cells;
    scratch.occupied.assign(count, 0);
    scratch.joined.assign(count, ~std::uint32_t{0});
    scratch.apart = false;
    std::array<std::array<Vec3i, 2>, count> bounds;  // first and last voxel with mass
    const float* value = scratch.values.data();
    for (int x = 0; x < reach; ++x)
        for (int y = 0; y < reach; ++y)
            for (int z = 0; z < reach; ++z, ++value) {
                if (!(*value > 0)) continue;
                const auto cell =
                    static_cast<std::size_t>((x / edge * cells + y / edge) * cells + z / edge);
                auto& [first, last] = bounds[cell];
                if (scratch.occupied[cell] == 0) first = last = {x, y, z};
                scratch.occupied[cell] = 1;
                first = {first.x, std::min(first.y, y), std::min(first.z, z)};
                last = {x, std::max(last.y, y), std::max(last.z, z)};
            }
    const auto is_apart = [&](std::size_t a, std::size_t b) {
        for (int axis = 0; axis < 3; ++axis) {
            const int empty = std::max(bounds[a][0][axis] - bounds[b][1][axis],
                                       bounds[b][0][axis] - bounds[a][1][axis]) -
                              1;
            if (2 * empty >= edge) return true;
        }
        return false;
    };
    const auto cell_at = [](Vec3i at) {
        return static_cast<std::size_t>((at.x * cells + at.y) * cells + at.z);
    };
    for (std::size_t a = 0; a < count; ++a) {
        if (scratch.occupied[a] == 0) continue;
        const auto n = static_cast<int>(a);
        const Vec3i at{n / (cells * cells), n / cells % cells, n % cells};
        for (int bit = neighbour_bit({0, 0, 0}) + 1; bit < 27; ++bit) {
            const Vec3i step{bit / 9 - 1, bit / 3 % 3 - 1, bit % 3 - 1}, other = at + step;
            if (std::min({other.x, other.y, other.z}) < 0 ||
                std::max({other.x, other.y, other.z}) >= cells)
                continue;
            const std::size_t b = cell_at(other);
            if (scratch.occupied[b] == 0 || !is_apart(a, b)) continue;
            scratch.joined[a] &= ~(std::uint32_t{1} << bit);
            scratch.joined[b] &= ~(std::uint32_t{1} << (26 - bit));
            scratch.apart = true;
        }
    }
}

template <int edge>
bool OverlappingCells::find_shares(OverlapScratch& scratch) const {
    constexpr int cells = Around<edge>::cells, halves = Around<edge>::halves;
    find_joined<edge>(scratch);
    if (!scratch.apart &&
        std::ranges::all_of(scratch.occupied, [](double any) { return any != 0; }))
        return false;
    // Along one axis after the other a half cell gets 7/8 of its own cell and 1/8 of the cell that
    // it borders.
    const auto spread = [](const double* from, double* to, int outer, int inner) {
        for (int o = 0; o < outer; ++o)
            for (int h = 1; h < halves - 1; ++h) {
                const double* own = from + (o * cells + h / 2) * inner;
                const double* next = own + (h & 1 ? inner : -inner);
                double* sum = to + (o * halves + h) * inner;
                for (int n = 0; n < inner; ++n)
                    sum[n] = (1 - kOuterWeight) * own[n] + kOuterWeight * next[n];
            }
    };
    scratch.along_x.resize(std::size_t{halves} * cells * cells);
    scratch.along_y.resize(std::size_t{halves} * halves * cells);
    scratch.window_sums.resize(std::size_t{halves} * halves * halves);
    if (scratch.apart) {
        for (int n = 0; n < halves * halves * halves; ++n) {
            const Vec3i half{n / (halves * halves), n / halves % halves, n % halves};
            const Vec3i at{half.x / 2, half.y / 2, half.z / 2};
            const auto cell = static_cast<std::size_t>((at.x * cells + at.y) * cells + at.z);
            double& sum = scratch.window_sums[static_cast<std::size_t>(n)] = 0;
            for (int k = 0; k < 8; ++k) {
                Vec3i step{k >> 2, k >> 1 & 1, k & 1}, other;
                double weight = 1;
                bool inside = true;
                for (int axis = 0; axis < 3; ++axis) {
                    weight *= step[axis] ? kOuterWeight : 1 - kOuterWeight;
                    if (half[axis] % 2 == 0) step[axis] = -step[axis];
                    other[axis] = at[axis] + step[axis];
                    inside &= other[axis] >= 0 && other[axis] < cells;
                }
                if (inside && scratch.joined[cell] >> neighbour_bit(step) & 1)
                    sum += weight * scratch.occupied[static_cast<std::size_t>(
                                        (other.x * cells + other.y) * cells + other.z)];
            }
        }
        return true;
    }
    spread(scratch.occupied.data(), scratch.along_x.data(), 1, cells * cells);
    spread(scratch.along_x.data(), scratch.along_y.data(), halves, cells);
    spread(scratch.along_y.data(), scratch.window_sums.data(), halves * halves, 1);
    return true;
}

void OverlappingCells::take_voxels(OverlapScratch& scratch) const {
    constexpr int reach = Around<1>::reach;
    for (std::size_t n = 0; n < scratch.cells.size(); ++n) {
        const Vec3i at = morton_place(static_cast<int>(n)) + Vec3i{1, 1, 1};
        const float* voxel = scratch.values.data() + (at.x * reach + at.y) * reach + at.z;
        if (!(*voxel > 0)) continue;
        const auto second = [&](int step) {
            const double shared = std::min(*voxel, voxel[step]) + std::min(*voxel, voxel[-step]);
            return kBoxVariance * (*voxel + 0.5 * std::max(0.0, shared));
        };
        scratch.cells[n] = {*voxel, {}, {second(reach * reach), 0, 0, second(reach), 0, second(1)}};
    }
}

void OverlappingCells::take_fine(OverlapScratch& scratch, bool shared, bool masses_only) const {
    constexpr int edge = 2;
    constexpr std::size_t halves = Around<edge>::halves, cells = kLeafEdge / edge;
    constexpr std::size_t plane = halves * halves, reach = Around<edge>::reach;
    constexpr double half = 0.5 * edge, volume = half * half * half;
    // Masses of half cells, by coordinates in the gathered cube; the outermost lie in no window.
    scratch.halves.resize(plane * halves);
    for (std::size_t x = 1; x < halves - 1; ++x)
        for (std::size_t y = 1; y < halves - 1; ++y) {
            const float* from =
                scratch.values.data() + (x * edge / 2 * reach + y * edge / 2) * reach;
            double* to = scratch.halves.data() + (x * halves + y) * halves;
            to[0] = to[halves - 1] = 0;
            for (std::size_t z = 1; z < halves - 1; ++z) to[z] = volume * from[z * edge / 2];
            if (!shared) continue;
            const double* sum = scratch.window_sums.data() + (x * halves + y) * halves;
            for (std::size_t z = 1; z < halves - 1; ++z)
                if (to[z] > 0) to[z] /= sum[z];
        }
    // Sums of weight times 1, x, x^2 ... along one axis after the other.
    const WindowPowers w(half);
    scratch.along_x.resize(cells * 3 * plane);
    for (std::size_t cx = 0; cx < cells; ++cx) {
        const double* at = scratch.halves.data() + (2 * cx + 1) * plane;
        double* to = scratch.along_x.data() + cx * 3 * plane;
        // Rows 0 and halves - 1 are not set and not used.
        for (std::size_t n = halves; n < plane - halves; ++n) to[n] = weighted(w.w0, at + n, plane);
        if (masses_only) continue;
        for (std::size_t n = halves; n < plane - halves; ++n) {
            to[plane + n] = weighted(w.w1, at + n, plane);
            to[2 * plane + n] = weighted(w.w2, at + n, plane);
        }
    }
    scratch.along_y.resize(cells * cells * 6 * halves);
    for (std::size_t cx = 0; cx < cells; ++cx)
        for (std::size_t cy = 0; cy < cells; ++cy) {
            const double* at = scratch.along_x.data() + cx * 3 * plane + (2 * cy + 1) * halves;
            double* to = scratch.along_y.data() + (cx * cells + cy) * 6 * halves;
            const auto row = [&](std::size_t into, const std::array<double, 4>& by,
                                 std::size_t from) {
                for (std::size_t z = 0; z < halves; ++z)
                    to[into * halves + z] = weighted(by, at + from * plane + z, halves);
            };
            row(0, w.w0, 0);  // 1
            if (masses_only) continue;
            row(1, w.w0, 1), row(2, w.w0, 2);                   // x, xx
            row(3, w.w1, 0), row(4, w.w1, 1), row(5, w.w2, 0);  // y, xy, yy
        }
    constexpr double box = kBoxVariance * half * half;
    for (std::size_t n = 0; n < scratch.cells.size(); ++n) {
        const Vec3i place = morton_place(static_cast<int>(n));
        const double* at =
            scratch.along_y.data() +
            (static_cast<std::size_t>(place.x) * cells + static_cast<std::size_t>(place.y)) * 6 *
                halves +
            2 * static_cast<std::size_t>(place.z) + 1;
        MomentSums& sums = scratch.cells[n];
        sums.mass = weighted(w.w0, at, 1);
        if (masses_only) continue;
        sums.first = {weighted(w.w0, at + halves, 1), weighted(w.w0, at + 3 * halves, 1),
                      weighted(w.w1, at, 1)};
        sums.second = {weighted(w.w0, at + 2 * halves, 1), weighted(w.w0, at + 4 * halves, 1),
                       weighted(w.w1, at + halves, 1),     weighted(w.w0, at + 5 * halves, 1),
                       weighted(w.w1, at + 3 * halves, 1), weighted(w.w2, at, 1)};
        for (const std::size_t axis : {0, 3, 5}) sums.second[axis] += box * sums.mass;
    }
}

template <int edge>
void OverlappingCells::take_coarse(OverlapScratch& scratch, bool shared) const {
    constexpr int half = edge / 2, halves = Around<edge>::halves, reach = Around<edge>::reach;
    constexpr int cells = Around<edge>::cells;
    const auto at = [&](int x, int y, int z) {
        return static_cast<std::size_t>((x * halves + y) * halves + z);
    };
    scratch.half_sums.assign(at(halves, 0, 0), {});
    for (int x = 1; x < halves - 1; ++x)
        for (int y = 1; y < halves - 1; ++y)
            for (int z = 1; z < halves - 1; ++z) {
                MomentSums& sums = scratch.half_sums[at(x, y, z)];
                sums = sums_of_cube(scratch.values.data() + half * ((x * reach + y) * reach + z),
                                    half, reach);
                if (!(sums.mass > 0) || !shared) continue;
                const double times = 1 / scratch.window_sums[at(x, y, z)];
                sums.mass *= times, sums.first = times * sums.first;
                for (double& second : sums.second) second *= times;
            }
    for (std::size_t n = 0; n < scratch.cells.size(); ++n) {
        const Vec3i place = morton_place(static_cast<int>(n));
        const std::uint32_t joined = scratch.joined[static_cast<std::size_t>(
            ((place.x + 1) * cells + place.y + 1) * cells + place.z + 1)];
        MomentSums& cell = scratch.cells[n];
        cell = {};
        for (int k = 0; k < 64; ++k) {
            const Vec3i tap{k >> 4, k >> 2 & 3, k & 3};
            const auto step = [](int half_cell) { return (half_cell + 1) / 2 - 1; };
            if (!(joined >> neighbour_bit({step(tap.x), step(tap.y), step(tap.z)}) & 1)) continue;
            MomentSums part = scratch.half_sums[at(2 * place.x + 1 + tap.x, 2 * place.y + 1 + tap.y,
                                                   2 * place.z + 1 + tap.z)];
            if (!(part.mass > 0)) continue;
            const double w = kWindow[static_cast<std::size_t>(tap.x)] *
                             kWindow[static_cast<std::size_t>(tap.y)] *
                             kWindow[static_cast<std::size_t>(tap.z)];
            part.mass *= w, part.first = w * part.first;
            for (double& second : part.second) second *= w;
            add_shifted(cell, part,
                        {(tap.x - 1.5) * half, (tap.y - 1.5) * half, (tap.z - 1.5) * half});
        }
    }
}

void OverlappingCells::take_tile(const Tile& tile, OverlapScratch& scratch) const {
    // As many cells as for_each_cell makes, whose windows end at the faces of the tile.
    const int across = std::clamp(tile.edge / edge_, 1, kLeafEdge), side = tile.edge / across;
    scratch.side = side;
    const double half = 0.5 * side;
    const WindowPowers w(half);
    /// Length, first and second moment of the window of cell n along an axis, about its centre.
    const auto along = [&](int n) {
        std::array<double, 3> sums{};
        for (std::size_t k = 0; k < 4; ++k) {
            const bool before = n > 0, behind = n < across - 1;
            if ((k == 0 && !before) || (k == 3 && !behind)) continue;
            const bool alone = (k == 1 && !before) || (k == 2 && !behind);
            const double times = half * (alone ? 1 / kWindow[k] : 1);
            sums[0] += times * w.w0[k], sums[1] += times * w.w1[k];
            sums[2] += times * (w.w2[k] + w.w0[k] * kBoxVariance * half * half);
        }
        return sums;
    };
    scratch.cells.resize(static_cast<std::size_t>(across * across * across));
    for (std::size_t n = 0; n < scratch.cells.size(); ++n) {
        const Vec3i place = morton_place(static_cast<int>(n));
        const auto x = along(place.x), y = along(place.y), z = along(place.z);
        const double v = std::max(0.0f, tile.value);
        scratch.cells[n] = {
            v * x[0] * y[0] * z[0],
            v * Vec3d{x[1] * y[0] * z[0], x[0] * y[1] * z[0], x[0] * y[0] * z[1]},
            {v * x[2] * y[0] * z[0], v * x[1] * y[1] * z[0], v * x[1] * y[0] * z[1],
             v * x[0] * y[2] * z[0], v * x[0] * y[1] * z[1], v * x[0] * y[0] * z[2]}};
    }
}

template <int edge>
void OverlappingCells::take_leaf(const MortonNode& node, OverlapScratch& scratch,
                                 bool masses_only) const {
    constexpr int across = kLeafEdge / edge, cells = Around<edge>::cells;
    scratch.side = edge;
    scratch.cells.assign(std::size_t{across} * across * across, {});
    const auto leaf_of = [&](std::size_t index) { return volume_.leaves[index].value.data(); };
    const auto tile_of = [&](std::size_t index) {
        return std::max(0.0f, volume_.tiles[index].value);
    };
    const bool has_mass = node.tile ? tile_of(node.index) > 0
                                    : std::ranges::any_of(volume_.leaves[node.index].value,
                                                          [](float v) { return v > 0; });
    if (!has_mass) return;
    gather_around<edge>(node, leaf_of, tile_of, scratch.values);
    if constexpr (edge == 1) {
        take_voxels(scratch);
    } else {
        const bool shared = scratch.shared = find_shares<edge>(scratch);
        if (edge == 2 && !scratch.apart)
            take_fine(scratch, shared, masses_only);
        else
            take_coarse<edge>(scratch, shared);
        // A window reaches voxels of its neighbours: only occupied cells have one.
        for (std::size_t n = 0; shared && n < scratch.cells.size(); ++n) {
            const Vec3i at = morton_place(static_cast<int>(n)) + Vec3i{1, 1, 1};
            if (scratch.occupied[static_cast<std::size_t>((at.x * cells + at.y) * cells + at.z)] ==
                0)
                scratch.cells[n] = {};
        }
    }
}

void OverlappingCells::take(const MortonNode& node, OverlapScratch& scratch,
                            bool masses_only) const {
    if (node.edge > kLeafEdge) return take_tile(volume_.tiles[node.index], scratch);
    if (edge_ == 1) return take_leaf<1>(node, scratch, masses_only);
    if (edge_ == 2) return take_leaf<2>(node, scratch, masses_only);
    if (edge_ == 4) return take_leaf<4>(node, scratch, masses_only);
    take_leaf<8>(node, scratch, masses_only);
}

PackedCells overlapping_cells(const LatticeField& field, int edge,
                              const std::optional<Box>& period) {
    const PackedCells none(field.bricks);
    std::vector<PackedCells> parts;
    for (const Volume* volume : field.volumes) {
        const std::vector<MortonNode> nodes = morton_nodes(*volume);
        const OverlappingCells windows(*volume, nodes, edge,
                                       leaf_period(period, volume->world_from_index));
        const LatticeStep to_field(*volume, field);
        const std::size_t before = parts.size();
        parts.resize(before + (nodes.size() + kNodeChunk - 1) / kNodeChunk, none);
        vog::parallel_for(before, parts.size(), [&](std::size_t part) {
            OverlapScratch scratch;
            const std::size_t first = (part - before) * kNodeChunk;
            for (std::size_t n = first; n < std::min(first + kNodeChunk, nodes.size()); ++n)
                for_each_overlapping_cell(windows, nodes[n], scratch, false,
                                          [&](const MomentSums& sums, Vec3d center) {
                                              parts[part].push_back(to_field(sums, center));
                                          });
        });
    }
    return joined_cells(std::move(parts), none);
}

}  // namespace vog::moments
