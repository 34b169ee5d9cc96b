// nvdb_grid.cpp: traversal of a NanoVDB tree with every offset checked, into an OpenVDB grid.
#include "io/nvdb/nvdb_grid.h"

#include <fmt/core.h>

#include <cstdint>
#include <mutex>
#include <set>
#include <type_traits>
#include <vector>

#include "core/paging.h"
#include "core/parallel.h"
#include "io/nvdb/nvdb_file.h"
#include "vog/error.h"

namespace vog::nvdb {

namespace {

openvdb::Coord to_coord(const nanovdb::Coord& c) { return {c[0], c[1], c[2]}; }

template <class To, class From>
To convert(const From& value) {
    if constexpr (openvdb::VecTraits<To>::IsVec)
        return To(value[0], value[1], value[2]);
    else
        return static_cast<To>(value);
}

/// Converts a grid of one NanoVDB build type to an OpenVDB grid.
template <class Build, class GridT>
class NanoReader {
    using Root = nanovdb::NanoRoot<Build>;
    using Upper = nanovdb::NanoUpper<Build>;
    using Lower = nanovdb::NanoLower<Build>;
    using NanoLeafT = nanovdb::NanoLeaf<Build>;
    using LeafT = typename GridT::TreeType::LeafNodeType;
    using Value = typename GridT::ValueType;
    static constexpr bool kQuantised = std::is_same_v<Build, nanovdb::FpN>;

    struct PlacedLeaf {
        const NanoLeafT* leaf;
        nanovdb::Coord origin;
    };

  public:
    /// leaves  receives the leaves instead of the grid; null: the grid does
    NanoReader(const NanoBuffer& buffer, const std::string& where, NanoLeaves* leaves)
        : buffer_(buffer), where_(where), volume_leaves_(leaves) {}

    typename GridT::Ptr read() {
        const auto& header = node<nanovdb::GridData>(0);
        const auto& tree = node<nanovdb::TreeData<3>>(sizeof header);
        const std::uint64_t root_at =
            sizeof header + tree.mNodeOffset[3];  // a corrupt sum may wrap around; node() checks it
        const auto& root = node<Root>(root_at);
        const auto& table = *root.data();
        if (table.mTableSize > buffer_.size() / sizeof *table.tile(0))
            fail("root table longer than the grid");
        (void)bytes_at(root_at, root.memUsage());
        check_head(header, root_at + root.memUsage());

        // From OpenVDB's registry: naming a constructor compiles the whole class for every type.
        const auto grid =
            std::static_pointer_cast<GridT>(openvdb::GridBase::createGrid(GridT::gridType()));
        grid->tree().root().setBackground(convert<Value>(table.mBackground), false);
        std::set<openvdb::Coord> origins;
        for (std::uint32_t i = 0; i < table.mTableSize; ++i) {
            const auto& tile = *table.tile(i);
            if (!origins.insert(to_coord(tile.origin())).second)
                fail("two root entries with one origin");
            if (tile.isChild())
                read_upper(child<Upper>(root_at, tile.child), tile.origin(), grid->tree());
            else
                add_tile(grid->tree(), 3, tile.origin(), tile.value, tile.isActive());
        }
        check_nodes(header);
        volume_leaves_ ? convert_leaves() : add_leaves(grid->tree());
        return grid;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: corrupt: {}", where_, what));
    }

    const std::byte* bytes_at(std::uint64_t offset, std::uint64_t size) const {
        if (offset > buffer_.size() || size > buffer_.size() - offset ||
            offset % NANOVDB_DATA_ALIGNMENT != 0)
            fail(fmt::format("a node of {} bytes at byte {} of {}", size, offset, buffer_.size()));
        return buffer_.data() + offset;
    }
    template <class Node>
    const Node& node(std::uint64_t offset) const {
        return *reinterpret_cast<const Node*>(bytes_at(offset, sizeof(Node)));
    }
    template <class Parent>
    std::uint64_t offset_of(const Parent& parent) const {
        return static_cast<std::uint64_t>(reinterpret_cast<const std::byte*>(&parent) -
                                          buffer_.data());
    }
    /// Child at a byte offset from its parent. The total size of all children is limited to the
    /// buffer's: a corrupt file whose nodes share children would expand without bound.
    template <class Child>
    const Child& child(std::uint64_t parent_at, std::int64_t distance) {
        const auto at = parent_at + static_cast<std::uint64_t>(distance);
        node_bytes_ += sizeof(Child);
        if (node_bytes_ > buffer_.size()) fail("overlapping nodes");
        return node<Child>(at);
    }

    template <class TreeT, class From>
    void add_tile(TreeT& tree, int level, const nanovdb::Coord& origin, const From& value,
                  bool active) const {
        const auto converted = convert<Value>(value);
        if (active || converted != tree.background())
            tree.addTile(static_cast<openvdb::Index>(level), to_coord(origin), converted, active);
    }

    /// Calls with_child(child, origin) or add_tile for every cell of a node.
    template <class Node, class TreeT, class WithChild>
    void read_cells(const Node& from, const nanovdb::Coord& origin, TreeT& tree,
                    WithChild with_child) {
        using Child = typename Node::ChildNodeType;
        for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
            nanovdb::Coord at = Node::OffsetToLocalCoord(n);
            at <<= Child::TOTAL;
            at += origin;  // from the place in the parent: the child's own box is not trusted
            if (from.childMask().isOn(n))
                with_child(child<Child>(offset_of(from), from.data()->mTable[n].child), at);
            else
                add_tile(tree, Node::LEVEL, at, from.data()->mTable[n].value,
                         from.valueMask().isOn(n));
        }
    }

    template <class TreeT>
    void read_upper(const Upper& upper, const nanovdb::Coord& origin, TreeT& tree) {
        uppers_.push_back(&upper);
        read_cells(upper, origin, tree, [&](const Lower& lower, const nanovdb::Coord& at) {
            lowers_.push_back(&lower);
            read_cells(lower, at, tree, [&](const NanoLeafT& leaf, const nanovdb::Coord& leaf_at) {
                if constexpr (kQuantised) {  // variable size: 1, 2, 4, 8 or 16 bits per value
                    if (leaf.data()->bitWidth() > 16) fail("leaf with more than 16 bits per value");
                    (void)bytes_at(offset_of(leaf), leaf.data()->memUsage());
                }
                leaves_.push_back({&leaf, leaf_at});
            });
        });
    }

    /// Converts the leaves with active voxels to volume leaves, sorted by origin.
    void convert_leaves() {
        const auto is_empty = [](const PlacedLeaf& placed) {
            return placed.leaf->valueMask().isOff();
        };
        std::erase_if(leaves_, is_empty);
        std::ranges::sort(leaves_, {},
                          [](const PlacedLeaf& placed) { return to_coord(placed.origin); });
        resize_kept(volume_leaves_->leaves, leaves_.size());
        std::mutex mutex;
        constexpr std::size_t kLeavesPerTask = 64;
        vog::parallel_for(tbb::blocked_range<std::size_t>(0, leaves_.size(), kLeavesPerTask),
                          [&](const auto& range) {
                              Census census;
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  convert_leaf(i, census);
                              const std::lock_guard lock(mutex);
                              volume_leaves_->census = Census::sum(volume_leaves_->census, census);
                          });
    }
    void convert_leaf(std::size_t i, Census& census) const {
        const auto& [from, origin] = leaves_[i];
        Leaf& leaf = volume_leaves_->leaves[i];
        leaf.origin = from_coord(to_coord(origin));
        for (std::uint32_t n = 0; n < NanoLeafT::SIZE; ++n) {
            const float value = density(convert<Value>(from->getValue(n)));
            const bool finite = std::isfinite(value);
            if (!from->valueMask().isOn(n)) {
                census.inactive_not_finite += !finite;
                continue;
            }
            const auto offset = static_cast<int>(n);
            const float admitted =
                census.admit(value, i * kLeafVoxels + n, leaf.origin + offset_index(offset));
            if (finite) leaf.set(offset, admitted);
        }
    }

    template <class TreeT>
    void add_leaves(TreeT& tree) const {
        std::vector<LeafT*> leaves(leaves_.size());
        vog::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t i) {
            const auto& [from, origin] = leaves_[i];
            leaves[i] = new LeafT(to_coord(origin), tree.background(), false);
            for (std::uint32_t n = 0; n < NanoLeafT::SIZE; ++n) {
                leaves[i]->setValueOnly(n, convert<Value>(from->getValue(n)));
                leaves[i]->setActiveState(n, from->valueMask().isOn(n));
            }
        });
        for (LeafT* leaf : leaves) tree.addLeaf(leaf);  // the tree owns it
    }

    /// Checks the lower 32 bits of the checksum: CRC of grid and tree header behind the first 16
    /// bytes, until 32.6.0 of the root and its table too. All ones: there is no checksum.
    void check_head(const nanovdb::GridData& header, std::uint64_t root_end) const {
        constexpr std::uint64_t kSkipped = 16;
        const auto expected = static_cast<std::uint32_t>(header.mChecksum);
        const std::uint64_t end = header.mVersion <= nanovdb::Version(32, 6, 0)
                                      ? root_end
                                      : sizeof header + sizeof(nanovdb::TreeData<3>);
        if (expected != kNoChecksum && crc32(buffer_.data() + kSkipped, end - kSkipped) != expected)
            fail("header checksum does not match");
    }

    /// Checks the upper 32 bits: CRC over CRCs of the other bytes, in blocks of 4096 bytes, until
    /// 32.6.0 node by node.
    void check_nodes(const nanovdb::GridData& header) const {
        const auto expected = static_cast<std::uint32_t>(header.mChecksum >> 32);
        if (expected == kNoChecksum || kQuantised) return;  // versions differ for FpN leaves
        if (header.mVersion > nanovdb::Version(32, 6, 0)) {
            if (crc_of_blocks() != expected) fail("node checksum does not match");
            return;
        }
        std::vector<std::uint32_t> sums;
        const auto add = [&](const auto& one) {
            keep_memory();
            sums.push_back(crc32(&one, sizeof one));
        };
        for (const Upper* upper : uppers_) add(*upper);
        for (const Lower* lower : lowers_) add(*lower);
        for (const PlacedLeaf& placed : leaves_) add(*placed.leaf);
        // NanoVDB stored the CRCs as uint_fast32_t, of 8 bytes on some systems and 4 on others.
        const std::vector<std::uint64_t> wide(sums.begin(), sums.end());
        if (crc32(sums.data(), sums.size() * sizeof sums[0]) != expected &&
            crc32(wide.data(), wide.size() * sizeof wide[0]) != expected)
            fail("node checksum does not match");
    }

    std::uint32_t crc_of_blocks() const {
        constexpr std::size_t kBlock = 4096;
        constexpr std::size_t kBegin = sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<3>);
        std::vector<std::uint32_t> sums((buffer_.size() - kBegin) / kBlock);
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const std::size_t at = kBegin + i * kBlock;
            keep_memory();
            const bool last = i + 1 == sums.size();  // includes the remainder
            sums[i] = crc32(buffer_.data() + at, last ? buffer_.size() - at : kBlock);
        }
        return crc32(sums.data(), sums.size() * sizeof sums[0]);
    }

    static constexpr std::uint32_t kNoChecksum = ~std::uint32_t{0};
    const NanoBuffer& buffer_;
    const std::string& where_;
    NanoLeaves* volume_leaves_;
    std::uint64_t node_bytes_ = 0;
    std::vector<const Upper*> uppers_;
    std::vector<const Lower*> lowers_;
    std::vector<PlacedLeaf> leaves_;
};

using Reader = openvdb::GridBase::Ptr (*)(const NanoBuffer&, const std::string&, NanoLeaves*);

template <class Build, class GridT>
openvdb::GridBase::Ptr read_as(const NanoBuffer& buffer, const std::string& where,
                               NanoLeaves* leaves) {
    return NanoReader<Build, GridT>(buffer, where, leaves).read();
}

/// Null for a type that holds neither numbers nor vectors.
Reader reader_of(nanovdb::GridType type) {
    using nanovdb::GridType;
    switch (type) {
        case GridType::Float:
            return read_as<float, openvdb::FloatGrid>;
        case GridType::Double:
            return read_as<double, openvdb::DoubleGrid>;
        case GridType::Int16:
            return read_as<std::int16_t, openvdb::Int32Grid>;
        case GridType::Int32:
            return read_as<std::int32_t, openvdb::Int32Grid>;
        case GridType::Int64:
            return read_as<std::int64_t, openvdb::Int64Grid>;
        case GridType::UInt32:
            return read_as<std::uint32_t, openvdb::Int64Grid>;
        case GridType::Boolean:
            return read_as<bool, openvdb::BoolGrid>;
        case GridType::Mask:
            return read_as<nanovdb::ValueMask, openvdb::MaskGrid>;
        case GridType::Fp4:
            return read_as<nanovdb::Fp4, openvdb::FloatGrid>;
        case GridType::Fp8:
            return read_as<nanovdb::Fp8, openvdb::FloatGrid>;
        case GridType::Fp16:
            return read_as<nanovdb::Fp16, openvdb::FloatGrid>;
        case GridType::FpN:
            return read_as<nanovdb::FpN, openvdb::FloatGrid>;
        case GridType::Vec3f:
            return read_as<nanovdb::Vec3f, openvdb::Vec3SGrid>;
        case GridType::Vec3d:
            return read_as<nanovdb::Vec3d, openvdb::Vec3DGrid>;
        default:
            return nullptr;
    }
}

}  // namespace

bool is_readable(nanovdb::GridType type) { return reader_of(type) != nullptr; }

bool is_scalar(nanovdb::GridType type) {
    using enum nanovdb::GridType;
    for (const auto scalar : {Float, Double, Int16, Int32, Int64, UInt32, Fp4, Fp8, Fp16, FpN})
        if (type == scalar) return true;
    return false;
}

openvdb::GridBase::Ptr grid_from_nano(const NanoBuffer& buffer, const std::string& where,
                                      NanoLeaves* leaves) {
    const auto& header = *reinterpret_cast<const nanovdb::GridData*>(buffer.data());
    const Reader read = reader_of(header.mGridType);
    if (!read)
        throw Error(fmt::format("{}: holds {}, expected numbers or vectors", where,
                                nano_type_name(header.mGridType)));
    const openvdb::GridBase::Ptr grid = read(buffer, where, leaves);
    if (header.mGridClass == nanovdb::GridClass::LevelSet)
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
    if (header.mGridClass == nanovdb::GridClass::FogVolume)
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    if (header.mGridClass == nanovdb::GridClass::Staggered)
        grid->setGridClass(openvdb::GRID_STAGGERED);
    return grid;
}

Affine nano_transform(const NanoBuffer& buffer) {
    const auto& map = reinterpret_cast<const nanovdb::GridData*>(buffer.data())->mMap;
    Affine world_from_index;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            world_from_index.linear(row, column) = map.mMatD[3 * row + column];
        world_from_index.translation[row] = map.mVecD[row];
    }
    return world_from_index;
}

}  // namespace vog::nvdb
