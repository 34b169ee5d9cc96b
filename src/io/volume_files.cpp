// volume_files.cpp: choice of a reader by extension, and of grids by name patterns.
#include "vog/volume_io.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "data/volume_partition.h"
#include "io/file_extension.h"
#include "io/nvdb/nvdb_file.h"
#include "io/nvdb/nvdb_grid.h"
#include "io/scan/scan_file.h"
#include "io/scan/scan_volume.h"
#include "io/vdb/vdb_reader.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/scan_io.h"
#include "vog/voxel_field.h"

namespace vog {

using namespace nvdb;
using namespace scan;
using namespace vdb;

namespace {

bool is_pattern(const std::string& name) { return name.find_first_of("*?") != std::string::npos; }
bool has_star(const std::string& name) { return name.find('*') != std::string::npos; }

/// Whether a name matches a pattern, where * stands for any text and ? for any byte. A mismatch
/// goes back to the latest * alone, which takes one byte more: a longer text for an earlier *
/// leaves less for the rest. Not fnmatch: brackets and backslashes stand for themselves.
/// cost  O(pattern * name)
bool matches(std::string_view pattern, std::string_view name) {
    constexpr std::size_t kNone = std::string_view::npos;
    std::size_t p = 0, n = 0, star = kNone, star_end = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            star_end = n;
        } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
            ++p, ++n;
        } else if (star != kNone) {
            p = star + 1;
            n = ++star_end;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == kNone;
}

/// Shortest text that the first * of a pattern stands for in a matching name; empty without a *.
std::string star_text(const std::string& pattern, const std::string& name) {
    const std::size_t star = pattern.find('*');
    if (star == std::string::npos) return {};
    const std::string_view after = std::string_view(pattern).substr(star + 1);
    std::size_t end = star;
    while (!matches(after, std::string_view(name).substr(end))) ++end;
    return name.substr(star, end - star);
}

std::vector<std::string> matching_grids(const std::filesystem::path& file,
                                        const std::string& pattern) {
    const std::vector<std::string> all = grid_names(file);
    std::vector<std::string> some;
    std::ranges::copy_if(all, std::back_inserter(some),
                         [&](const std::string& name) { return matches(pattern, name); });
    if (some.empty())
        throw Error(fmt::format("{}: no grid matches '{}' (it has: {})", file.string(), pattern,
                                fmt::join(all, ", ")));
    return some;
}

/// Choice in a file where no grid is named.
/// levels  GridRequest::levels
DefaultGrid default_of(const std::filesystem::path& file, const VdbOptions& options, bool levels) {
    return is_nvdb(file)   ? nvdb::default_grid(file, options, levels)
           : is_scan(file) ? scan::default_grid(file, options)
                           : vdb::default_grid(file, options, levels);
}

/// throws vog::Error for a stated background of a file that has none
void check_background(const std::filesystem::path& file, const VdbOptions& options) {
    if (options.values.background && !options.mask && !is_scan(file))
        throw Error(
            fmt::format("{}: has no background value, expected a dense image (.nii, .nrrd, .mha, "
                        ".tif, ...) with --set background-value",
                        file.string()));
}

}  // namespace

Volume read_volume(const std::filesystem::path& file, const VdbOptions& options,
                   std::vector<std::string>* notes) {
    check_background(file, options);
    ValueNotes found;
    std::string departure;
    if (const std::string choice =
            notes && options.grid.empty() ? default_of(file, options, false).note : "";
        !choice.empty())
        notes->push_back(choice);
    Volume volume = is_nvdb(file)   ? read_nvdb(file, options, &found)
                    : is_scan(file) ? read_scan(file, options, &found, &departure)
                                    : read_vdb(file, options, &found);
    if (notes && !departure.empty()) notes->push_back(departure);
    const std::string text =
        values_text(found, fmt::format("{}: grid '{}'", file.string(), volume.name));
    if (notes && !text.empty()) notes->push_back(text);
    return volume;
}

std::vector<std::string> grid_names(const std::filesystem::path& file) {
    if (is_scan(file)) return scan_grid_names(file);
    return is_nvdb(file) ? nvdb_grid_names(file) : vdb_grid_names(file);
}

bool is_volume_file(const std::filesystem::path& file) {
    return is_nvdb(file) || is_scan(file) || stored_extension(file) == ".vdb";
}

std::vector<VolumeInfo> inspect_volume(const std::filesystem::path& file) {
    if (is_scan(file)) return inspect_scan(file);
    std::vector<VolumeInfo> all;
    for (const GridInfo& grid : is_nvdb(file) ? inspect_nvdb(file) : inspect_vdb(file))
        all.push_back({grid, {}, {}, {}, {}});
    return all;
}

struct VolumeReader::State {
    std::optional<VdbReader> vdb{};
    Volume whole{};  ///< for files without partial reading
    ValueNotes notes{};
};

VolumeReader::VolumeReader(const std::filesystem::path& file, const VdbOptions& options)
    : state_(std::make_unique<State>()) {
    check_background(file, options);
    if (is_nvdb(file))
        state_->whole = read_nvdb(file, options, &state_->notes);
    else if (is_scan(file))
        state_->whole = read_scan(file, options, &state_->notes);
    else
        state_->vdb.emplace(file, options);
}
VolumeReader::VolumeReader(const std::filesystem::path& file) : VolumeReader(file, VdbOptions{}) {}
VolumeReader::~VolumeReader() = default;
VolumeReader::VolumeReader(VolumeReader&&) noexcept = default;
VolumeReader& VolumeReader::operator=(VolumeReader&&) noexcept = default;

std::uint64_t VolumeReader::active_voxels() const {
    return state_->vdb ? state_->vdb->active_voxels() : vog::active_voxels(state_->whole);
}

std::size_t VolumeReader::leaf_count() const {
    return state_->vdb ? state_->vdb->leaf_count() : state_->whole.leaves.size();
}

Box VolumeReader::world_box() const {
    return state_->vdb ? state_->vdb->world_box() : vog::world_box(state_->whole);
}

const Affine& VolumeReader::world_from_index() const {
    return state_->vdb ? state_->vdb->world_from_index() : state_->whole.world_from_index;
}

Volume VolumeReader::read(const VolumePart& part, ValueNotes* notes) {
    ValueNotes found;
    Volume volume = state_->vdb ? state_->vdb->read(part, &found) : part_of(state_->whole, part);
    // Files that are read whole report their clamped values with the first part only.
    if (!state_->vdb && part.index == 0) found = state_->notes;
    if (notes) notes->add(found);
    return volume;
}

Volume VolumeReader::read_where(const NodeChoice& selected) {
    return state_->vdb ? state_->vdb->read_where(selected) : nodes_where(state_->whole, selected);
}

std::vector<LevelSource> level_sources(std::span<const std::filesystem::path> files,
                                       const LevelOptions& given, std::vector<std::string>* notes) {
    LevelOptions options = given;
    if (options.grid.empty() && !files.empty()) {
        // The first file decides for all: levels and parts of one quantity.
        const DefaultGrid first = default_of(files.front(),
                                             {.level_set_to_fog = options.level_set_to_fog,
                                              .refuse_several = options.refuse_several},
                                             true);
        if (!first.note.empty()) options.grid = first.name;
        if (notes && !first.note.empty()) notes->push_back(first.note);
    }
    const bool pattern = is_pattern(options.grid);
    if (!options.mask.empty() && (pattern || has_star(options.mask)) &&
        !(has_star(options.grid) && has_star(options.mask)))
        throw Error(fmt::format("grid '{}' and mask '{}': expected a * in both, or no pattern",
                                options.grid, options.mask));
    std::vector<LevelSource> sources;
    for (const std::filesystem::path& file : files) {
        std::vector<std::string> grids{options.grid};
        if (pattern) grids = matching_grids(file, options.grid);
        if (given.grid.empty() && !pattern && !options.grid.empty() &&
            !std::ranges::count(grid_names(file), options.grid))
            grids.front().clear();  // this file's own default
        for (const std::string& grid : grids) {
            std::string mask = options.mask;
            if (const std::size_t star = mask.find('*'); star != std::string::npos)
                mask.replace(star, 1, star_text(options.grid, grid));
            sources.push_back({file, grid, mask});
        }
    }
    return sources;
}

FieldSource field_of_level(const FieldSource& field, const std::string& pattern,
                           const LevelSource& level) {
    FieldSource source = field;
    if (source.file.empty()) source.file = level.file;
    const std::size_t star = source.grid.find('*');
    if (star == std::string::npos) return source;
    if (!has_star(pattern))
        throw Error(fmt::format("grid '{}' and field '{}': expected a * in both, or in neither",
                                pattern, source.grid));
    source.grid.replace(star, 1, star_text(pattern, level.grid));
    return source;
}

Levels read_levels(std::span<const std::filesystem::path> files, const LevelOptions& options,
                   std::vector<std::string>* notes) {
    Levels levels;
    for (const auto& [file, grid, mask] : level_sources(files, options, notes)) {
        levels.volumes.push_back(read_volume(file,
                                             {grid, options.level_set_to_fog, false, options.values,
                                              options.ones, options.refuse_several},
                                             notes));
        if (!mask.empty())
            levels.masks.push_back(read_volume(file, {mask, false, true, options.values}, notes));
    }
    return levels;
}

}  // namespace vog
