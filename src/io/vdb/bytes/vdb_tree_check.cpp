// vdb_tree_check.cpp: checks of tree topology and voxel blocks. Source of the byte order:
// RootNode.h, InternalNode.h, LeafNode.h, PointDataGrid.h and io/Compression.h of OpenVDB.
#include "io/vdb/bytes/vdb_tree_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "io/vdb/bytes/vdb_file.h"

namespace vog::vdb {

namespace {

// Flags of a grid's compression.
constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;

constexpr std::uint64_t kLeafMaskBytes = sizeof(CheckedTree::LeafRange::mask);
constexpr std::int32_t kRootChildEdge = 4096;

/// Internal node: 32^3 children of 128^3 voxels, or 16^3 children of 8^3.
struct NodeKind {
    int log2_edge;
    std::int32_t child_edge;
    std::uint32_t children() const { return 1u << (3 * log2_edge); }
};
constexpr NodeKind kUpper{5, 128}, kLower{4, 8};

using Mask = std::vector<std::uint64_t>;

Mask read_mask(ByteSource& in, std::uint32_t bits) {
    Mask mask(bits / 64);
    std::memcpy(mask.data(), in.take(bits / 8), bits / 8);
    return mask;
}

std::uint32_t count_on(const Mask& mask) {
    std::uint32_t count = 0;
    for (std::uint64_t word : mask) count += static_cast<std::uint32_t>(std::popcount(word));
    return count;
}

class TreeCheck {
  public:
    TreeCheck(ByteSource& in, const TreeStorage& storage) : in_(in), storage_(storage) {}

    CheckedTree check() {
        root();
        if (storage_.layout.leaf == LeafData::points) {
            point_leaves();
        } else {
            for (CheckedTree::LeafRange& leaf : tree_.leaves) {
                check_interrupt();
                leaf_buffer(leaf);
            }
            if (!in_.at_end()) in_.fail("corrupt: bytes behind the tree of the grid");
        }
        return std::move(tree_);
    }

  private:
    void root();
    void node(Vec3i origin, const NodeKind& kind);
    void leaf_buffer(CheckedTree::LeafRange& leaf);
    void point_leaves();
    std::vector<PointColumn> point_descriptor();
    void values(std::uint32_t count, std::uint32_t active);
    void block(std::uint64_t bytes);
    Vec3i origin();

    ByteSource& in_;
    TreeStorage storage_;
    CheckedTree tree_;
};

Vec3i TreeCheck::origin() {
    Vec3i origin;
    for (int axis = 0; axis < 3; ++axis) origin[axis] = in_.number<std::int32_t>();
    return origin;
}

void TreeCheck::root() {
    if (in_.number<std::int32_t>() != 1) in_.fail("corrupt: buffers per leaf, expected 1");
    in_.take(storage_.layout.value_bytes);  // background
    const auto tiles = in_.number<std::uint32_t>();
    const auto children = in_.number<std::uint32_t>();

    std::vector<Vec3i> origins;
    const auto add_origin = [&] {
        origins.push_back(origin());
        for (int axis = 0; axis < 3; ++axis)
            if (origins.back()[axis] & (kRootChildEdge - 1))
                in_.fail("corrupt: origin of a root node, expected multiples of 4096");
    };
    for (std::uint32_t i = 0; i < tiles; ++i) {
        add_origin();
        const std::uint64_t begin = in_.position();
        in_.take(storage_.layout.value_bytes);
        const auto state = static_cast<unsigned char>(*in_.take(1));
        if (state > 1) in_.fail("corrupt: tile state, expected 0 or 1");
        if (state == 1)
            tree_.tiles.push_back({origins.back(), kRootChildEdge, begin, in_.position()});
    }
    for (std::uint32_t i = 0; i < children; ++i) {
        add_origin();
        node(origins.back(), kUpper);
    }
    const auto key = [](Vec3i a) { return std::tuple(a.x, a.y, a.z); };
    std::ranges::sort(origins, {}, key);
    if (std::ranges::adjacent_find(origins) != origins.end())
        in_.fail("corrupt: two root nodes with one origin");
}

void TreeCheck::node(Vec3i origin, const NodeKind& kind) {
    const std::uint64_t begin = in_.position();
    const Mask child_mask = read_mask(in_, kind.children());
    const Mask value_mask = read_mask(in_, kind.children());
    for (std::size_t word = 0; word < child_mask.size(); ++word)
        if (child_mask[word] & value_mask[word])
            in_.fail("corrupt: a node that is both a child and a tile");
    const std::uint32_t active = count_on(value_mask);
    values(kind.children(), active);
    if (active) tree_.tiles.push_back({origin, kind.child_edge, begin, in_.position()});

    const int log2 = kind.log2_edge;
    const auto within = static_cast<std::int32_t>((1u << log2) - 1);
    const auto visit = [&](std::int32_t offset) {
        const Vec3i child =
            origin + kind.child_edge *
                         Vec3i{offset >> (2 * log2), (offset >> log2) & within, offset & within};
        if (kind.child_edge == kUpper.child_edge) {
            node(child, kLower);
        } else {
            CheckedTree::LeafRange& leaf = tree_.leaves.emplace_back();
            leaf.origin = child;
            std::memcpy(leaf.mask.data(), in_.take(kLeafMaskBytes), kLeafMaskBytes);
        }
    };
    for (std::size_t word = 0; word < child_mask.size(); ++word)
        for (std::uint64_t left = child_mask[word]; left; left &= left - 1)
            visit(static_cast<std::int32_t>(64 * word) + std::countr_zero(left));
}

void TreeCheck::leaf_buffer(CheckedTree::LeafRange& leaf) {
    leaf.buffer = in_.position();
    if (std::memcmp(in_.take(kLeafMaskBytes), leaf.mask.data(), kLeafMaskBytes) != 0)
        in_.fail("corrupt: the two masks of a leaf differ");
    if (storage_.layout.leaf == LeafData::values) {
        std::uint32_t active = 0;
        for (const std::uint64_t word : leaf.mask)
            active += static_cast<std::uint32_t>(std::popcount(word));
        values(512, active);
    } else {
        if (origin() != leaf.origin) in_.fail("corrupt: a leaf is not where its parent has it");
        if (storage_.layout.leaf == LeafData::bits) in_.skip(kLeafMaskBytes);
    }
    leaf.bytes = in_.position() - leaf.buffer;
}

/// Values of a node as in io/Compression.h, readCompressedValues.
/// count   values; `active` of them are active
void TreeCheck::values(std::uint32_t count, std::uint32_t active) {
    // Storage of inactive values: none, one or two of them, a mask that selects between two.
    enum { kOneInactive = 2, kMask = 3, kMaskAndOne = 4, kMaskAndTwo = 5, kAllValues = 6 };
    const int inactive = *in_.take(1);
    if (inactive < 0 || inactive > kAllValues)
        in_.fail(fmt::format("corrupt: inactive values of kind {}", inactive));
    const TreeLayout& layout = storage_.layout;
    if (inactive == kOneInactive || inactive == kMaskAndOne) in_.take(layout.value_bytes);
    if (inactive == kMaskAndTwo) in_.take(2 * layout.value_bytes);
    if (inactive >= kMask && inactive <= kMaskAndTwo) in_.take(count / 8);

    const bool active_only = (storage_.compression & kActiveMask) && inactive != kAllValues;
    const std::uint64_t stored = active_only ? active : count;
    const bool half = storage_.half_stored && layout.half_bytes > 0;
    if (half && stored == 0) return;  // no block is stored
    block(stored * (half ? layout.half_bytes : layout.value_bytes));
}

/// Block of `bytes` decoded bytes, as in io/Compression.cc, bloscFromStream and unzipFromStream.
void TreeCheck::block(std::uint64_t bytes) {
    if (!(storage_.compression & (kZip | kBlosc))) {
        in_.skip(bytes);
        return;
    }
    const auto size = in_.number<std::int64_t>();  // negative: uncompressed
    if (size <= 0) {
        if (size != -static_cast<std::int64_t>(bytes))
            in_.fail(fmt::format("corrupt: a block of {} bytes, expected {}", size, bytes));
        in_.skip(bytes);
        return;
    }
    const auto stored = static_cast<std::uint64_t>(size);
    if (!(storage_.compression & kBlosc)) {
        in_.skip(stored);
        return;
    }
    // blosc's header: versions and flags in 4 bytes, then decoded, block and encoded size.
    constexpr std::uint64_t kBloscHeaderBytes = 16;
    std::uint32_t decoded = 0, encoded = 0;
    const std::uint64_t head = std::min(stored, kBloscHeaderBytes);
    const char* data = in_.take(head);
    if (head == kBloscHeaderBytes) {
        std::memcpy(&decoded, data + 4, sizeof decoded);
        std::memcpy(&encoded, data + 12, sizeof encoded);
    }
    in_.skip(stored - head);
    if (decoded != bytes || encoded != stored)
        in_.fail(fmt::format("corrupt: a blosc block of {} for {} bytes, expected {} for {}",
                             encoded, decoded, stored, bytes));
}

/// First two passes over the leaves of a PointDataGrid: voxel block sizes, attribute descriptions.
void TreeCheck::point_leaves() {
    enum { kStrided = 1, kUniform = 2, kPaged = 8 };
    const auto passes = in_.number<std::uint16_t>();
    if (tree_.leaves.empty()) return;
    if (passes < 4)
        in_.fail(fmt::format("corrupt: {} passes over points, expected 4 or more", passes));
    in_.take(2 * tree_.leaves.size());  // pass 0: size of each leaf's voxel block

    bool shared_descriptor = false;  // pass 1: attributes
    for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
        if (!shared_descriptor) {
            const auto flags = in_.number<std::uint8_t>();
            const std::vector<PointColumn> columns = point_descriptor();
            if (leaf == 0) tree_.columns = columns;
            if (columns != tree_.columns)
                in_.fail("has leaves with different attributes, expected the same in all");
            shared_descriptor = flags & 1;
            if (flags & 2) in_.take(in_.number<std::uint64_t>());
        }
        for (std::size_t i = 0; i < tree_.columns.size(); ++i) {
            constexpr std::uint64_t kFlagsAndSize = 6;  // counted with the bytes
            PointArray array;
            array.bytes = in_.number<std::uint64_t>();
            tree_.attribute_bytes += array.bytes;
            array.bytes = array.bytes < kFlagsAndSize ? 0 : array.bytes - kFlagsAndSize;
            in_.take(1);
            const auto flags = in_.number<std::uint8_t>();
            array.size = in_.number<std::uint32_t>();
            if (flags & kStrided) array.stride = in_.number<std::uint32_t>();
            array.uniform = flags & kUniform;
            array.paged = flags & kPaged;
            if (i == 0) tree_.points += array.size;  // all attributes have the same number
            tree_.arrays.push_back(array);
        }
    }
    if (passes != 2 * tree_.columns.size() + 4)
        in_.fail(
            fmt::format("corrupt: {} passes over {} attributes", passes, tree_.columns.size()));
}

/// Reads the names, types and codecs of the attributes.
std::vector<PointColumn> TreeCheck::point_descriptor() {
    const auto attributes = in_.number<std::uint64_t>();
    if (attributes > 1u << 14) in_.fail(fmt::format("corrupt: {} attributes", attributes));
    std::vector<PointColumn> columns;
    for (std::uint64_t i = 0; i < attributes; ++i) {  // each takes at least 8 bytes, so this ends
        PointColumn column;
        column.type = in_.string();
        column.codec = in_.string();
        columns.push_back(column);
    }
    for (std::uint64_t i = 0; i < attributes; ++i) {
        const std::string name = in_.string();
        const auto at = in_.number<std::uint64_t>();
        if (at >= attributes) in_.fail(fmt::format("corrupt: attribute {} of {}", at, attributes));
        columns[at].name = name;
    }
    const auto groups = in_.number<std::uint64_t>();
    for (std::uint64_t i = 0; i < groups; ++i) {
        in_.string();
        in_.take(8);
    }
    read_vdb_metadata(in_);
    return columns;
}

}  // namespace

CheckedTree check_tree(ByteSource& in, const TreeStorage& storage) {
    return TreeCheck(in, storage).check();
}

}  // namespace vog::vdb
