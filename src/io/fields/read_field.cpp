// read_field.cpp: a field at the voxels of its measure: division of tiles, sampling, checks, range.
#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"
#include "io/fields/field_sampler.h"
#include "io/fields/tile_division.h"
#include "io/vdb/vdb_density.h"
#include "vog/error.h"
#include "vog/text.h"
#include "vog/units.h"
#include "vog/voxel_field.h"

namespace vog {

using namespace field_files;

namespace {

/// Samples of a leaf or tile: the mass and voxels where the grid is active, values that are not
/// finite, the range of the others.
struct SampleCensus {
    double mass = 0, covered_mass = 0;  ///< sums of density
    double voxels = 0, covered = 0;
    std::uint64_t not_finite = 0;
    Vec3i first;  ///< index of the first value that is not finite
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;

    /// Includes the samples of `voxel_count` voxels at once.
    void include(std::span<const float> value, double density, double voxel_count,
                 double covered_share, Vec3i index) {
        mass += density * voxel_count;
        covered_mass += density * voxel_count * covered_share;
        voxels += voxel_count;
        covered += voxel_count * covered_share;
        double size = value.size() == 1
                          ? double{value[0]}
                          : length(Vec3d{double{value[0]}, double{value[1]}, double{value[2]}});
        if (!std::isfinite(size)) {
            if (not_finite == 0) first = index;
            not_finite += static_cast<std::uint64_t>(voxel_count);
            return;
        }
        lower = std::min(lower, size);
        upper = std::max(upper, size);
    }
    void add(const SampleCensus& other) {
        mass += other.mass;
        covered_mass += other.covered_mass;
        voxels += other.voxels;
        covered += other.covered;
        if (not_finite == 0) first = other.first;
        not_finite += other.not_finite;
        lower = std::min(lower, other.lower);
        upper = std::max(upper, other.upper);
    }
};

std::string measure_name(const Volume& volume) {
    return volume.name.empty() ? "the volume" : fmt::format("'{}'", printable(volume.name));
}

void divide_where_varied(const FieldGrid& grid, const FieldSampler& sampler, Volume& volume,
                         std::span<VoxelField> others) {
    const auto division = divide_tiles(volume.tiles, [&](Vec3i origin, std::int32_t edge) {
        return sampler.tile(origin, edge).varies;
    });
    if (!division)
        throw Error(
            fmt::format("{}: varies inside the tiles of {}: more than {} voxels or {} tiles to "
                        "divide them into, expected fewer tiles",
                        grid.where, measure_name(volume), count_text(kMaxDividedVoxels),
                        count_text(kMaxDividedTiles)));
    apply_division(*division, volume, others);
}

/// Fills field.component at leaves; returns one census a leaf.
BigVector<SampleCensus> sample_leaves(const FieldSampler& sampler, const Volume& volume,
                                      VoxelField& field) {
    for (VoxelValues& values : field.component) resize_kept(values.leaf, volume.leaves.size());
    BigVector<SampleCensus> found;
    resize_kept(found, volume.leaves.size());
    const std::size_t components = sampler.components();
    const auto receive = [&](std::size_t n, const LeafSamples& samples) {
        const Leaf& leaf = volume.leaves[n];
        for (std::size_t c = 0; c < components; ++c) field.component[c].leaf[n] = samples.value[c];
        for (int offset = 0; offset < kLeafVoxels; ++offset) {
            if (!leaf.active(offset)) continue;
            const auto at = static_cast<std::size_t>(offset);
            std::array<float, 3> value{};
            for (std::size_t c = 0; c < components; ++c) value[c] = samples.value[c][at];
            const bool covered = (samples.covered[at >> 6] >> (at & 63)) & 1;
            found[n].include({value.data(), components}, double{leaf.value[at]}, 1, covered ? 1 : 0,
                             leaf.origin + vdb::offset_index(offset));
        }
    };
    constexpr std::size_t kLeavesPerTask = 16;
    vog::parallel_for(tbb::blocked_range<std::size_t>(0, volume.leaves.size(), kLeavesPerTask),
                      [&](const auto& range) {
                          sampler.leaves({volume.leaves.data() + range.begin(), range.size()},
                                         [&](std::size_t i, const LeafSamples& samples) {
                                             receive(range.begin() + i, samples);
                                         });
                      });
    return found;
}

/// Fills field.component at tiles, inside which the field does not vary.
std::vector<SampleCensus> sample_tiles(const FieldSampler& sampler, const Volume& volume,
                                       VoxelField& field) {
    for (VoxelValues& values : field.component) values.tile.resize(volume.tiles.size());
    std::vector<SampleCensus> found(volume.tiles.size());
    vog::parallel_for(std::size_t{0}, volume.tiles.size(), [&](std::size_t n) {
        const Tile& tile = volume.tiles[n];
        const TileSample sample = sampler.tile(tile.origin, tile.edge);
        for (std::size_t c = 0; c < field.component.size(); ++c)
            field.component[c].tile[n] = sample.value[c];
        const double edge = tile.edge;
        found[n].include({sample.value.data(), field.component.size()}, double{tile.value},
                         edge * edge * edge, sample.covered, tile.origin);
    });
    return found;
}

Box world_box_of(const FieldGrid& field) {
    const openvdb::CoordBBox box = field.grid->evalActiveVoxelBoundingBox();
    if (box.empty()) return {};
    const Vec3d half{0.5, 0.5, 0.5};
    return transformed(field.world_from_index,
                       {vec_cast<double>(vdb::from_coord(box.min())) - half,
                        vec_cast<double>(vdb::from_coord(box.max())) + half});
}

std::string text_of(const Box& box) {
    if (box.empty()) return "nothing";
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}] to [{:.6g}, {:.6g}, {:.6g}]", box.lower.x,
                       box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
}

/// throws vog::Error for values that are not finite
void check_samples(const SampleCensus& census, const FieldGrid& grid, const Volume& volume) {
    if (census.not_finite > 0)
        throw Error(
            fmt::format("{}: not finite at {} voxels of {}, the first at index [{}, {}, {}], "
                        "expected finite values there",
                        grid.where, count_text(census.not_finite), measure_name(volume),
                        census.first.x, census.first.y, census.first.z));
}

/// throws vog::Error for a grid that covers nothing
void check_covered(const SampleCensus& census, const FieldGrid& grid, const Volume& volume) {
    if (census.covered == 0)
        throw Error(
            fmt::format("{}: active at no voxel of {}: {} of the world, which lies in {}; expected "
                        "grids that overlap",
                        grid.where, measure_name(volume), text_of(world_box_of(grid)),
                        text_of(world_box(volume))));
}

}  // namespace

VoxelField field_files::sampled_field(const FieldGrid& grid, Volume& volume,
                                      std::span<VoxelField> others, std::vector<std::string>* notes,
                                      FieldCoverage* coverage) {
    return vdb::with_vdb_errors(grid.where, [&] {
        require_same_length(grid.length_unit, grid.where, volume.units.length,
                            measure_name(volume));
        const std::unique_ptr<FieldSampler> sampler = make_sampler(grid, volume);
        divide_where_varied(grid, *sampler, volume, others);

        VoxelField field;
        field.name = grid.name;
        field.unit = grid.unit;
        field.component.resize(sampler->components());
        SampleCensus census;
        for (const SampleCensus& leaf : sample_leaves(*sampler, volume, field)) census.add(leaf);
        for (const SampleCensus& tile : sample_tiles(*sampler, volume, field)) census.add(tile);
        check_samples(census, grid, volume);
        field.lower = census.lower;
        field.upper = census.upper;
        if (!field.is_vector()) field.counts = value_counts(volume, field.component.front());
        const FieldCoverage counts{grid.where,          measure_name(volume), census.mass,
                                   census.covered_mass, census.voxels,        census.covered};
        // Several fields, or volumes, may have one file.
        if (notes && !grid.note.empty() && std::ranges::find(*notes, grid.note) == notes->end())
            notes->push_back(grid.note);
        if (coverage) {
            *coverage = counts;
            return field;
        }
        check_covered(census, grid, volume);
        if (const std::string note = coverage_note(counts); notes && !note.empty())
            notes->push_back(note);
        return field;
    });
}

void FieldCoverage::add(const FieldCoverage& other) {
    if (grid.empty()) grid = other.grid, volume = other.volume;
    mass += other.mass, covered_mass += other.covered_mass;
    voxels += other.voxels, covered_voxels += other.covered_voxels;
}

std::string coverage_note(const FieldCoverage& coverage) {
    if (coverage.covered_voxels == 0)
        throw Error(fmt::format("{}: active at no voxel of {}, expected grids that overlap",
                                coverage.grid, coverage.volume));
    // Grids of one simulation often lack a few faint voxels that the others have.
    constexpr double kLeastShare = 1e-3;
    const bool massive = coverage.mass > 0;
    const double share = massive ? 1 - coverage.covered_mass / coverage.mass
                                 : 1 - coverage.covered_voxels / coverage.voxels;
    if (share < kLeastShare) return {};
    const std::string percent = share < 0.995 ? fmt::format("{:.2g}", 100 * share) : "100";
    return fmt::format(
        "{}: inactive at {} % of the {} of {}; the field has its background value there",
        coverage.grid, percent, massive ? "mass" : "voxels", coverage.volume);
}

std::string field_name(const FieldSource& source) { return name_of(source); }

VoxelField read_field(const FieldSource& source, Volume& volume, std::span<VoxelField> others,
                      std::vector<std::string>* notes, FieldCoverage* coverage) {
    if (volume.empty())
        throw Error(
            fmt::format("{}: a field of a volume without active voxels", source.file.string()));
    return sampled_field(load_field_grid(source), volume, others, notes, coverage);
}

}  // namespace vog
