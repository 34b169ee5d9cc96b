// vogz_write.cpp: writing compact models: order, chunks, rounding and coding in parallel, one file.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/atomic_file.h"
#include "core/morton.h"
#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "data/hierarchy_links.h"
#include "io/vogz/chunk_fields.h"
#include "io/vogz/chunk_shapes.h"
#include "io/vogz/file_table.h"
#include "io/vogz/vogz_bytes.h"
#include "vog/error.h"
#include "vog/vogz.h"

namespace vog {

using namespace vogz;

namespace {

/// A Gaussian's place along the Morton curve.
struct Place {
    std::uint64_t code;
    std::uint32_t gaussian;
};

/// Gaussians by place: dealt to runs of the curve by the upper bits of their codes, and sorted by the next 32 in each run, side
/// by side. Finer bits do not matter to their steps; equal ones stay in their order.
std::vector<std::uint32_t> sorted(const std::vector<Place>& places) {
    constexpr int kRunBits = 11, kKeyBits = 32;
    constexpr std::size_t kRuns = std::size_t{1} << kRunBits, kPart = std::size_t{1} << 15;
    std::uint64_t all = 0;
    for (const Place& place : places) all |= place.code;
    const int shift = std::max(0, static_cast<int>(std::bit_width(all)) - kRunBits),
              key_shift = std::max(0, shift - kKeyBits);
    // Parts count and deal in the order of the places, whatever the number of threads.
    const std::size_t parts = (places.size() + kPart - 1) / kPart;
    std::vector<std::array<std::uint32_t, kRuns>> next(parts);
    const auto each_place = [&](std::size_t part, const auto& use) {
        const std::size_t end = std::min(places.size(), (part + 1) * kPart);
        for (std::size_t n = part * kPart; n < end; ++n)
            use(places[n], next[part][places[n].code >> shift]);
    };
    vog::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        each_place(part, [](const Place&, std::uint32_t& count) { ++count; });
    });
    std::array<std::uint32_t, kRuns + 1> begin{};
    std::uint32_t at = 0;
    for (std::size_t run = 0; run < kRuns; ++run) {
        begin[run] = at;
        for (auto& counts : next) at += std::exchange(counts[run], at);
    }
    begin[kRuns] = at;
    std::vector<std::uint64_t> keys(places.size());  // 32 bits of a code, and the Gaussian
    vog::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        each_place(part, [&](const Place& place, std::uint32_t& to) {
            keys[to++] = place.code >> key_shift << kKeyBits | place.gaussian;
        });
    });
    std::vector<std::uint32_t> order(places.size());
    vog::parallel_for(std::size_t{0}, kRuns, [&](std::size_t run) {
        std::sort(keys.begin() + begin[run], keys.begin() + begin[run + 1]);
        for (std::uint32_t n = begin[run]; n < begin[run + 1]; ++n)
            order[n] = static_cast<std::uint32_t>(keys[n]);
    });
    return order;
}

/// Gaussians with density, in Morton order.
std::vector<std::uint32_t> morton_order(const Gaussians& model, const ShapeRounding& rounding) {
    std::vector<Place> places;
    places.reserve(model.size());
    for (std::uint32_t i = 0; i < model.size(); ++i)
        if (model.density[i] > 0) places.push_back({0, i});
    const double cells = 0.999 * (1 << kMortonAxisBits) / rounding.edge;
    vog::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
        const Vec3d at =
            cells * (vec_cast<double>(model.mean[places[n].gaussian]) - rounding.corner);
        places[n].code =
            morton_code(static_cast<std::uint64_t>(at.x), static_cast<std::uint64_t>(at.y),
                        static_cast<std::uint64_t>(at.z));
    });
    return sorted(places);
}

/// A run of Gaussians or nodes that becomes blobs of its own.
struct Chunk {
    Kind kind = Kind::gaussians;
    std::uint32_t depth = 0;
    std::size_t begin = 0, end = 0;
    TreeChunk place{};                 ///< in the tree
    std::vector<std::string> blobs{};  ///< shapes, links of nodes, fields
    std::array<float, 6> box{};
};

/// Runs of equal length of at most kChunk.
/// parent  place of the nodes above them; none: there are none
void divide(Kind kind, std::uint32_t depth, std::size_t begin, std::size_t end,
            std::optional<std::uint32_t> parent, std::vector<Chunk>& chunks) {
    const std::size_t parts = (end - begin + kChunk - 1) / kChunk;
    for (std::size_t part = 0; part < parts; ++part)
        chunks.push_back({kind,
                          depth,
                          begin + (end - begin) * part / parts,
                          begin + (end - begin) * (part + 1) / parts,
                          {parent}});
}

/// Chunks from the roots down: behind each depth the children of its chunks, those of one chunk side by side, nodes first. Nodes
/// and Gaussians keep their order.
/// leaves  number of Gaussians
std::vector<Chunk> chunks_of(const Hierarchy& hierarchy, std::size_t leaves) {
    std::vector<Chunk> chunks;
    std::size_t below = 0;
    for (const std::uint8_t count : hierarchy.node_count) below += count;
    std::size_t node = hierarchy.size() - below, leaf = 0;  // next ones without a chunk
    divide(Kind::nodes, 0, 0, node, {}, chunks);
    for (std::size_t n = 0; n < chunks.size(); ++n) {
        if (chunks[n].kind != Kind::nodes) continue;
        std::size_t node_end = node, leaf_end = leaf;
        for (std::size_t i = chunks[n].begin; i < chunks[n].end; ++i) {
            chunks[n].place.error = std::max(chunks[n].place.error, double{hierarchy.error[i]});
            node_end += hierarchy.node_count[i], leaf_end += hierarchy.leaf_count[i];
        }
        const auto parent = static_cast<std::uint32_t>(n);
        const std::uint32_t depth = chunks[n].depth + 1;
        divide(Kind::nodes, depth, std::exchange(node, node_end), node_end, parent, chunks);
        divide(Kind::gaussians, depth, std::exchange(leaf, leaf_end), leaf_end, parent, chunks);
    }
    divide(Kind::gaussians, 0, leaf, leaves, {}, chunks);
    return chunks;
}

/// Box of the supports of Gaussians, as rounded, in floats.
/// extent  standard deviations along the world's axes
/// step    VogzPrecision::step: what a mean moves by in standard deviations, and a support grows by
std::array<float, 6> box_of(const Gaussians& part, const std::array<std::vector<double>, 3>& extent,
                            double step) {
    constexpr float kMost = std::numeric_limits<float>::max();
    const auto outward = [](double v, float limit) {
        return std::nextafter(static_cast<float>(std::clamp<double>(v, -kMost, kMost)), limit);
    };
    const double reach = part.cutoff * (1 + 4 * step);
    std::array<float, 6> corners{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double lower = std::numeric_limits<double>::infinity(), upper = -lower;
        for (std::size_t n = 0; n < part.size(); ++n) {
            const double center = double{part.mean[n][static_cast<int>(axis)]};
            lower = std::min(lower, center - reach * extent[axis][n]);
            upper = std::max(upper, center + reach * extent[axis][n]);
        }
        corners[axis] = outward(lower, -kMost);
        corners[axis + 3] = outward(upper, kMost);
    }
    return corners;
}

/// A model on its way into a file.
struct Coding {
    const Gaussians& model;
    const Hierarchy& hierarchy;
    std::vector<std::uint32_t> leaf_order, node_order;
    FileTable table{};
    std::vector<Chunk> chunks{};
};

/// Means, shapes and densities of a chunk, one behind the other: its loops read memory in order.
Gaussians gathered(const Gaussians& model, std::span<const std::uint32_t> index) {
    Gaussians part;
    part.cutoff = model.cutoff;
    const auto take = [&](const auto& from, auto& to) {
        to.resize(index.size());
        for (std::size_t n = 0; n < index.size(); ++n) to[n] = from[index[n]];
    };
    take(model.mean, part.mean), take(model.scale, part.scale), take(model.density, part.density);
    if (!model.axis_aligned()) take(model.rotation, part.rotation);
    return part;
}

void encode(const Coding& coding, Chunk& chunk) {
    const bool nodes = chunk.kind == Kind::nodes;
    const Gaussians& model = nodes ? coding.hierarchy.nodes : coding.model;
    const std::span<const std::uint32_t> index =
        std::span(nodes ? coding.node_order : coding.leaf_order)
            .subspan(chunk.begin, chunk.end - chunk.begin);
    const FileTable& table = coding.table;
    const Gaussians part = gathered(model, index);
    std::vector<std::uint32_t> in_order(index.size());
    std::iota(in_order.begin(), in_order.end(), 0u);
    ShapeChunk shapes = shape_chunk(part, in_order, table.shapes, table.compression);
    chunk.blobs.push_back(std::move(shapes.bytes));
    chunk.box = box_of(part, shapes.extent, table.precision.step);
    if (nodes)
        chunk.blobs.push_back(link_chunk(coding.hierarchy, chunk.begin, chunk.end,
                                         table.precision.step, table.compression));
    auto rounding = table.fields.begin();
    const auto add = [&](const auto& field) {
        chunk.blobs.push_back(
            field_chunk(field, *rounding++, index, shapes.spread, table.compression));
    };
    std::ranges::for_each(model.fields.scalar, add);
    std::ranges::for_each(model.fields.vector, add);
}

/// All blobs of a model, and the table of them.
Coding coded(const Gaussians& model, const Hierarchy& hierarchy, const VogzOptions& options) {
    require_valid(options.precision);
    validate(model);
    if (model.size() >= std::numeric_limits<std::uint32_t>::max())
        throw Error(
            fmt::format("compact model: {} Gaussians, expected fewer than 2^32", model.size()));
    Coding coding{model, hierarchy, {}, {}};
    FileTable& table = coding.table;
    table.description = select(model, {});
    table.description.source_voxels = model.source_voxels;
    table.description.summary = model.summary;
    table.rotated = !model.axis_aligned();
    table.compression = options.deflate ? Compression::deflate : Compression::zstd;
    table.precision = options.precision;
    table.page = options.page;
    table.shapes = shape_rounding(model, options.precision.step);
    for (const ScalarField& field : model.fields.scalar)
        table.fields.push_back(field_rounding(field, options.precision.field_step));
    for (const VectorField& field : model.fields.vector)
        table.fields.push_back(field_rounding(field, options.precision.field_step));

    if (hierarchy.empty()) {
        coding.leaf_order = morton_order(model, table.shapes);
    } else {
        const auto empty = std::ranges::find_if(model.density, [](float d) { return !(d > 0); });
        if (empty != model.density.end())
            throw Error(fmt::format(
                "compact model: Gaussian {} has no density, expected some in a model with levels",
                empty - model.density.begin()));
        coding.leaf_order.resize(model.size());
        std::iota(coding.leaf_order.begin(), coding.leaf_order.end(), 0u);
        coding.node_order.resize(hierarchy.size());
        std::iota(coding.node_order.begin(), coding.node_order.end(), 0u);
    }
    coding.chunks = chunks_of(hierarchy, coding.leaf_order.size());
    vog::parallel_for(std::size_t{0}, coding.chunks.size(),
                      [&](std::size_t n) { encode(coding, coding.chunks[n]); });

    for (const Chunk& chunk : coding.chunks) {
        if (!hierarchy.empty()) table.tree.push_back(chunk.place);
        for (std::size_t n = 0; n < chunk.blobs.size(); ++n) {
            Blob blob;
            const std::size_t first_field = chunk.kind == Kind::nodes ? 2 : 1;
            blob.kind = n == 0 ? chunk.kind : n < first_field ? Kind::links : Kind::field;
            if (n >= first_field) blob.field = static_cast<std::uint32_t>(n - first_field);
            blob.depth = chunk.depth;
            blob.count = static_cast<std::uint32_t>(chunk.end - chunk.begin);
            blob.bytes = static_cast<std::uint32_t>(chunk.blobs[n].size());
            blob.checksum = checksum(chunk.blobs[n]);
            blob.box = chunk.box;
            table.blobs.push_back(blob);
        }
    }
    return coding;
}

/// Calls a function with each blob in the order of the table.
template <class Use>
void for_each_blob(const Coding& coding, const Use& use) {
    for (const Chunk& chunk : coding.chunks) std::ranges::for_each(chunk.blobs, use);
}

}  // namespace

void vogz::require_valid(const VogzPrecision& precision) {
    for (const auto& [name, step] :
         {std::pair("step", precision.step), std::pair("field_step", precision.field_step)})
        if (!(step >= 1e-6 && step <= 0.5))
            throw Error(fmt::format("compact model: {} {}, expected from 1e-6 to 0.5", name, step));
}

std::string vogz::bytes_of(const Gaussians& gaussians, const VogzOptions& options) {
    Coding coding = coded(gaussians, {}, options);
    Gaussians& description = coding.table.description;
    description.source = description.method = description.options = description.summary = {};
    std::string bytes = header_bytes(coding.table);
    for_each_blob(coding, [&](const std::string& blob) { bytes += blob; });
    return bytes;
}

VogzReport write_vogz(const std::filesystem::path& file, const Gaussians& gaussians,
                      const Hierarchy& hierarchy, const VogzOptions& options) {
    validate(hierarchy, gaussians, file.string());
    if (!in_one_order(hierarchy))
        throw Error(
            fmt::format("{}: a hierarchy joined from several, expected one built of the whole "
                        "model (build_hierarchy)",
                        file.string()));
    const Coding coding = coded(gaussians, hierarchy, options);
    const std::string header = header_bytes(coding.table);
    write_file(file, [&](std::ofstream& out) {
        out << header;
        for_each_blob(coding, [&](const std::string& blob) { out << blob; });
    });
    VogzReport report;
    report.gaussians = coding.leaf_order.size();
    report.left_out = gaussians.size() - report.gaussians;
    report.header = header.size();
    report.bytes = header.size();
    for (const std::string& name : gaussians.fields.names()) report.fields.emplace_back(name, 0);
    bool nodes = false;
    for (const Blob& blob : coding.table.blobs) {
        if (blob.kind != Kind::field) nodes = blob.kind != Kind::gaussians;
        (nodes                      ? report.levels
         : blob.kind == Kind::field ? report.fields[blob.field].second
                                    : report.shapes) += blob.bytes;
        report.bytes += blob.bytes;
    }
    return report;
}

Gaussians rounded(const Gaussians& gaussians, const VogzPrecision& precision) {
    VogzOptions options;
    options.precision = precision;
    const Coding coding = coded(gaussians, {}, options);
    Gaussians result = gaussians;
    vog::parallel_for(std::size_t{0}, coding.chunks.size(), [&](std::size_t n) {
        const Chunk& chunk = coding.chunks[n];
        const std::size_t count = chunk.end - chunk.begin;
        Gaussians part = select(gaussians, std::vector<std::size_t>(count, 0));
        std::vector<double> spread(count);
        const auto source = [&](std::size_t blob) {
            return MemoryBytes(chunk.blobs[blob], gaussians.source, 0);
        };
        MemoryBytes shapes = source(0);
        read_shapes(shapes, coding.table.shapes, coding.table.compression, part, 0, spread);
        std::size_t blob = 1;
        const auto read = [&](auto& field) {
            MemoryBytes in = source(blob);
            read_field(in, coding.table.fields[blob - 1], coding.table.compression, field, 0,
                       spread);
            ++blob;
        };
        std::ranges::for_each(part.fields.scalar, read);
        std::ranges::for_each(part.fields.vector, read);
        const auto place = [&](auto& to, const auto& from) {
            for (std::size_t k = 0; k < from.size(); ++k)
                to[coding.leaf_order[chunk.begin + k]] = from[k];
        };
        place(result.mean, part.mean), place(result.scale, part.scale);
        place(result.rotation, part.rotation), place(result.density, part.density);
        each_array(place, result.fields, part.fields);
    });
    return result;
}

}  // namespace vog
