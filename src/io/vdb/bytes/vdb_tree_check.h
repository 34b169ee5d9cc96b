// vdb_tree_check.h: checks the bytes of one grid's tree before OpenVDB reads them.
// OpenVDB 10.0.1 writes past its buffers if the size of a compressed block is wrong, calls blosc
// without the size of its input, ignores short reads, and frees stray pointers of half-read nodes.
// The check follows openvdb/tree/*::readTopology and readBuffers without decoding values. A tree
// that passes is safe to read by OpenVDB, also leaf by leaf in parallel.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/byte_source.h"
#include "vog/linear.h"

namespace vog::vdb {

/// Data of a leaf behind its mask.
enum class LeafData {
    values,  ///< one number or vector per voxel
    bits,    ///< origin and one bit per voxel (bool)
    none,    ///< origin only (mask)
    points,  ///< attributes, in several passes
};

/// Storage of a tree type.
struct TreeLayout {
    std::uint64_t value_bytes = 4;
    std::uint64_t half_bytes = 0;  ///< bytes of a value stored as half floats; 0: never stored so
    LeafData leaf = LeafData::values;
};

/// Storage of a tree in one file.
struct TreeStorage {
    TreeLayout layout;
    std::uint32_t compression = 0;  ///< openvdb::io::COMPRESS_* flags
    bool half_stored = false;
};

/// Attribute of points, as in "P", "vec3s", "fxpt16".
struct PointColumn {
    std::string name, type, codec;
    friend bool operator==(const PointColumn&, const PointColumn&) = default;
};
/// Storage of one attribute in one leaf.
struct PointArray {
    std::uint64_t bytes = 0;  ///< decoded size if paged
    std::uint32_t size = 0;   ///< number of points
    std::uint32_t stride = 1;
    bool uniform = false, paged = false;
};

/// Contents of a checked tree.
struct CheckedTree {
    /// Leaf, and the range of its voxels in the file.
    struct LeafRange {
        Vec3i origin;
        std::uint64_t bytes = 0;   ///< size of its voxels
        std::uint64_t buffer = 0;  ///< position of its voxels
        std::array<std::uint64_t, 8> mask{};
    };
    /// Active tile of the root, or internal node with active tiles, and its bytes in the file: value
    /// and state of the tile; masks and values of the node.
    struct TileRange {
        Vec3i origin;
        std::int32_t tile_edge = 0;  ///< voxels: 4096 for a tile of the root
        std::uint64_t begin = 0, end = 0;
    };
    std::vector<LeafRange> leaves;
    std::vector<TileRange> tiles;
    std::uint64_t points = 0, attribute_bytes = 0;  ///< for trees of points
    std::vector<PointColumn> columns;               ///< attributes of points
    std::vector<PointArray> arrays;                 ///< [leaf][column]
};

/// Checks a tree from where `in` is to its end, skipping voxel values. For points, up to the end of
/// the attribute descriptions; io/vdb/points/vdb_points.cpp reads the attributes.
/// throws vog::Error with the position of the first invalid byte
CheckedTree check_tree(ByteSource& in, const TreeStorage& storage);

}  // namespace vog::vdb
