// vdb_grid.cpp: reading of checked grids by OpenVDB: topology serially, leaves in parallel.
#include "io/vdb/vdb_grid.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/parallel.h"
#include "io/vdb/bytes/vdb_tree_check.h"

namespace vog::vdb {

namespace {

using openvdb::io::RealToHalf;

constexpr std::string_view kPointTree = "Tree_ptdataidx32_5_4_3";
constexpr std::uint64_t kPointLeafBytes = 512 * 4;  // end of its points for each voxel

template <class GridT>
TreeLayout layout_of() {
    using Value = typename GridT::ValueType;
    TreeLayout layout;
    layout.value_bytes = sizeof(Value);
    if (RealToHalf<Value>::isReal) layout.half_bytes = sizeof(typename RealToHalf<Value>::HalfT);
    if (std::is_same_v<GridT, openvdb::BoolGrid>) layout.leaf = LeafData::bits;
    if (std::is_same_v<GridT, openvdb::MaskGrid>) layout.leaf = LeafData::none;
    return layout;
}

/// Bytes of a grid whose tree has been checked.
struct CheckedBytes {
    std::span<const char> bytes;
    std::uint64_t begin = 0;   ///< position of `bytes` in the file
    std::size_t topology = 0;  ///< offset of the tree in `bytes`
    TreeStorage storage;
    std::uint32_t version = 0;
    CheckedTree tree;
};

/// Reads the voxel values of all leaves in parallel.
template <class GridT>
void read_leaves(const CheckedBytes& checked, GridT& grid) {
    auto& tree = grid.tree();
    const auto& leaves = checked.tree.leaves;
    vog::parallel_for(
        tbb::blocked_range<std::size_t>(0, leaves.size(), 64), [&](const auto& range) {
            MemoryStream stream(checked.bytes);
            tag_vdb_stream(stream, checked.version, checked.storage.compression);
            openvdb::io::setGridBackgroundValuePtr(stream, &tree.background());
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Vec3i origin = leaves[i].origin;
                stream.seekg(static_cast<std::streamoff>(leaves[i].buffer - checked.begin));
                tree.probeLeaf({origin.x, origin.y, origin.z})
                    ->readBuffers(stream, checked.storage.half_stored);
            }
        });
}

/// Storage layout of trees of `tree_type`, if it is one of Grids.
template <class... Grids>
std::optional<TreeLayout> layout_of(const std::string& tree_type, openvdb::TypeList<Grids...>) {
    std::optional<TreeLayout> layout;
    ((Grids::gridType() == tree_type ? void(layout = layout_of<Grids>()) : void()), ...);
    return layout;
}

LoadedGrid load_own_tree(VdbFile& file, const VdbEntry& entry) {
    LoadedGrid loaded;
    loaded.has_points = entry.tree_type == kPointTree;
    const BigVector<char> bytes = file.bytes(entry);
    MemoryBytes in(bytes, file.where(entry), entry.begin);
    loaded.head = read_vdb_head(in);

    const std::string tree_type =
        loaded.has_points ? openvdb::Int32Grid::gridType() : entry.tree_type;
    std::optional<TreeLayout> layout = tree_layout(tree_type);
    if (!layout) return loaded;
    if (loaded.has_points) layout->leaf = LeafData::points;

    CheckedBytes checked{bytes,          entry.begin,
                         in.offset(),    {*layout, loaded.head.compression, entry.half_stored},
                         file.version(), {}};
    checked.tree = check_tree(in, checked.storage);
    loaded.grid = read_vdb_topology(checked.bytes.subspan(checked.topology), tree_type,
                                    file.version(), checked.storage);
    if (loaded.has_points) {
        loaded.points = checked.tree.points;
        loaded.point_bytes =
            checked.tree.attribute_bytes + kPointLeafBytes * checked.tree.leaves.size();
    } else {
        loaded.grid->apply<KnownGrids>([&](auto& grid) { read_leaves(checked, grid); });
    }
    return loaded;
}

}  // namespace

std::optional<TreeLayout> tree_layout(const std::string& tree_type) {
    return layout_of(tree_type, KnownGrids());
}

const VdbEntry& tree_owner(const VdbFile& file, const VdbEntry& entry) {
    if (entry.parent.empty()) return entry;
    for (const VdbEntry& other : file.entries())
        if (other.unique_name == entry.parent && other.parent.empty() &&
            other.tree_type == entry.tree_type)
            return other;
    throw Error(
        fmt::format("{}: shares the tree of a grid that is not in the file", file.where(entry)));
}

void tag_vdb_stream(std::istream& stream, std::uint32_t version, std::uint32_t compression) {
    openvdb::io::setVersion(
        stream, {openvdb::OPENVDB_LIBRARY_MAJOR_VERSION, openvdb::OPENVDB_LIBRARY_MINOR_VERSION},
        std::min(version, openvdb::OPENVDB_FILE_VERSION));
    openvdb::io::setDataCompression(stream, compression);
}

openvdb::GridBase::Ptr read_vdb_topology(std::span<const char> bytes, const std::string& tree_type,
                                         std::uint32_t version, const TreeStorage& storage) {
    // From OpenVDB's registry: naming a grid type's constructor compiles the whole class, 12
    // seconds for each type.
    openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(tree_type);
    grid->setSaveFloatAsHalf(storage.half_stored);
    MemoryStream stream(bytes);
    tag_vdb_stream(stream, version, storage.compression);
    grid->readTopology(stream);
    return grid;
}

bool is_scalar(const std::string& tree_type) {
    return tree_type == openvdb::FloatGrid::gridType() ||
           tree_type == openvdb::DoubleGrid::gridType() ||
           tree_type == openvdb::Int32Grid::gridType() ||
           tree_type == openvdb::Int64Grid::gridType();
}

std::string short_type(const std::string& tree_type) {
    constexpr std::string_view kPrefix = "Tree_", kSuffix = "_5_4_3";
    if (tree_type == kPointTree) return "points";
    if (!tree_type.starts_with(kPrefix) || !tree_type.ends_with(kSuffix)) return tree_type;
    return tree_type.substr(kPrefix.size(), tree_type.size() - kPrefix.size() - kSuffix.size());
}

void throw_not_density(const std::string& where, const std::string& tree_type) {
    throw Error(
        fmt::format("{}: holds {}, expected float, double, int32, int64, bool, mask or vec3", where,
                    short_type(tree_type)));
}

LoadedGrid load_grid(VdbFile& file, const VdbEntry& entry) {
    return with_vdb_errors(file.where(entry), [&] {
        const VdbEntry& owner = tree_owner(file, entry);
        LoadedGrid loaded = load_own_tree(file, owner);
        if (&owner != &entry) {
            const BigVector<char> bytes = file.bytes(entry);
            MemoryBytes in(bytes, file.where(entry), entry.begin);
            loaded.head = read_vdb_head(in);
        }
        if (loaded.grid) {
            loaded.grid->setName(entry.plain_name);
            loaded.grid->setGridClass(openvdb::GridBase::stringToGridClass(loaded.head.grid_class));
        }
        return loaded;
    });
}

}  // namespace vog::vdb
