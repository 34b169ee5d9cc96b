// vdb_tree_check.cpp: tree topology and voxel blocks, checked byte by byte. The order of things is that
// of RootNode.h, InternalNode.h, LeafNode.h, PointDataGrid.h and io/Compression.h of OpenVDB.
#include "io/vdb/bytes/vdb_tree_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <tuple>

#include "core/parallel.h"
#include "io/vdb/bytes/vdb_file.h"

namespace vog::vdb {

namespace {

// Flags of a grid's compression.
constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;

constexpr std::uint64_t kLeafMaskBytes = sizeof(WalkedTree::LeafSpot::mask);
constexpr std::int32_t kRootChildEdge = 4096;

/// The inner nodes: 32^3 children of 128 voxels, 16^3 of 8.
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

class TreeWalk {
  public:
    TreeWalk(ByteSource& in, const TreeStorage& storage) : in_(in), storage_(storage) {}

    WalkedTree walk() {
        root();
        tree_.topology_end = in_.position();
        if (storage_.layout.leaf == LeafData::points) {
            point_leaves();
        } else {
            for (WalkedTree::LeafSpot& leaf : tree_.leaves) {
                check_interrupt();
                leaf_buffer(leaf);
            }
            if (!in_.at_end()) in_.fail("corrupt: the tree ends before its grid does");
        }
        return std::move(tree_);
    }

  private:
    void root();
    void node(Vec3i origin, const NodeKind& kind);
    void leaf_buffer(WalkedTree::LeafSpot& leaf);
    void point_leaves();
    std::vector<PointColumn> point_descriptor();
    void values(std::uint32_t count, std::uint32_t active);
    void block(std::uint64_t bytes);
    Vec3i origin();

    ByteSource& in_;
    TreeStorage storage_;
    WalkedTree tree_;
};

Vec3i TreeWalk::origin() {
    Vec3i origin;
    for (int axis = 0; axis < 3; ++axis) origin[axis] = in_.number<std::int32_t>();
    return origin;
}

void TreeWalk::root() {
    if (in_.number<std::int32_t>() != 1) in_.fail("corrupt: expected one buffer a leaf");
    in_.take(storage_.layout.value_bytes);  // background
    const auto tiles = in_.number<std::uint32_t>();
    const auto children = in_.number<std::uint32_t>();

    std::vector<Vec3i> origins;
    const auto note_origin = [&] {
        origins.push_back(origin());
        for (int axis = 0; axis < 3; ++axis)
            if (origins.back()[axis] & (kRootChildEdge - 1))
                in_.fail("corrupt: the origin of a root node is no multiple of 4096");
    };
    for (std::uint32_t i = 0; i < tiles; ++i) {
        note_origin();
        in_.take(storage_.layout.value_bytes);
        if (static_cast<unsigned char>(*in_.take(1)) > 1)
            in_.fail("corrupt: a tile neither active nor inactive");
    }
    for (std::uint32_t i = 0; i < children; ++i) {
        note_origin();
        node(origins.back(), kUpper);
    }
    const auto key = [](Vec3i a) { return std::tuple(a.x, a.y, a.z); };
    std::ranges::sort(origins, {}, key);
    if (std::ranges::adjacent_find(origins) != origins.end())
        in_.fail("corrupt: two root nodes at one place");
}

void TreeWalk::node(Vec3i origin, const NodeKind& kind) {
    const Mask child_mask = read_mask(in_, kind.children());
    const Mask value_mask = read_mask(in_, kind.children());
    for (std::size_t word = 0; word < child_mask.size(); ++word)
        if (child_mask[word] & value_mask[word])
            in_.fail("corrupt: a node is both a child and a tile");
    values(kind.children(), count_on(value_mask));

    const int log2 = kind.log2_edge;
    for (std::uint32_t n = 0; n < kind.children(); ++n) {
        if (!((child_mask[n >> 6] >> (n & 63)) & 1)) continue;
        const auto within = static_cast<std::int32_t>((1u << log2) - 1);
        const auto offset = static_cast<std::int32_t>(n);
        const Vec3i child =
            origin + kind.child_edge *
                         Vec3i{offset >> (2 * log2), (offset >> log2) & within, offset & within};
        if (kind.child_edge == kUpper.child_edge) {
            node(child, kLower);
        } else {
            WalkedTree::LeafSpot& leaf = tree_.leaves.emplace_back();
            leaf.origin = child;
            std::memcpy(leaf.mask.data(), in_.take(kLeafMaskBytes), kLeafMaskBytes);
        }
    }
}

void TreeWalk::leaf_buffer(WalkedTree::LeafSpot& leaf) {
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

/// `count` values of which `active` are on: io/Compression.h, readCompressedValues.
void TreeWalk::values(std::uint32_t count, std::uint32_t active) {
    // What stands for the inactive values: nothing, one or two of them, a mask that selects.
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
    if (half && stored == 0) return;  // not even an empty block
    block(stored * (half ? layout.half_bytes : layout.value_bytes));
}

/// A block that decodes to `bytes` bytes: io/Compression.cc, bloscFromStream and unzipFromStream.
void TreeWalk::block(std::uint64_t bytes) {
    if (!(storage_.compression & (kZip | kBlosc))) {
        in_.skip(bytes);
        return;
    }
    const auto size = in_.number<std::int64_t>();  // negative: stored as it is
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

/// The passes over the leaves of a PointDataGrid, as far as the sizes of the attributes.
void TreeWalk::point_leaves() {
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
            if (i == 0) tree_.points += array.size;  // every attribute has as many
            tree_.arrays.push_back(array);
        }
    }
    if (passes != 2 * tree_.columns.size() + 4)
        in_.fail(
            fmt::format("corrupt: {} passes over {} attributes", passes, tree_.columns.size()));
}

/// Names and types of the attributes.
std::vector<PointColumn> TreeWalk::point_descriptor() {
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

WalkedTree walk_tree(ByteSource& in, const TreeStorage& storage) {
    return TreeWalk(in, storage).walk();
}

}  // namespace vog::vdb
