// scan_volume.cpp: conversion of dense images to leaves with active voxels.
#include "io/scan/scan_volume.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"
#include "io/scan/scan_background.h"
#include "io/scan/scan_file.h"
#include "io/vdb/vdb_density.h"
#include "vog/dense.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

using namespace vdb;

namespace {

constexpr std::size_t kLeavesPerTask = 64;

/// Leaves over an image, in the order of volumes: x, then y, then z.
struct LeafLattice {
    Vec3i size;   ///< voxels
    Vec3i count;  ///< leaves

    explicit LeafLattice(Vec3i voxels)
        : size(voxels), count{(voxels.x + 7) / 8, (voxels.y + 7) / 8, (voxels.z + 7) / 8} {}
    std::size_t leaves() const {
        return static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y) *
               static_cast<std::size_t>(count.z);
    }
    Vec3i origin(std::size_t n) const {
        const auto y = static_cast<std::size_t>(count.y), z = static_cast<std::size_t>(count.z);
        return {kLeafEdge * static_cast<std::int32_t>(n / (y * z)),
                kLeafEdge * static_cast<std::int32_t>(n / z % y),
                kLeafEdge * static_cast<std::int32_t>(n % z)};
    }
    /// Calls visit(offset in the leaf, value) for the voxels of a leaf inside the image.
    template <class Visit>
    void each_voxel(std::size_t n, const BigVector<float>& value, const Visit& visit) const {
        const Vec3i at = origin(n);
        const auto sx = static_cast<std::size_t>(size.x), sy = static_cast<std::size_t>(size.y);
        for (int z = 0; z < std::min(kLeafEdge, size.z - at.z); ++z)
            for (int y = 0; y < std::min(kLeafEdge, size.y - at.y); ++y) {
                const std::size_t row =
                    (static_cast<std::size_t>(at.z + z) * sy + static_cast<std::size_t>(at.y + y)) *
                        sx +
                    static_cast<std::size_t>(at.x);
                for (int x = 0; x < std::min(kLeafEdge, size.x - at.x); ++x)
                    visit(leaf_offset(x, y, z), value[row + static_cast<std::size_t>(x)]);
            }
    }
};

/// Whether some value is negative.
bool has_negative(const BigVector<float>& value) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, value.size(), 1 << 16), false,
        [&](const auto& range, bool found) {
            for (std::size_t n = range.begin(); n < range.end() && !found; ++n)
                found = value[n] < 0;
            keep_memory();
            return found;
        },
        [](bool a, bool b) { return a || b; });
}

/// Leaves of the active voxels of an image.
/// where  start of messages
Volume volume_of(const ScanGrid& grid, const BigVector<float>& value, const std::string& where,
                 const VdbOptions& options, ValueNotes& notes) {
    const LeafLattice lattice(grid.size);
    const bool all = options.ones && has_negative(value);
    const auto active = [&](float v) {
        if (!std::isfinite(v)) return false;
        return options.ones ? all || v != 0 : v > 0;
    };
    BigVector<std::uint8_t> used;
    resize_kept(used, lattice.leaves());
    const Census census = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, used.size(), kLeavesPerTask), Census{},
        [&](const auto& range, Census found) {
            for (std::size_t n = range.begin(); n < range.end(); ++n) {
                keep_memory();
                used[n] = 0;
                const Vec3i origin = lattice.origin(n);
                lattice.each_voxel(n, value, [&](int offset, float v) {
                    found.admit(v, n * kLeafVoxels + static_cast<std::size_t>(offset),
                                origin + offset_index(offset));
                    if (active(v)) used[n] = 1;
                });
            }
            return found;
        },
        Census::sum);
    check_census(census, value_rules(options), where, notes);

    std::vector<std::size_t> kept;
    for (std::size_t n = 0; n < used.size(); ++n)
        if (used[n]) kept.push_back(n);
    Volume volume;
    volume.world_from_index = grid.world_from_index;
    volume.standing = grid.standing;
    volume.units = {grid.length_unit, options.ones || options.mask ? "" : grid.value_unit};
    resize_kept(volume.leaves, kept.size());
    vog::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t i) {
        Leaf& leaf = volume.leaves[i];
        leaf.origin = lattice.origin(kept[i]);
        lattice.each_voxel(kept[i], value, [&](int offset, float v) {
            if (active(v)) leaf.set(offset, v);
        });
    });
    if (options.ones) set_ones(volume, notes);
    if (options.mask) {
        keep_positive(volume);
        notes = {};
    }
    return volume;
}

std::string where_of(const std::filesystem::path& file, const ScanGrid& grid) {
    return fmt::format("{}: grid '{}'", file.string(), grid.name);
}

/// Adds to the file's note that single precision has not all whole numbers of a grid.
void note_rounded(const ScanGrid& grid, const BigVector<float>& value, std::string& note) {
    constexpr float kMost = 1 << 24;
    if (grid.type.find("int32") == std::string::npos &&
        grid.type.find("int64") == std::string::npos)
        return;
    if (std::ranges::none_of(value, [](float v) { return std::abs(v) > kMost; })) return;
    note += fmt::format(
        "{}whole numbers beyond {} are rounded to single precision, and labels that large may be "
        "one",
        note.empty() ? "" : "; ", kMost);
}

std::string note_of(const std::filesystem::path& file, const ScanFile& scan) {
    return scan.note.empty() ? scan.note
                             : printable(fmt::format("{}: {}", file.string(), scan.note));
}

template <class Run>
auto with_memory_errors(const std::filesystem::path& file, const Run& run) {
    try {
        return run();
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format("{}: not enough memory", file.string()));
    } catch (const std::length_error&) {
        throw Error(fmt::format("{}: not enough memory", file.string()));
    }
}

/// Values of the file, and voxels above its background.
GridInfo info_of(const std::filesystem::path& file, const ScanGrid& grid, BigVector<float> value,
                 double background) {
    const bool all = has_negative(value);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const float v : value)
        if (std::isfinite(v) && (all || v != 0)) {
            low = std::min(low, double{v});
            high = std::max(high, double{v});
        }
    if (background != 0) subtract_background(background, value);
    ValueNotes notes;
    const Volume volume = volume_of(grid, value, where_of(file, grid), {.ones = true}, notes);
    GridInfo info;
    info.name = grid.name;
    info.type = grid.type;
    info.grid_class = "dense image";
    info.active_voxels = active_voxels(volume);
    info.leaves = volume.leaves.size();
    info.world_from_index = grid.world_from_index;
    info.memory_bytes = volume.leaves.size() * sizeof(Leaf);
    for (const Leaf& leaf : volume.leaves) info.dense_leaves += leaf.dense();
    if (volume.empty()) return info;
    const IndexBox box = active_box(volume);
    info.lower = box.lower;
    info.upper = box.upper;
    const Vec3d half{0.5, 0.5, 0.5};
    info.world = transformed(grid.world_from_index, {vec_cast<double>(box.lower) - half,
                                                     vec_cast<double>(box.upper) + half});
    info.min = low;
    info.max = high;
    return info;
}

}  // namespace

Volume read_scan(const std::filesystem::path& file, const VdbOptions& options, ValueNotes* notes,
                 std::string* departure) {
    return with_memory_errors(file, [&] {
        ScanFile scan = open_scan(file);
        const std::size_t n = chosen_grid(scan, file, {options.grid, options.refuse_several});
        const ScanGrid& grid = scan.grids[n];
        const std::string where = where_of(file, grid);
        if (options.level_set_to_fog && !options.ones)
            throw Error(
                fmt::format("{}: a dense image, expected a level set to convert to fog", where));
        ValueNotes found;
        BigVector<float> value = scan.read(n);
        note_rounded(grid, value, scan.note);
        double background = 0;
        if (!options.ones && !options.mask)
            background = options.values.background      ? *options.values.background
                         : options.values.clip_negative ? 0
                                                        : background_of(grid, value);
        if (background != 0) subtract_background(background, value);
        Volume volume = volume_of(grid, value, where, options, found);
        if (background != 0 && !options.values.background) found.background = background;
        if (volume.empty())
            throw Error(fmt::format("{}: no voxel above {}{}", where, background,
                                    options.mask ? ", expected a mask" : ", expected density"));
        volume.name = grid.name;
        volume.background = background;
        volume.is_image = !options.ones;
        volume.source = printable(file.string());
        if (notes) *notes = found;
        if (departure) *departure = note_of(file, scan);
        return volume;
    });
}

std::vector<std::string> scan_grid_names(const std::filesystem::path& file) {
    std::vector<std::string> names;
    for (const ScanGrid& grid : open_scan(file).grids) names.push_back(grid.name);
    return names;
}

DefaultGrid default_grid(const std::filesystem::path& file, const VdbOptions& options) {
    DefaultGrid answer;
    chosen_grid(open_scan(file), file, {{}, options.refuse_several}, &answer);
    return answer;
}

std::vector<VolumeInfo> inspect_scan(const std::filesystem::path& file) {
    return with_memory_errors(file, [&] {
        const ScanFile scan = open_scan(file);
        std::vector<VolumeInfo> all;
        for (const ScanGrid& grid : scan.grids) {
            BigVector<float> value = scan.read(all.size());
            const double background = background_of(grid, value);
            std::string note = scan.note;
            note_rounded(grid, value, note);
            all.push_back({info_of(file, grid, std::move(value), background), grid.coordinates,
                           grid.length_unit, grid.value_unit, note, background});
        }
        return all;
    });
}

field_files::FieldGrid load_scan_field(const FieldSource& source) {
    return with_memory_errors(source.file, [&] {
        const ScanFile scan = open_scan(source.file);
        const std::size_t n = chosen_grid(scan, source.file, {source.grid, true});
        const ScanGrid& from = scan.grids[n];
        const BigVector<float> value = scan.read(n);
        using LeafT = openvdb::FloatGrid::TreeType::LeafNodeType;
        const LeafLattice lattice(from.size);
        std::vector<LeafT*> leaves(lattice.leaves());
        vog::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t leaf) {
            leaves[leaf] = new LeafT(to_coord(lattice.origin(leaf)), 0.0f, false);
            lattice.each_voxel(leaf, value, [&](int offset, float v) {
                leaves[leaf]->setValueOn(static_cast<openvdb::Index>(offset), v);
            });
        });
        const auto grid = openvdb::FloatGrid::create(0.0f);
        for (LeafT* leaf : leaves) grid->tree().addLeaf(leaf);  // the tree owns it
        field_files::FieldGrid field;
        field.grid = grid;
        field.world_from_index = from.world_from_index;
        field.name = from.name;
        field.unit = from.value_unit;
        field.length_unit = from.length_unit;
        field.where = where_of(source.file, from);
        field.note = note_of(source.file, scan);
        return field;
    });
}

std::string scan_field_name(const FieldSource& source) {
    const ScanFile scan = open_scan(source.file);
    return scan.grids[chosen_grid(scan, source.file, {source.grid, true})].name;
}

}  // namespace vog::scan

namespace vog {

VolumeHead volume_head(const std::filesystem::path& file, const std::string& grid) {
    if (!scan::is_scan(file)) return {};
    const scan::ScanFile opened = scan::open_scan(file);
    const scan::ScanGrid& one = opened.grids[scan::chosen_grid(opened, file, {grid})];
    const Mat3& map = one.world_from_index.linear;
    return {{length(map.column(0)), length(map.column(1)), length(map.column(2))},
            one.world_from_index.translation,
            one.length_unit,
            one.value_unit};
}

std::string volume_note(const std::filesystem::path& file) {
    return scan::is_scan(file) ? scan::note_of(file, scan::open_scan(file)) : std::string();
}

}  // namespace vog
