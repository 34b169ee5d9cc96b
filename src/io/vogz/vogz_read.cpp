// vogz_read.cpp: reading compact models, whole or in part: the table, then the blobs that matter, decoded in parallel.
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "data/fields/field_limits.h"
#include "data/hierarchy_links.h"
#include "io/model_part.h"
#include "io/vogz/chunk_fields.h"
#include "io/vogz/chunk_shapes.h"
#include "io/vogz/file_table.h"
#include "vog/error.h"
#include "vog/vogz.h"

namespace vog {

using namespace vogz;

namespace {

/// A blob to read: its place in the file, and that of its Gaussians in the result.
struct Reading {
    const Blob* blob;
    std::uint64_t offset;
    std::size_t begin;
    bool to_nodes;  ///< into the hierarchy in place of the model
};
/// Shapes, and the blobs of the same Gaussians.
using Readings = std::vector<Reading>;

/// A file and its table.
struct OpenFile {
    FileBytes bytes;
    FileTable table;

    explicit OpenFile(const std::filesystem::path& file)
        : bytes(file), table(read_table(bytes, bytes.size())) {}
};

void allocate(Gaussians& model, const FileTable& table, std::size_t count) {
    // Side by side: most of the time goes into the system's pages.
    tbb::parallel_invoke([&] { model.mean.resize(count); }, [&] { model.scale.resize(count); },
                         [&] { model.density.resize(count); },
                         [&] { model.rotation.resize(table.rotated ? count : 0); });
    each_array([&](auto& array) { array.resize(count); }, model.fields);
}

/// Fields of a file that are read: for each of the file's its place in `fields` by kind, or none.
struct ChosenFields {
    Fields fields;  ///< names, units and ranges
    std::vector<std::optional<std::size_t>> place;
};
ChosenFields choose(const FileTable& table, const std::filesystem::path& file,
                    const std::optional<std::vector<std::string>>& names) {
    const Fields& all = table.description.fields;
    std::set<std::string> wanted;
    if (names) wanted.insert(names->begin(), names->end());
    for (const std::string& name : wanted)
        if (!all.find_scalar(name) && !all.find_vector(name))
            throw Error(fmt::format("{}: no field '{}' (it has: {})", file.string(), name,
                                    fmt::join(all.names(), ", ")));
    ChosenFields chosen;
    const auto take = [&](const auto& from, auto& to) {
        for (const auto& field : from) {
            const bool kept = !names || wanted.contains(field.name);
            chosen.place.push_back(kept ? std::optional(to.size()) : std::nullopt);
            if (kept) to.push_back(field);
        }
    };
    take(all.scalar, chosen.fields.scalar);
    take(all.vector, chosen.fields.vector);
    return chosen;
}

/// Decodes a chunk's blobs.
/// bytes  of the chunk, from the first of its blobs that is read to the last
void decode(const FileTable& table, const ChosenFields& chosen, const Readings& chunk,
            std::span<const char> bytes, const std::string& name, Gaussians& model,
            Hierarchy* hierarchy) {
    std::vector<double> spread(chunk.front().blob->count);
    const std::size_t scalars = table.description.fields.scalar.size();
    for (const Reading& reading : chunk) {
        const Blob& blob = *reading.blob;
        const std::span<const char> own =
            bytes.subspan(reading.offset - chunk.front().offset, blob.bytes);
        MemoryBytes in(own, name, reading.offset);
        if (checksum(own) != blob.checksum) in.fail("corrupt: wrong checksum of a chunk");
        Gaussians& to = reading.to_nodes ? hierarchy->nodes : model;
        switch (blob.kind) {
            case Kind::gaussians:
            case Kind::nodes:
                read_shapes(in, table.shapes, table.compression, to, reading.begin, spread);
                break;
            case Kind::links:
                read_links(in, table.compression, *hierarchy, reading.begin,
                           reading.begin + blob.count);
                break;
            case Kind::field: {
                const std::size_t place = *chosen.place[blob.field];
                const FieldRounding& rounding = table.fields[blob.field];
                if (blob.field < scalars)
                    read_field(in, rounding, table.compression, to.fields.scalar[place],
                               reading.begin, spread);
                else
                    read_field(in, rounding, table.compression, to.fields.vector[place],
                               reading.begin, spread);
                break;
            }
        }
        if (!in.at_end()) in.fail("corrupt: a chunk longer than its numbers");
    }
}

bool overlap(const Blob& blob, const Box& box, Vec3d origin) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        if (origin[axis] + double{blob.box[a]} > box.upper[axis] ||
            origin[axis] + double{blob.box[a + 3]} < box.lower[axis])
            return false;
    }
    return true;
}

/// Part of a file, and the run of Gaussians whose chunks are read.
struct Selection : VogzPart {
    std::uint64_t begin = 0, end = std::numeric_limits<std::uint64_t>::max();
};

/// Chunks of a part of a model, in the order of the file.
/// hierarchy  whether nodes go to a hierarchy
std::vector<Readings> chosen_chunks(const FileTable& table, const ChosenFields& chosen,
                                    const Selection& part, bool hierarchy, std::size_t& count,
                                    std::size_t& nodes) {
    std::vector<Readings> chunks;
    std::uint64_t offset = table.body_offset;
    std::uint64_t first = 0;  // Gaussian of the file
    bool kept = false, to_nodes = false;
    for (const Blob& blob : table.blobs) {
        if (blob.kind == Kind::gaussians || blob.kind == Kind::nodes) {
            to_nodes = blob.kind == Kind::nodes && hierarchy;
            kept = blob.kind == Kind::nodes
                       ? hierarchy || (part.level && blob.depth == *part.level)
                       : !part.level || (blob.depth > 0 && blob.depth <= *part.level);
            kept = kept && (!part.box || overlap(blob, *part.box, table.description.origin));
            if (blob.kind == Kind::gaussians) {
                kept = kept && first < part.end && first + blob.count > part.begin;
                first += blob.count;
            }
            if (kept) {
                std::size_t& filled = to_nodes ? nodes : count;
                chunks.push_back({{&blob, offset, filled, to_nodes}});
                filled += blob.count;
            }
        } else if (kept &&
                   (blob.kind == Kind::links ? to_nodes : chosen.place[blob.field].has_value())) {
            chunks.back().push_back({&blob, offset, chunks.back().front().begin, to_nodes});
        }
        offset += blob.bytes;
    }
    return chunks;
}

/// in  the opened file
Gaussians read(OpenFile& in, const std::filesystem::path& file, const Selection& part,
               Hierarchy* hierarchy) {
    const FileTable& table = in.table;
    const ChosenFields chosen = choose(table, file, part.fields);
    std::size_t count = 0, nodes = 0;
    const std::vector<Readings> chunks =
        chosen_chunks(table, chosen, part, hierarchy != nullptr, count, nodes);
    Gaussians model = table.description;
    model.fields = chosen.fields;
    allocate(model, table, count);
    if (hierarchy) {
        *hierarchy = {};
        hierarchy->nodes.cutoff = model.cutoff;
        hierarchy->nodes.origin = model.origin;
        if (nodes > 0) {
            hierarchy->nodes.fields = empty_fields(model.fields);
            allocate(hierarchy->nodes, table, nodes);
        }
        hierarchy->node_count.resize(nodes), hierarchy->leaf_count.resize(nodes);
        hierarchy->radius.resize(nodes), hierarchy->error.resize(nodes);
    }
    // Some chunks at a time: the file is not held whole.
    constexpr std::size_t kAtOnce = 256;
    for (std::size_t first = 0; first < chunks.size(); first += kAtOnce) {
        const std::size_t last = std::min(first + kAtOnce, chunks.size());
        std::vector<BigVector<char>> bytes;
        for (std::size_t n = first; n < last; ++n)
            bytes.push_back(in.bytes.range(chunks[n].front().offset,
                                           chunks[n].back().offset + chunks[n].back().blob->bytes));
        vog::parallel_for(first, last, [&](std::size_t n) {
            decode(table, chosen, chunks[n], bytes[n - first], file.string(), model, hierarchy);
        });
    }
    // Messages of validate() name the model's source: here the file that was read.
    const std::string source = std::exchange(model.source, file.string());
    validate(model);
    model.source = source;
    limit_planes(model);  // of older versions, and rounded ones
    if (hierarchy && nodes > 0) {
        link(*hierarchy, model.size(), file.string());
        validate(*hierarchy, model, file.string());
        limit_planes(hierarchy->nodes);
    }
    return model;
}

std::vector<std::size_t> level_sizes(const FileTable& table) {
    std::vector<std::size_t> sizes;
    for (const Blob& blob : table.blobs) {
        if (blob.kind != Kind::nodes) continue;
        if (blob.depth >= sizes.size()) sizes.resize(std::min<std::size_t>(blob.depth, 255) + 1);
        sizes[std::min<std::size_t>(blob.depth, 255)] += blob.count;
    }
    return sizes;
}

/// Why a page cannot stream a file; empty: it can.
std::string not_streamed(const FileTable& table) {
    std::string why;
    const auto starts =
        std::ranges::count_if(table.tree, [](const TreeChunk& chunk) { return !chunk.parent; });
    if (table.compression != Compression::deflate)
        why = "packed by zstd, which browsers have not";
    else if (table.tree.empty())
        why = "without the tree of its levels";
    else if (starts != 1)
        why = fmt::format("of {} trees, which have no level in common", starts);
    return why.empty()
               ? why
               : why + ": expected one of vog pack MODEL -o FILE.vogz --hierarchy --deflate";
}

}  // namespace

VogzInfo read_vogz_info(const std::filesystem::path& file) {
    OpenFile in(file);
    VogzInfo info;
    info.gaussians = in.table.count(Kind::gaussians);
    info.levels = level_sizes(in.table);
    info.chunks = static_cast<std::size_t>(std::ranges::count_if(
        in.table.blobs, [](const Blob& blob) { return blob.kind == Kind::gaussians; }));
    info.precision = in.table.precision;
    info.not_streamed = not_streamed(in.table);
    info.description = std::move(in.table.description);
    return info;
}

Gaussians read_vogz(const std::filesystem::path& file, Hierarchy* hierarchy) {
    OpenFile in(file);
    return read(in, file, {}, hierarchy);
}

Gaussians read_vogz(const std::filesystem::path& file, const VogzPart& part) {
    OpenFile in(file);
    if (part.level) {
        const std::size_t depths = level_sizes(in.table).size();
        if (*part.level >= depths)
            throw Error(fmt::format("{}: level {}, expected below {}{}", file.string(), *part.level,
                                    depths, depths ? "" : ": it was written without levels"));
    }
    return read(in, file, {part}, nullptr);
}

Gaussians read_vogz(const std::filesystem::path& file, const ModelPart& part) {
    require_part(part, file.string());
    OpenFile in(file);
    Selection selection;
    std::tie(selection.begin, selection.end) = run_of(part, in.table.count(Kind::gaussians));
    if (selection.begin == selection.end) selection.begin = selection.end = 0;
    const Gaussians chunks = read(in, file, selection, nullptr);
    // Chunks are whole: those at both ends reach out of the part.
    std::uint64_t first = 0;
    for (const Blob& blob : in.table.blobs) {
        if (blob.kind != Kind::gaussians) continue;
        if (first + blob.count > selection.begin) break;
        first += blob.count;
    }
    std::vector<std::size_t> own(selection.end - selection.begin);
    std::iota(own.begin(), own.end(), selection.begin - first);
    Gaussians model = select(chunks, own);
    model.source_voxels = chunks.source_voxels;
    model.summary = chunks.summary;
    return model;
}

}  // namespace vog
