// vdb_read.cpp: choice of a grid in a .vdb file, and its reading as density, in parts or whole.
#include <fmt/core.h>

#include <optional>

#include "data/volume_partition.h"
#include "io/vdb/vdb_leaves.h"
#include "io/vdb/vdb_reader.h"
#include "io/vdb/vdb_volume.h"
#include "vog/volume_io.h"

namespace vog {

using namespace vdb;

const VdbEntry& vdb::chosen_entry(VdbFile& file, const GridRequest& request, DefaultGrid* answer,
                                  bool level_sets) {
    const auto kind_of = [](const VdbEntry& entry) {
        return is_scalar(entry.tree_type) ? ValueKind::numbers
               : entry.tree_type == openvdb::BoolGrid::gridType() ||
                       entry.tree_type == openvdb::MaskGrid::gridType()
                   ? ValueKind::switches
                   : ValueKind::others;
    };
    const auto size_of = [&](const VdbEntry& entry) -> double {
        try {
            openvdb::initialize();
            const VdbLeaves leaves(file, entry, {});
            const bool level_set = leaves.grid_class() == openvdb::GRID_LEVEL_SET;
            return level_set == level_sets ? static_cast<double>(leaves.active_voxels()) : 0;
        } catch (const Error&) {  // reported where this grid is read
            return 0;
        }
    };
    return chosen_of(file.entries(), file.name(), request, answer, kind_of, size_of);
}

DefaultGrid vdb::default_grid(const std::filesystem::path& path, const VdbOptions& options,
                              bool levels) {
    VdbFile file(path);
    DefaultGrid answer;
    chosen_entry(file, {{}, options.refuse_several, levels}, &answer, options.level_set_to_fog);
    return answer;
}

std::vector<std::string> vdb_grid_names(const std::filesystem::path& path) {
    const VdbFile file(path);
    std::vector<std::string> list;
    for (const VdbEntry& entry : file.entries()) list.push_back(entry.name);
    return list;
}

struct VdbReader::State {
    VdbOptions options;
    VdbFile file;
    const VdbEntry& entry;
    std::string where;
    std::optional<VdbLeaves> leaves;  ///< for partial reading; none: the whole grid is in `fog`
    Volume fog;
    ValueNotes notes;

    State(const std::filesystem::path& path, const VdbOptions& requested);
    void read_level_set();
    template <class Choose, class Part>
    Volume read(const Choose& of_file, const Part& of_fog, ValueNotes* returned_notes);
};

VdbReader::State::State(const std::filesystem::path& path, const VdbOptions& requested)
    : options(requested),
      file(path),
      entry(chosen_entry(file, {options.grid, options.refuse_several}, nullptr,
                         options.level_set_to_fog)),
      where(file.where(entry)) {
    if (options.level_set_to_fog) {
        read_level_set();
        return;
    }
    leaves.emplace(file, entry, options);
    if (leaves->grid_class() == openvdb::GRID_LEVEL_SET && !options.ones)
        throw Error(fmt::format(
            "{}: a level set, expected density (--level-set-to-fog converts it)", where));
    if (leaves->empty()) throw Error(fmt::format("{}: no active voxels", where));
}

void VdbReader::State::read_level_set() {
    const LoadedGrid loaded = load_grid(file, entry);
    if (!loaded.grid || loaded.has_points) throw_not_density(where, entry.tree_type);
    with_vdb_errors(where, [&] {
        level_set_to_fog(*loaded.grid, where);
        fog = density_from_grid(*loaded.grid, loaded.head.world_from_index, where, notes,
                                options.mask);
        if (options.ones) set_ones(fog, notes);
        if (fog.empty()) throw Error(fmt::format("{}: no active voxels", where));
    });
}

VdbReader::VdbReader(const std::filesystem::path& path, const VdbOptions& options) {
    openvdb::initialize();
    state_ = std::make_unique<State>(path, options);
}
VdbReader::~VdbReader() = default;
VdbReader::VdbReader(VdbReader&&) noexcept = default;
VdbReader& VdbReader::operator=(VdbReader&&) noexcept = default;

std::uint64_t VdbReader::active_voxels() const {
    return state_->leaves ? state_->leaves->active_voxels() : vog::active_voxels(state_->fog);
}

std::size_t VdbReader::leaf_count() const {
    return state_->leaves ? state_->leaves->count() : state_->fog.leaves.size();
}

Box VdbReader::world_box() const {
    return state_->leaves ? state_->leaves->world_box() : vog::world_box(state_->fog);
}

const Affine& VdbReader::world_from_index() const {
    return state_->leaves ? state_->leaves->world_from_index() : state_->fog.world_from_index;
}

/// Reads by of_file(leaves, notes), or by of_fog() if the whole grid is in memory.
template <class Choose, class Part>
Volume VdbReader::State::read(const Choose& of_file, const Part& of_fog,
                              ValueNotes* returned_notes) {
    return with_vdb_errors(where, [&] {
        ValueNotes found = notes;
        Volume volume = leaves ? of_file(*leaves, found) : of_fog();
        volume.name = entry.plain_name;
        volume.source = printable(file.name());
        const VdbMetadata metadata = leaves ? leaves->metadata() : VdbMetadata{};
        volume.standing = metadata.standing.known() ? metadata.standing : file.standing();
        // Of ones the unit of the values is none.
        volume.units = {metadata.length_unit, options.ones ? "" : metadata.unit};
        if (returned_notes) *returned_notes = found;
        return volume;
    });
}

Volume VdbReader::read(const VolumePart& part, ValueNotes* notes) {
    Volume volume =
        state_->read([&](VdbLeaves& leaves, ValueNotes& found) { return leaves.read(part, found); },
                     [&] { return part_of(state_->fog, part); }, notes);
    if (part.whole() && volume.empty())
        throw Error(fmt::format(
            "{}: no active voxels{}", state_->where,
            state_->options.mask ? " above 0, expected a mask" : " with a finite value"));
    return volume;
}

Volume VdbReader::read_where(const NodeChoice& selected, ValueNotes* notes) {
    return state_->read(
        [&](VdbLeaves& leaves, ValueNotes& found) { return leaves.read_where(selected, found); },
        [&] { return nodes_where(state_->fog, selected); }, notes);
}

Volume read_vdb(const std::filesystem::path& path, const VdbOptions& options, ValueNotes* notes) {
    return VdbReader(path, options).read({}, notes);
}

}  // namespace vog
