// vdb_grid.h: checked reading of a file's grids into OpenVDB grids.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <fmt/core.h>

#include "io/grid_choice.h"
#include "io/vdb/bytes/vdb_file.h"
#include "io/vdb/bytes/vdb_tree_check.h"
#include "vog/error.h"

namespace vog::vdb {

using KnownGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                     openvdb::Int64Grid, openvdb::Vec3SGrid, openvdb::Vec3DGrid,
                                     openvdb::Vec3IGrid, openvdb::BoolGrid, openvdb::MaskGrid>;

/// Whether a grid of this type can be the default density grid.
bool is_scalar(const std::string& tree_type);
/// "float" for "Tree_float_5_4_3", "points" for a PointDataGrid; other types unchanged.
std::string short_type(const std::string& tree_type);
/// throws vog::Error that trees of this type hold no density
[[noreturn]] void throw_not_density(const std::string& where, const std::string& tree_type);

/// Grid of this name, or by the rule of vog::chosen_of; the largest one has most active voxels and is no level set, or
/// is one with `level_sets`.
/// throws vog::Error as chosen_of does
const VdbEntry& chosen_entry(VdbFile& file, const GridRequest& request,
                             DefaultGrid* answer = nullptr, bool level_sets = false);
/// Storage layout of trees of this type; none for an unknown type.
std::optional<TreeLayout> tree_layout(const std::string& tree_type);
/// Entry that stores the tree of `entry`: itself, or the grid whose tree it shares.
/// throws vog::Error if that grid is not in the file
const VdbEntry& tree_owner(const VdbFile& file, const VdbEntry& entry);
/// Attaches file version and compression to a stream, where OpenVDB's readers look them up.
void tag_vdb_stream(std::istream& stream, std::uint32_t version, std::uint32_t compression);
/// Reads the topology of a checked tree; voxel values are not read.
/// bytes  from the start of the tree to the end of its topology or beyond
openvdb::GridBase::Ptr read_vdb_topology(std::span<const char> bytes, const std::string& tree_type,
                                         std::uint32_t version, const TreeStorage& storage);

/// Grid in memory, with its head.
struct LoadedGrid {
    /// Null for an unknown type. The transform is in `head`, not set here. Points have an Int32Grid
    /// with the topology alone, whose bytes are the same.
    openvdb::GridBase::Ptr grid;
    VdbHead head;
    bool has_points = false;
    std::uint64_t points = 0, point_bytes = 0;  ///< number; bytes in memory without the topology
};

/// Reads one grid of the file.
/// throws vog::Error for a truncated or corrupt grid
LoadedGrid load_grid(VdbFile& file, const VdbEntry& entry);

/// Calls `run`; converts exceptions of OpenVDB and the standard library to vog::Error with `where`.
template <class Run>
auto with_vdb_errors(const std::string& where, Run run) {
    try {
        return run();
    } catch (const openvdb::Exception& error) {
        throw Error(fmt::format("{}: {}", where, error.what()));
    } catch (const std::ios_base::failure&) {
        throw Error(fmt::format("{}: corrupt: shorter than its tree", where));
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format("{}: not enough memory", where));
    } catch (const std::length_error&) {
        throw Error(fmt::format("{}: not enough memory", where));
    }
}

}  // namespace vog::vdb
