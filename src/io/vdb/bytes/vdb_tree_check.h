// vdb_tree_check.h: checks the bytes of one grid's tree before OpenVDB reads them.
// OpenVDB 10.0.1 writes past its buffers when the size of a compressed block is wrong, hands blosc
// blocks without their size, ignores short reads, and destroys half-read nodes by stray pointers.
// The walk follows the tree as openvdb/tree/*::readTopology and readBuffers do, without decoding a
// value; what passes it can be read by OpenVDB safely, and leaf by leaf in parallel.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/byte_source.h"
#include "vog/linear.h"

namespace vog::vdb {

/// How a leaf's voxels follow its mask.
enum class LeafData {
    values,  ///< one number or vector each
    bits,    ///< origin and one bit each (bool)
    none,    ///< origin alone: the mask says it all
    points,  ///< attributes, in several passes
};

struct TreeLayout {
    std::uint64_t value_bytes = 4;
    std::uint64_t half_bytes = 0;  ///< of a value stored as half floats; 0: never is
    LeafData leaf = LeafData::values;
};

/// How a file stores its trees.
struct TreeStorage {
    TreeLayout layout;
    std::uint32_t compression = 0;
    bool half_stored = false;
};

/// An attribute of points: "P", "vec3s", "fxpt16".
struct PointColumn {
    std::string name, type, codec;
    friend bool operator==(const PointColumn&, const PointColumn&) = default;
};
/// How one leaf stores one attribute.
struct PointArray {
    std::uint64_t bytes = 0;  ///< decoded, where paged
    std::uint32_t size = 0;   ///< points
    std::uint32_t stride = 1;
    bool uniform = false, paged = false;
};

struct WalkedTree {
    struct LeafSpot {
        Vec3i origin;
        std::uint64_t bytes = 0;   ///< of its voxels, in the file
        std::uint64_t buffer = 0;  ///< position of its voxels in the file
        std::array<std::uint64_t, 8> mask{};
    };
    std::vector<LeafSpot> leaves;
    std::uint64_t topology_end = 0;                 ///< position where the voxels begin
    std::uint64_t points = 0, attribute_bytes = 0;  ///< of a tree of points
    std::vector<PointColumn> columns;               ///< of points
    std::vector<PointArray> arrays;                 ///< [leaf][column]
};

/// Walks the tree that `in` stands at, to the end of `in`, passing over voxels without reading
/// them; of points to the end of what describes their attributes, whose bytes io/vdb_points.cpp
/// reads. throws vog::Error naming the first byte that cannot be
WalkedTree walk_tree(ByteSource& in, const TreeStorage& storage);

}  // namespace vog::vdb
