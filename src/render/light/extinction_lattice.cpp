// extinction_lattice.cpp: Sums of extinction over the cells of a lattice.
#include "render/light/extinction_lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "data/cells/cell_moments.h"
#include "render/by_value/slab_moments.h"
#include "render/by_value/value_pieces.h"
#include "render/reference/fields/field_grid.h"
#include "vog/distributed.h"

namespace vog::lights {

using namespace by_value;

namespace {

/// A Gaussian and its field on a lattice, widened by the size of a cell: its samples at the centres of cells then vary little.
/// Lengths are in cells.
struct LatticeGaussian {
    Vec3d mean{};            ///< from the centre of the first
    Mat3 form{};             ///< inverse covariance
    Vec3i lower{}, upper{};  ///< cells within its reach, the last included
    double density = 0;      ///< factor of its samples
    double share = 0;        ///< of the field's range, at the mean
    Vec3d slope{};           ///< change of the mean share with the place
    Residual within{};
    Vec3d gradient{};  ///< of the share, per world unit

    /// Calls visit(x, y, density, share) for the cells of a layer.
    template <class Visit>
    void each_cell(int z, const Visit& visit) const {
        for (int y = lower.y; y <= upper.y; ++y)
            for (int x = lower.x; x <= upper.x; ++x) {
                const Vec3d d{x - mean.x, y - mean.y, z - mean.z};
                visit(x, y, density * std::exp(-0.5 * dot(d, form * d)), share + dot(slope, d));
            }
    }
};

LatticeGaussian on_lattice(const Gaussians& gaussians, const ScalarField& field,
                           const ValueRange& range, std::size_t i,
                           const ExtinctionLattice& lattice) {
    constexpr double kReach = 3, kCellVariance = 1.0 / 12;
    LatticeGaussian out;
    const double per = 1 / lattice.edge;
    const Vec3d s = per * vec_cast<double>(gaussians.scale[i]);
    const Mat3 axes = gaussians.rotation.empty() ? Mat3{} : matrix_from_quat(gaussians.rotation[i]);
    Mat3 own, widened;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            own(r, c) = 0;
            for (int k = 0; k < 3; ++k) own(r, c) += axes(r, k) * s[k] * s[k] * axes(c, k);
            widened(r, c) = own(r, c) + (r == c ? kCellVariance : 0);
        }
    out.form = inverse(widened);
    out.mean = per * (world_mean(gaussians, i) - lattice.first);
    const double reach = std::min(double{gaussians.cutoff}, kReach);
    for (int axis = 0; axis < 3; ++axis) {
        const double half = reach * std::sqrt(widened(axis, axis)), last = lattice.size[axis] - 1;
        out.lower[axis] =
            static_cast<int>(std::clamp(std::ceil(out.mean[axis] - half), 0.0, last + 1));
        out.upper[axis] =
            static_cast<int>(std::clamp(std::floor(out.mean[axis] + half), -1.0, last));
        if (out.lower[axis] > out.upper[axis]) return {};
    }
    // Of the place within the Gaussian a cell knows the mean, and the plane spreads its values by the rest.
    const Vec3d gradient =
        lattice.edge / (range.upper - range.lower) * vec_cast<double>(field.gradient[i]);
    const Vec3d along = own * gradient;
    out.slope = out.form * along;
    out.share = range.share(double{field.value[i]});
    out.within = residual_of(field, range, i);
    out.gradient = 1 / lattice.edge * gradient;
    out.within.variance += std::max(dot(gradient, along) - dot(along, out.slope), 0.0);
    double whole = 0;
    out.density = 1;
    for (int z = out.lower.z; z <= out.upper.z; ++z)
        out.each_cell(z, [&](int, int, double value, double) { whole += value; });
    const double cell = lattice.edge * lattice.edge * lattice.edge;
    out.density = whole > 0 ? mass(gaussians, i) / (cell * whole) : 0;
    return out;
}

/// Adds a point to the eight cells around it, by its distance from their centres.
void add_point(ExtinctionLattice& lattice, Vec3d place, double mass) {
    int cell[3];
    double beyond[3];
    for (int axis = 0; axis < 3; ++axis) {
        if (!(place[axis] > -1 && place[axis] < lattice.size[axis])) return;
        const double floor = std::floor(place[axis]);
        cell[axis] = static_cast<int>(floor), beyond[axis] = place[axis] - floor;
    }
    for (int corner = 0; corner < 8; ++corner) {
        double weight = mass;
        Vec3i at;
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const int next = corner >> axis & 1;
            at[axis] = cell[axis] + next;
            weight *= next ? beyond[axis] : 1 - beyond[axis];
            inside = inside && at[axis] >= 0 && at[axis] < lattice.size[axis];
        }
        if (inside) lattice.sum[lattice.at(at.x, at.y, at.z)] += weight;
    }
}

/// Voxels, or a tile, of one extinction as points at most half a cell apart.
class VoxelPoints {
  public:
    VoxelPoints(const Volume& volume, const ExtinctionLattice& lattice, int edge)
        : volume_(volume), first_(lattice.first), per_(1 / lattice.edge) {
        const Mat3& linear = volume.world_from_index.linear;
        count_ = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double length = edge * vog::length(linear.column(axis));
            parts_[axis] = std::max(1, static_cast<int>(std::ceil(2 * length * per_)));
            step_[axis] = edge / double(parts_[axis]);
            count_ *= parts_[axis];
        }
        const double cell = lattice.edge * lattice.edge * lattice.edge;
        share_ = voxel_volume(volume) * std::pow(edge, 3) / cell / count_;
    }
    void add(Vec3i lower, double extinction, ExtinctionLattice& to) const {
        if (!(extinction > 0)) return;
        for (int x = 0; x < parts_[0]; ++x)
            for (int y = 0; y < parts_[1]; ++y)
                for (int z = 0; z < parts_[2]; ++z) {
                    const Vec3d index{lower.x - 0.5 + (x + 0.5) * step_[0],
                                      lower.y - 0.5 + (y + 0.5) * step_[1],
                                      lower.z - 0.5 + (z + 0.5) * step_[2]};
                    add_point(to, per_ * (volume_.world_from_index(index) - first_),
                              share_ * extinction);
                }
    }

  private:
    const Volume& volume_;
    Vec3d first_;
    double per_, share_ = 1;
    double step_[3];
    int parts_[3], count_;
};

/// Adds items in a few parts, summed in one order: the same sums for any number of threads.
/// add(n, to)  adds item n
template <class Add>
void add_in_parts(std::size_t count, ExtinctionLattice& lattice, const Add& add) {
    constexpr std::size_t kParts = 4;
    std::vector<ExtinctionLattice> parts(kParts, lattice);
    vog::parallel_for(std::size_t{0}, kParts, [&](std::size_t part) {
        std::ranges::fill(parts[part].sum, 0.0);
        for (std::size_t n = part * count / kParts; n < (part + 1) * count / kParts; ++n)
            add(n, parts[part]);
    });
    for (const ExtinctionLattice& part : parts)
        for (std::size_t n = 0; n < lattice.sum.size(); ++n) lattice.sum[n] += part.sum[n];
}

}  // namespace

/// Cells of empty space on each side: averages reach into the first.
constexpr int kMargin = 2;

ExtinctionLattice::ExtinctionLattice(const Box& box, int most_cells) : cells(most_cells) {
    const Vec3d extent = box.empty() ? Vec3d{} : box.upper - box.lower;
    const double longest = std::max({extent.x, extent.y, extent.z});
    edge = longest > 0 ? longest / cells : 1;
    const Vec3d middle = box.empty() ? Vec3d{} : 0.5 * (box.lower + box.upper);
    std::size_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        size[axis] = static_cast<int>(std::ceil(extent[axis] / edge * (1 - 1e-9))) + 2 * kMargin;
        first[axis] = middle[axis] - 0.5 * edge * (size[axis] - 1);
        count *= static_cast<std::size_t>(size[axis]);
    }
    sum.resize(count);
}

void ExtinctionLattice::clip(const Clipping& clip) {
    if (clip.empty()) return;
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y) {
            const RayInterval stays =
                clipped_ray(clip, first + edge * Vec3d{0, double(y), double(z)}, {edge, 0, 0});
            for (int x = 0; x < size.x; ++x)
                if (!(stays.first < stays.last) || x < stays.first || x > stays.last) {
                    sum[at(x, y, z)] = 0;
                    if (!whole.empty()) whole[at(x, y, z)] = 0;
                }
        }
}

void add_extinction(const Gaussians& gaussians, const ScalarField& field,
                    const LightOfMoments& light, double unit, const Collective* processes,
                    ExtinctionLattice& lattice) {
    lattice.surfaces |= light.surface();
    const ValueRange& range = light.range();
    std::vector<LatticeGaussian> all(gaussians.size());
    vog::parallel_for(std::size_t{0}, gaussians.size(), [&](std::size_t i) {
        all[i] = on_lattice(gaussians, field, range, i, lattice);
    });
    // A layer by one thread: the same sums for any number of threads.
    std::vector<std::vector<std::uint32_t>> layers(static_cast<std::size_t>(lattice.size.z));
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].density > 0)
            for (int z = all[i].lower.z; z <= all[i].upper.z; ++z)
                layers[static_cast<std::size_t>(z)].push_back(static_cast<std::uint32_t>(i));
    const device::MeanLight mixed = light.mean_light();
    const std::size_t channels = mixed.gradient.any() ? 7 : 4;
    std::vector<double> sums(channels * lattice.sum.size());
    vog::parallel_for(0, lattice.size.z, [&](int z) {
        for (const std::uint32_t i : layers[static_cast<std::size_t>(z)])
            all[i].each_cell(z, [&](int x, int y, double density, double share) {
                MomentSums part;
                part.add(density, share, all[i].within);
                double* to = &sums[channels * lattice.at(x, y, z)];
                to[0] += part.tau, to[1] += part.first, to[2] += part.second, to[3] += part.third;
                for (int axis = 0; axis < 3 && channels == 7; ++axis)
                    to[4 + axis] += density * all[i].gradient[axis];
            });
    });
    if (processes) processes->sum(sums);
    device::MeanLight beside = mixed;
    beside.parts_per_cell =
        static_cast<float>(lattice.edge * lattice.cells / (device::kDepthCells * unit));
    if (lattice.whole.empty()) lattice.whole = lattice.sum;
    vog::parallel_for(std::size_t{0}, lattice.sum.size(), [&](std::size_t n) {
        const double* of = &sums[channels * n];
        const MomentSums cell{of[0], of[1], of[2], of[3],
                              channels == 7 ? Vec3d{of[4], of[5], of[6]} : Vec3d{}};
        if (!(cell.tau > 0)) return;
        device::ValueMoments moments = cell.moments();
        moments.gradient = moments.tau * moments.gradient;
        const auto extinction = [&](const device::MeanLight& by) {
            float mean[4];
            device::mean_light_of(by, moments, 1, mean);
            return cell.tau * double{mean[3]} / unit;
        };
        lattice.sum[n] += extinction(beside);
        lattice.whole[n] += extinction(mixed);
    });
}

void add_extinction(const Volume& volume, const VoxelField& field, const ValueTransfer& transfer,
                    ExtinctionLattice& lattice) {
    const ValuePieces pieces(transfer);
    lattice.surfaces |= has_surface(transfer);
    const VoxelValues& values = field.component.front();
    const bool own = values.leaf.empty() && values.tile.empty();
    std::optional<reference::FieldGrid> grid;
    if (pieces.has_gradient()) grid.emplace(volume, field, FieldPart::value);
    const auto by_gradient = [&](const reference::FieldCell& cell) {
        return grid ? pieces.factor(length(grid->gradient(cell))) : 1;
    };
    const auto extinction = [&](float density, float value) {
        const double of_value =
            pieces(own ? double{density} + field.background : double{value}).extinction;
        return own ? of_value : of_value * double{density};
    };
    const VoxelPoints points(volume, lattice, 1);
    add_in_parts(volume.leaves.size(), lattice, [&](std::size_t l, ExtinctionLattice& to) {
        const Leaf& leaf = volume.leaves[l];
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const auto offset = static_cast<std::size_t>(n);
            const float value = own ? 0 : values.leaf[l][offset], density = leaf.value[offset];
            const Vec3i index = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
            points.add(index,
                       extinction(density, value) *
                           by_gradient({double{density}, double{value}, false, index, {}}),
                       to);
        }
    });
    for (std::size_t t = 0; t < volume.tiles.size(); ++t) {
        const Tile& tile = volume.tiles[t];
        VoxelPoints(volume, lattice, tile.edge)
            .add(tile.origin, extinction(tile.value, own ? 0 : values.tile[t]) * pieces.factor(0),
                 lattice);
    }
}

void add_extinction(const Cells& cells, std::span<const std::uint32_t> kept,
                    const CellValues& values, const ValueTransfer& transfer,
                    ExtinctionLattice& lattice) {
    const ValuePieces pieces(transfer);
    lattice.surfaces |= has_surface(transfer);
    const bool own = &values == &cells.density;
    const double per_cell = 1 / (lattice.edge * lattice.edge * lattice.edge);
    add_in_parts(kept.size(), lattice, [&](std::size_t i, ExtinctionLattice& to) {
        unstructured::Shape shape = unstructured::shape_of(cells, kept[i]);
        const double mean = unstructured::set_values(shape, cells, kept[i], values)[0];
        unstructured::for_each_point(
            shape, 0.5 * lattice.edge,
            [&](Vec3d place, const unstructured::CellPoint& point, double volume) {
                const double extinction = pieces(mean + point.value[0]).extinction *
                                          (own ? 1 : std::max(point.density, 0.0));
                const Vec3d at = 1 / lattice.edge * (shape.centre + place - lattice.first);
                Vec3i cell;
                for (int axis = 0; axis < 3; ++axis)
                    cell[axis] = std::clamp(static_cast<int>(std::lround(at[axis])), 0,
                                            lattice.size[axis] - 1);
                to.sum[to.at(cell.x, cell.y, cell.z)] += per_cell * volume * extinction;
            });
    });
}

}  // namespace vog::lights
