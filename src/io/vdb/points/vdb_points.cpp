// vdb_points.cpp: reading of particles from a PointDataGrid. Decoded here, because OpenVDB 10.0.1
// does not check the sizes in a file. Source: passes in openvdb/points/PointDataGrid.h, pages in
// StreamCompression.h.
#include <blosc.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "core/paging.h"
#include "core/parallel.h"
#include "io/float_of.h"
#include "io/points/points_files.h"
#include "io/vdb/bytes/vdb_tree_check.h"
#include "io/vdb/points/vdb_point_codecs.h"
#include "io/vdb/vdb_volume.h"

namespace vog {

using namespace point_files;
using namespace vdb;

namespace {

constexpr std::string_view kPointTree = "Tree_ptdataidx32_5_4_3";

/// Bytes to which OpenVDB fills up smaller pages before it compresses them (BLOSC_PAD_BYTES).
constexpr std::size_t kFilledPage = 128;

/// Stored bytes in the file, and the range of decoded bytes they fill.
struct Packed {
    std::span<const char> from;
    std::size_t to = 0, bytes = 0;  ///< decoded: offset, size
    bool blosc = false;             ///< compressed
};

/// Encoded values of one attribute, leaf after leaf.
struct StoredColumn {
    std::vector<std::size_t> first;  ///< [leaf], offset of its values in `bytes`
    BigVector<char> bytes;           ///< empty until unpacked
};

void unpack(std::span<const Packed> packed, std::span<char> bytes, const MemoryBytes& in) {
    vog::parallel_for(std::size_t{0}, packed.size(), [&](std::size_t n) {
        const Packed& p = packed[n];
        if (!p.blosc) {
            std::copy(p.from.begin(), p.from.end(), bytes.begin() + std::ptrdiff_t(p.to));
            return;
        }
        std::size_t declared = 0;
        const bool valid = blosc_cbuffer_validate(p.from.data(), p.from.size(), &declared) == 0;
        std::array<char, kFilledPage> filled;
        const bool short_page = p.bytes < filled.size() && declared == filled.size();
        char* to = short_page ? filled.data() : bytes.data() + p.to;
        if (!valid || (declared != p.bytes && !short_page) ||
            blosc_decompress_ctx(p.from.data(), to, declared, 1) != static_cast<int>(declared))
            in.fail(fmt::format("corrupt: a page of points of {} bytes decompressed, expected {}",
                                declared, p.bytes));
        if (short_page) std::copy_n(filled.begin(), p.bytes, bytes.begin() + std::ptrdiff_t(p.to));
    });
}

/// Reads the passes with the bytes of the attributes.
class PointPasses {
  public:
    PointPasses(MemoryBytes& in, const CheckedTree& tree) : in_(in), tree_(tree) {
        for (std::size_t column = 0; column < columns(); ++column) page_sizes(column);
        voxel_ends();
        for (std::size_t column = 0; column < columns(); ++column) column_bytes(column);
    }
    std::size_t columns() const { return tree_.columns.size(); }
    const PointArray& array(std::size_t leaf, std::size_t column) const {
        return tree_.arrays[leaf * columns() + column];
    }
    StoredColumn unpacked(std::size_t column) const {
        StoredColumn stored = columns_[column];
        resize_kept(stored.bytes, total_[column]);
        unpack(packed_[column], stored.bytes, in_);
        return stored;
    }
    /// [leaf][512], end of each voxel's points.
    const BigVector<std::array<std::uint32_t, 512>>& ends() const { return ends_; }

  private:
    /// Reads the page headers of a column and computes the offset of each leaf's values.
    void page_sizes(std::size_t column) {
        StoredColumn& stored = columns_.emplace_back();
        std::vector<Packed>& pages = packed_.emplace_back();
        std::size_t total = 0, page_end = 0;
        for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
            const PointArray& a = array(leaf, column);
            stored.first.push_back(total);
            if (a.paged && total == page_end) {
                const auto packed_bytes = in_.number<std::int32_t>();
                const auto bytes = packed_bytes > 0 ? in_.number<std::int32_t>() : -packed_bytes;
                if (bytes < 0 || packed_bytes == std::numeric_limits<std::int32_t>::min())
                    in_.fail("corrupt: negative size of a page of points");
                // column_bytes finds the bytes in a later pass.
                pages.push_back({{static_cast<const char*>(nullptr), 0},
                                 total,
                                 static_cast<std::size_t>(bytes),
                                 packed_bytes > 0});
                sizes_.push_back(static_cast<std::size_t>(std::abs(packed_bytes)));
                page_end = total + static_cast<std::size_t>(bytes);
            }
            total += a.bytes;
            if (a.bytes > kMaxLeafBytes || (a.paged && total > page_end))
                in_.fail("corrupt: points outside of all pages");
            if (!a.paged) page_end = total;
        }
        if (total != page_end && !tree_.leaves.empty())
            in_.fail("corrupt: a page longer than its points");
        total_.push_back(total);
    }
    void voxel_ends() {
        resize_kept(ends_, tree_.leaves.size());
        constexpr std::uint64_t kMaskBytes = 64, kEndBytes = 512 * 4;
        constexpr std::uint16_t kNotPacked = 0xffff;
        for (auto& ends : ends_) {
            in_.take(kMaskBytes);
            const auto size = in_.number<std::uint16_t>();
            const char* from = in_.take(size == kNotPacked ? kEndBytes : size);
            const Packed packed{
                {from, size == kNotPacked ? kEndBytes : size}, 0, kEndBytes, size != kNotPacked};
            unpack({&packed, 1}, {reinterpret_cast<char*>(ends.data()), kEndBytes}, in_);
            keep_memory();
        }
    }
    /// Locates the bytes of a column's pages, or of its leaves if they are not paged.
    void column_bytes(std::size_t column) {
        std::vector<Packed>& packed = packed_[column];
        std::size_t page = 0;
        std::vector<Packed> unpaged;
        for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
            const PointArray& a = array(leaf, column);
            const std::size_t to = columns_[column].first[leaf];
            if (a.paged) {
                if (page < packed.size() && packed[page].to == to) {
                    const std::size_t bytes = sizes_[next_size_++];
                    packed[page++].from = {in_.take(bytes), bytes};
                }
                continue;
            }
            const bool blosc = !a.uniform && in_.number<std::uint8_t>() == 1;
            if (blosc) in_.fail("has attributes compressed one by one, expected pages");
            unpaged.push_back({{in_.take(a.bytes), a.bytes}, to, a.bytes, false});
        }
        packed.insert(packed.end(), unpaged.begin(), unpaged.end());
        // Decoded sizes beyond blosc's largest ratio are refused before memory is allocated.
        std::uint64_t stored = 0;
        for (const Packed& p : packed) stored += p.from.size();
        constexpr std::uint64_t kMaxRatio = 4096;
        if (total_[column] / kMaxRatio > stored)
            in_.fail("corrupt: more points than its bytes can hold");
    }
    static constexpr std::uint64_t kMaxLeafBytes = std::uint64_t{1} << 40;

    MemoryBytes& in_;
    const CheckedTree& tree_;
    std::vector<StoredColumn> columns_;
    std::vector<std::vector<Packed>> packed_;
    std::vector<std::size_t> sizes_, total_;
    std::size_t next_size_ = 0;
    BigVector<std::array<std::uint32_t, 512>> ends_;
};

/// Column with numbers of particles.
struct Numbers {
    std::size_t column = 0;
    PointCodec codec;
    StoredColumn stored;
};

class PointGridReader {
  public:
    PointGridReader(MemoryBytes& in, const CheckedTree& tree, const Affine& world_from_index)
        : in_(in), tree_(tree), world_from_index_(world_from_index), passes_(in, tree) {}

    Points read() {
        // Voxels and attributes must have the same number of points.
        first_.assign(1, 0);
        for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
            if (passes_.ends()[leaf].back() != passes_.array(leaf, 0).size)
                in_.fail("corrupt: points outside of all voxels");
            first_.push_back(first_.back() + passes_.array(leaf, 0).size);
        }
        const Numbers positions = numbers(column_named("P"));
        if (positions.codec.components != 3)
            in_.fail("positions 'P' are numbers, expected vectors");
        Points points;
        resize_kept(points.position, first_.back());
        for_each_leaf([&](std::size_t leaf) { read_positions(positions, leaf, points.position); });

        for (std::size_t column = 0; column < passes_.columns(); ++column) {
            const PointColumn& at = tree_.columns[column];
            if (at.name == "P" || !is_number(column)) continue;
            const Numbers found = numbers(column);
            const bool vector = found.codec.components == 3;
            if (vector && (at.name == "velocity" || at.name == "v") && points.velocity.empty())
                read_velocity(found, points.velocity);
            else
                read_attribute(
                    found, points.attributes.emplace_back(PointAttribute{printable(at.name), {}}));
        }
        return points;
    }

  private:
    std::size_t column_named(const std::string& name) const {
        const auto found = std::ranges::find(tree_.columns, name, &PointColumn::name);
        if (found == tree_.columns.end()) in_.fail(fmt::format("has no attribute '{}'", name));
        return static_cast<std::size_t>(found - tree_.columns.begin());
    }
    /// Whether a column holds one number or vector per point: no text, matrices, groups or arrays.
    bool is_number(std::size_t column) const {
        const PointColumn& at = tree_.columns[column];
        if (!find_codec(at.type, at.codec)) return false;
        for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf)
            if (passes_.array(leaf, column).stride != 1) return false;
        return true;
    }
    Numbers numbers(std::size_t column) const {
        const PointColumn& at = tree_.columns[column];
        if (!is_number(column))
            in_.fail(
                fmt::format("has '{}' as {} {}, expected numbers", at.name, at.type, at.codec));
        const PointCodec codec = *find_codec(at.type, at.codec);
        for (std::size_t leaf = 0; leaf < tree_.leaves.size(); ++leaf) {
            const PointArray& a = passes_.array(leaf, column);
            const std::uint64_t values = a.uniform ? 1 : a.size;
            if (a.size != passes_.array(leaf, 0).size || a.bytes != values * codec.bytes())
                in_.fail(fmt::format("corrupt: {} bytes for {} values of '{}'", a.bytes, values,
                                     at.name));
        }
        return {column, codec, passes_.unpacked(column)};
    }
    template <class Run>
    void for_each_leaf(const Run& run) const {
        vog::parallel_for(std::size_t{0}, tree_.leaves.size(), run);
    }
    Vec3d value(const Numbers& from, std::size_t leaf, std::size_t n) const {
        const std::size_t at = passes_.array(leaf, from.column).uniform ? 0 : n;
        return from.codec.decode(from.stored.bytes.data() + from.stored.first[leaf] +
                                 at * from.codec.bytes());
    }
    /// Converts positions, which are stored relative to the centre of their voxel.
    void read_positions(const Numbers& from, std::size_t leaf, BigVector<Vec3d>& to) const {
        const std::size_t count = first_[leaf + 1] - first_[leaf];
        std::size_t n = 0;
        for (std::size_t voxel = 0; voxel < 512; ++voxel) {
            const std::size_t end = passes_.ends()[leaf][voxel];
            if (end < n || end > count) in_.fail("corrupt: points of voxels not in order");
            const auto v = static_cast<std::int32_t>(voxel);
            const Vec3i index = tree_.leaves[leaf].origin + Vec3i{v >> 6, (v >> 3) & 7, v & 7};
            for (; n < end; ++n)
                to[first_[leaf] + n] =
                    world_from_index_(vec_cast<double>(index) + value(from, leaf, n));
        }
    }
    void read_velocity(const Numbers& from, BigVector<Vec3f>& to) const {
        resize_kept(to, first_.back());
        for_each_leaf([&](std::size_t leaf) {
            for (std::size_t n = first_[leaf]; n < first_[leaf + 1]; ++n)
                for (int axis = 0; axis < 3; ++axis)
                    to[n][axis] = float_of(value(from, leaf, n - first_[leaf])[axis]);
        });
    }
    /// Reads an attribute; vectors are replaced by their length.
    void read_attribute(const Numbers& from, PointAttribute& to) const {
        resize_kept(to.value, first_.back());
        const auto number = [&](std::size_t leaf, std::size_t n) {
            const Vec3d v = value(from, leaf, n - first_[leaf]);
            return from.codec.components == 3 ? length(v) : v.x;
        };
        // Doubles may lie beyond float's range.
        std::vector<double> largest(tree_.leaves.size(), 0);
        const bool wide = from.codec.element == PointCodec::Element::float64;
        for_each_leaf([&](std::size_t leaf) {
            for (std::size_t n = first_[leaf]; wide && n < first_[leaf + 1]; ++n)
                if (const double size = std::abs(number(leaf, n)); std::isfinite(size))
                    largest[leaf] = std::max(largest[leaf], size);
        });
        to.unit = float_unit(largest.empty() ? 0 : *std::ranges::max_element(largest));
        for_each_leaf([&](std::size_t leaf) {
            for (std::size_t n = first_[leaf]; n < first_[leaf + 1]; ++n)
                to.value[n] = float_of(number(leaf, n), to.unit);
        });
    }

    MemoryBytes& in_;
    const CheckedTree& tree_;
    const Affine world_from_index_;
    PointPasses passes_;
    std::vector<std::size_t> first_;  ///< [leaf], index of its first point
};

/// Grid of points with this name; without a name, likely_grid of the bytes of each.
/// note    receives the choice; null: not reported
/// throws vog::Error if there is none, or more than one of the name
const VdbEntry& point_entry(const VdbFile& file, const PointReadOptions& options,
                            std::string* note) {
    const std::string name = grid_name(options.grid);
    std::vector<const VdbEntry*> found;
    std::vector<std::string> names;
    for (const VdbEntry& entry : file.entries()) {
        names.push_back(entry.name);
        const bool matches = name.empty() || entry.name == name || entry.plain_name == name;
        if (matches && entry.tree_type == kPointTree) found.push_back(&entry);
    }
    if (found.size() == 1) return *found.front();
    if (name.empty() && !found.empty()) {
        names.clear();
        for (const VdbEntry* entry : found) names.push_back(entry->name);
        const auto bytes = [&](std::size_t n) {
            return static_cast<double>(found[n]->end - found[n]->begin);
        };
        const LikelyGrid likely = likely_grid(file.name(), names, bytes, options.refuse_several);
        if (note) *note = likely.note;
        return *found[likely.index];
    }
    throw Error(fmt::format("{}: {} grids of points{}, expected one (it has: {})", file.name(),
                            found.empty() ? "no" : std::to_string(found.size()),
                            name.empty() ? "" : fmt::format(" named '{}'", name),
                            fmt::join(names, ", ")));
}

}  // namespace

bool vdb_holds_points(const std::filesystem::path& path, const std::string& requested) {
    const VdbFile file(path);
    const std::string grid = grid_name(requested);
    bool points = false, density = false;
    for (const VdbEntry& entry : file.entries()) {
        if (!grid.empty() && entry.name != grid && entry.plain_name != grid) continue;
        (entry.tree_type == kPointTree ? points : density) = true;
    }
    return points && !density;
}

Points point_files::read_points_vdb(const std::filesystem::path& path,
                                    const PointReadOptions& options, std::string* note) {
    VdbFile file(path);
    const VdbEntry& entry = point_entry(file, options, note);
    const std::string where = file.where(entry);
    if (!entry.parent.empty())
        throw Error(fmt::format("{}: shares the tree of another grid, expected its own", where));
    return with_vdb_errors(where, [&] {
        const BigVector<char> bytes = file.bytes(entry);
        MemoryBytes in(bytes, where, entry.begin);
        const VdbHead head = read_vdb_head(in);
        if (!head.world_from_index)
            throw Error(fmt::format("{}: transform is a frustum, expected an affine one", where));
        TreeStorage storage{{4, 0, LeafData::points}, head.compression, entry.half_stored};
        const CheckedTree tree = check_tree(in, storage);
        if (tree.points == 0) throw Error(fmt::format("{}: no particles", where));
        Points points = PointGridReader(in, tree, *head.world_from_index).read();
        points.source = printable(file.name());
        validate(points);
        return points;
    });
}

}  // namespace vog
