// vdb_grid.h: grids of a file as OpenVDB's own, for the files named vdb_*.cpp only.
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

#include "io/vdb/bytes/vdb_file.h"
#include "io/vdb/bytes/vdb_tree_check.h"
#include "vog/error.h"

namespace vog::vdb {

using DensityGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                       openvdb::Int64Grid, openvdb::Vec3SGrid, openvdb::Vec3DGrid,
                                       openvdb::Vec3IGrid>;
using KnownGrids = DensityGrids::Append<openvdb::BoolGrid, openvdb::MaskGrid>;

/// Can be density without being asked for by name.
bool is_scalar(const std::string& tree_type);
/// "float" for "Tree_float_5_4_3", "points" for a PointDataGrid; other trees as they stand.
std::string short_type(const std::string& tree_type);

/// How trees of this type are stored; none: it is not known.
std::optional<TreeLayout> tree_layout(const std::string& tree_type);
/// The entry whose tree `entry` has: itself, or the grid it shares a tree with.
const VdbEntry& tree_owner(const VdbFile& file, const VdbEntry& entry);
/// What OpenVDB's readers look up in the stream they read.
void tag_vdb_stream(std::istream& stream, std::uint32_t version, std::uint32_t compression);
/// Reads the topology of a tree that has been walked; its leaves are without voxels.
/// bytes  from the tree's first on, to the end of its topology or beyond
openvdb::GridBase::Ptr read_vdb_topology(std::span<const char> bytes, const std::string& tree_type,
                                         std::uint32_t version, const TreeStorage& storage);

struct LoadedGrid {
    /// Null if the type is not known. Its transform is not set: that is in the head. For points an
    /// Int32Grid with the topology alone, which has the same bytes.
    openvdb::GridBase::Ptr grid;
    VdbHead head;
    bool has_points = false;
    std::uint64_t points = 0, point_bytes = 0;  ///< bytes in memory, apart from the topology
};

/// Reads one grid of the file.
/// throws vog::Error if its bytes are not whole and sound
LoadedGrid load_grid(VdbFile& file, const VdbEntry& entry);

/// Calls `run`; what OpenVDB and the standard library throw becomes a vog::Error about `where`.
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
