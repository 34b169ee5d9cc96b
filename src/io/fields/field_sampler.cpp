// field_sampler.cpp: trilinear sampling of OpenVDB grids, and the search for cubes of one value.
#include "io/fields/field_sampler.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "io/fields/index_map.h"
#include "io/fields/tree_regions.h"
#include "io/vdb/vdb_density.h"
#include "vog/error.h"

namespace vog::field_files {

using namespace vdb;

namespace {

/// Indices beyond are background: the sum of two stays in range.
constexpr double kFarthest = 1 << 30;

/// Distance to a voxel's centre below which it counts alone, voxels: a neighbour of weight 0 may
/// be NaN.
constexpr double kAtCentre = 1e-6;

bool is_far(Vec3d p) {
    return !(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest);
}

openvdb::Coord nearest(Vec3d p) {
    return {static_cast<int>(std::round(p.x)), static_cast<int>(std::round(p.y)),
            static_cast<int>(std::round(p.z))};
}

/// Voxels around a position along one axis, and the weight of the second.
struct Between {
    std::int32_t index = 0;
    double second = 0;

    explicit Between(double p) {
        const double centre = std::round(p);
        if (std::abs(p - centre) < kAtCentre) {
            index = static_cast<std::int32_t>(centre);
            return;
        }
        const double below = std::floor(p);
        index = static_cast<std::int32_t>(below);
        second = p - below;
    }
};

template <class GridT>
class GridSampler final : public FieldSampler {
    using Value = typename GridT::ValueType;
    using Accessor = typename GridT::ConstUnsafeAccessor;
    static constexpr std::size_t kComponents = openvdb::VecTraits<Value>::IsVec ? 3 : 1;
    using Numbers = std::array<double, kComponents>;

  public:
    GridSampler(const FieldGrid& field, const GridT& grid, const Volume& volume)
        : field_(field),
          grid_(grid),
          map_(index_map(volume.world_from_index, field.world_from_index, index_box(volume))),
          background_(numbers(grid.background())),
          staggered_(field.staggered && kComponents == 3) {}

    std::size_t components() const override { return kComponents; }

    void leaves(
        std::span<const Leaf> leaves,
        const std::function<void(std::size_t, const LeafSamples&)>& receive) const override {
        const Accessor accessor = grid_.getConstUnsafeAccessor();
        LeafSamples samples;
        for (std::size_t i = 0; i < leaves.size(); ++i) {
            samples = {};
            const Vec3d first = map_(leaves[i].origin);
            if (map_.same_lattice && !is_far(first))
                sample_voxels(accessor, leaves[i], nearest(first), samples);
            else
                sample_positions(accessor, leaves[i], samples);
            receive(i, samples);
        }
    }

    TileSample tile(Vec3i origin, std::int32_t edge) const override {
        Box positions;
        for (int corner = 0; corner < 8; ++corner)
            positions.include(
                map_(origin + Vec3i{corner & 1 ? edge - 1 : 0, corner & 2 ? edge - 1 : 0,
                                    corner & 4 ? edge - 1 : 0}));
        return is_far(positions.lower) || is_far(positions.upper) ? far_tile(positions)
                                                                  : near_tile(positions);
    }

  private:
    static Numbers numbers(const Value& value) {
        if constexpr (kComponents == 3)
            return {static_cast<double>(value[0]), static_cast<double>(value[1]),
                    static_cast<double>(value[2])};
        else
            return {static_cast<double>(value)};
    }
    /// Numbers along the world's axes; beyond float's range infinite.
    std::array<float, 3> in_world(const Numbers& value) const {
        if constexpr (kComponents == 1) {
            return {density(value[0])};
        } else {
            Vec3d v{value[0], value[1], value[2]};
            if (!field_.world_from_vector.identity()) v = field_.world_from_vector(v);
            return {density(v.x), density(v.y), density(v.z)};
        }
    }
    void put(const Numbers& value, bool covered, int voxel, LeafSamples& samples) const {
        const auto at = static_cast<std::size_t>(voxel);
        const std::array<float, 3> numbers = in_world(value);
        for (std::size_t c = 0; c < kComponents; ++c) samples.value[c][at] = numbers[c];
        if (covered) samples.covered[at >> 6] |= std::uint64_t{1} << (at & 63);
    }
    /// Samples a leaf at voxels of the grid, from `first` on.
    void sample_voxels(const Accessor& accessor, const Leaf& leaf, const openvdb::Coord& first,
                       LeafSamples& samples) const {
        // A node of the grid that has all of them, as most grids of one file do.
        const bool aligned = ((first.x() | first.y() | first.z()) & (kLeafEdge - 1)) == 0;
        const auto* node = aligned && !staggered_ ? accessor.probeConstLeaf(first) : nullptr;
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            if (node) {
                const auto at = static_cast<openvdb::Index>(n);
                const bool active = node->isValueOn(at);
                put(stored(node->getValue(at), active), active, n, samples);
                continue;
            }
            const openvdb::Coord index = first + to_coord(offset_index(n));
            Value value;
            const bool active = accessor.probeValue(index, value);
            put(staggered_ ? face_mean(accessor, index, value, active) : stored(value, active),
                active, n, samples);
        }
    }
    void sample_positions(const Accessor& accessor, const Leaf& leaf, LeafSamples& samples) const {
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const Vec3d p = map_(leaf.origin + offset_index(n));
            const bool covered = !is_far(p) && accessor.isValueOn(nearest(p));
            put(sample(accessor, p), covered, n, samples);
        }
    }
    /// Mean of the active faces of a voxel; the background without one.
    /// value, active  of the voxel itself: its lower faces
    Numbers face_mean(const Accessor& accessor, const openvdb::Coord& index, const Value& value,
                      bool active) const {
        const Numbers lower = stored(value, active);
        Numbers mean = lower;
        for (std::size_t c = 0; c < kComponents; ++c) {
            openvdb::Coord next = index;
            next[c] += 1;
            Value above;
            if (!accessor.probeValue(next, above)) continue;
            const double upper = numbers(above)[c];
            mean[c] = active ? 0.5 * lower[c] + 0.5 * upper : upper;
        }
        return mean;
    }
    Numbers stored(const Value& value, bool active) const {
        return active || field_.level_set ? numbers(value) : background_;
    }
    Numbers sample(const Accessor& accessor, Vec3d p) const {
        if (is_far(p)) return background_;
        if (!staggered_) return linear(accessor, p);
        Numbers value{};
        for (int c = 0; c < static_cast<int>(kComponents); ++c) {
            Vec3d face = p;
            face[c] += 0.5;
            const auto component = static_cast<std::size_t>(c);
            value[component] = linear(accessor, face)[component];
        }
        return value;
    }
    /// Interpolates. Inactive faces of staggered grids are left out where another is active: files
    /// that are cut to the density lack the upper faces of its last voxels.
    Numbers linear(const Accessor& accessor, Vec3d p) const {
        const Between x(p.x), y(p.y), z(p.z);
        Numbers sum{};
        double active_weight = 0;
        const openvdb::Coord first(x.index, y.index, z.index);
        constexpr int kLast = kLeafEdge - 1;
        const bool in_one_leaf =
            (x.index & kLast) < kLast && (y.index & kLast) < kLast && (z.index & kLast) < kLast;
        const auto* node = in_one_leaf ? accessor.probeConstLeaf(first) : nullptr;
        for (int corner = 0; corner < 8; ++corner) {
            const bool dx = corner & 1, dy = corner & 2, dz = corner & 4;
            const double weight = (dx ? x.second : 1 - x.second) * (dy ? y.second : 1 - y.second) *
                                  (dz ? z.second : 1 - z.second);
            if (weight == 0) continue;
            Value value;
            bool active;
            const openvdb::Coord index(x.index + dx, y.index + dy, z.index + dz);
            if (node) {
                const openvdb::Index n = node->coordToOffset(index);
                value = node->getValue(n);
                active = node->isValueOn(n);
            } else {
                active = accessor.probeValue(index, value);
            }
            if (staggered_ && !active) continue;
            active_weight += weight;
            const Numbers corner_value = stored(value, active);
            for (std::size_t c = 0; c < kComponents; ++c) sum[c] += weight * corner_value[c];
        }
        if (!staggered_) return sum;
        if (active_weight == 0) return background_;
        for (double& number : sum) number /= active_weight;
        return sum;
    }

    /// Tile outside the range of indices, or partly: no tree of OpenVDB reaches as far.
    TileSample far_tile(const Box& positions) const {
        const Box box{
            {std::max(positions.lower.x, -kFarthest), std::max(positions.lower.y, -kFarthest),
             std::max(positions.lower.z, -kFarthest)},
            {std::min(positions.upper.x, kFarthest), std::min(positions.upper.y, kFarthest),
             std::min(positions.upper.z, kFarthest)}};
        if (!box.empty()) {
            const TileSample within = near_tile(box);
            if (within.varies || within.covered > 0 || within.value != in_world(background_))
                return {true, {}, 0};
        }
        return {false, in_world(background_), 0};
    }
    /// One visit of all nodes that interpolation reads, and one of those at the voxels themselves.
    TileSample near_tile(const Box& positions) const {
        const auto box = [](const Box& b) {
            return openvdb::CoordBBox(
                openvdb::Coord::floor(openvdb::Vec3d(b.lower.x, b.lower.y, b.lower.z)),
                openvdb::Coord::ceil(openvdb::Vec3d(b.upper.x, b.upper.y, b.upper.z)));
        };
        Box read = positions;
        if (staggered_) read.upper = read.upper + Vec3d{0.5, 0.5, 0.5};
        std::optional<Numbers> first;
        const bool constant =
            for_each_region(grid_.tree(), box(read),
                            [&](const openvdb::CoordBBox&, const Value& value, bool active) {
                                const Numbers one = stored(value, active);
                                if (!first) first = one;
                                return same(*first, one);
                            });
        if (!constant || !first) return {true, {}, 0};
        const openvdb::CoordBBox inside = box(positions);
        double covered = 0;
        for_each_region(grid_.tree(), inside,
                        [&](const openvdb::CoordBBox& region, const Value&, bool active) {
                            if (active) covered += size(region);
                            return true;
                        });
        return {false, in_world(*first), covered / size(inside)};
    }
    static double size(const openvdb::CoordBBox& box) {
        const openvdb::Coord dim = box.dim();
        return double(dim.x()) * double(dim.y()) * double(dim.z());
    }
    static bool same(const Numbers& a, const Numbers& b) {
        for (std::size_t c = 0; c < kComponents; ++c)
            if (a[c] != b[c] && !(std::isnan(a[c]) && std::isnan(b[c]))) return false;
        return true;
    }

    const FieldGrid& field_;
    const GridT& grid_;
    const IndexMap map_;
    const Numbers background_;
    const bool staggered_;
};

}  // namespace

std::unique_ptr<FieldSampler> make_sampler(const FieldGrid& field, const Volume& volume) {
    std::unique_ptr<FieldSampler> sampler;
    field.grid->apply<KnownGrids>([&]<class GridT>(const GridT& grid) {
        sampler = std::make_unique<GridSampler<GridT>>(field, grid, volume);
    });
    if (!sampler)
        throw Error(fmt::format("{}: holds {}, expected numbers or vectors", field.where,
                                short_type(field.grid->type())));
    return sampler;
}

}  // namespace vog::field_files
