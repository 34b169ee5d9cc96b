// subtree.cpp: chunks in parallel; tables from the leaves up; parts of processes by groups of eight.
#include "io/site/tree/subtree.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "io/site/chunk_file.h"
#include "io/site/tree/chunk_tree.h"
#include "io/site/tree/subtree_message.h"

namespace vog::site {

namespace {

/// Depths of rows that one file has: parts and their parts, some 72 rows in 14 kB. Deeper ones have tables of their own, so
/// that a view reads rows where it reads chunks.
constexpr int kDepthsOfFile = 2;
/// Parts of processes that are joined at once: as many as a chunk has parts elsewhere.
constexpr std::size_t kGroup = 8;

template <class T>
void append_run(BigVector<T>& to, const BigVector<T>& from, Run run) {
    to.insert(to.end(), from.begin() + run.first, from.begin() + run.last);
}
void append_run(Gaussians& to, const Gaussians& from, Run run, bool rotated) {
    append_run(to.mean, from.mean, run);
    append_run(to.scale, from.scale, run);
    append_run(to.density, from.density, run);
    if (rotated && from.axis_aligned())
        to.rotation.resize(to.mean.size());
    else if (rotated)
        append_run(to.rotation, from.rotation, run);
    each_array([&](auto& array, const auto& other) { append_run(array, other, run); }, to.fields,
               from.fields);
}

/// No Gaussians of the same origin, cutoff and fields.
Gaussians none_like(const Gaussians& model) {
    Gaussians none;
    none.origin = model.origin;
    none.cutoff = model.cutoff;
    none.fields = empty_fields(model.fields);
    return none;
}

/// Nodes, then Gaussians of a chunk.
Gaussians gathered(const Chunk& chunk, const Gaussians& model, const Hierarchy& hierarchy,
                   bool rotated) {
    Gaussians out = none_like(model);
    append_run(out, hierarchy.nodes, chunk.nodes, rotated);
    for (const Run run : chunk.leaves) append_run(out, model, run, rotated);
    return out;
}

void widen(std::array<float, 6>& box, const std::array<float, 6>& by) {
    for (std::size_t k = 0; k < 3; ++k) {
        box[k] = std::min(box[k], by[k]);
        box[k + 3] = std::max(box[k + 3], by[k + 3]);
    }
}

/// Counts of a chunk among those of its depth.
void count(SiteLevel& level, const Row& row) {
    ++level.chunks;
    level.gaussians += row.gaussians;
    level.bytes += row.all_bytes();
    level.error = std::max(level.error, double{row.error});
}
/// Adds levels to those from `depth` on.
void count(std::vector<SiteLevel>& levels, std::size_t depth, std::span<const SiteLevel> more) {
    levels.resize(std::max(levels.size(), depth + more.size()));
    for (std::size_t n = 0; n < more.size(); ++n) {
        SiteLevel& level = levels[depth + n];
        level.chunks += more[n].chunks;
        level.gaussians += more[n].gaussians;
        level.bytes += more[n].bytes;
        level.error = std::max(level.error, more[n].error);
    }
}

/// Moves the rows of a chunk's parts into its own, `depths` of them; below, into tables.
void nest(ChunkFolder& folder, std::vector<Row>& rows, const std::vector<Chunk>& chunks,
          std::size_t n, int depths) {
    Row& row = rows[n];
    const Run parts = chunks[n].parts;
    if (parts.size() == 0) return;
    for (std::size_t part = parts.first; part < parts.last; ++part) {
        nest(folder, rows, chunks, part, depths == 0 ? kDepthsOfFile - 1 : depths - 1);
        row.parts.push_back(std::move(rows[part]));
    }
    if (depths == 0) folder.write_table(row);
}

/// The parts' coarsest chunks as one chunk: nodes first.
Subtree one_chunk(std::vector<Subtree> parts, const Coding& coding) {
    Subtree whole;
    Row& row = whole.row;
    whole.chunk = none_like(parts.front().chunk);
    row.box = parts.front().row.box;
    for (const bool nodes : {true, false})
        for (const Subtree& part : parts)
            append_run(whole.chunk, part.chunk,
                       nodes ? Run{0, part.row.nodes} : Run{part.row.nodes, part.row.gaussians},
                       coding.rotated);
    for (Subtree& part : parts) {
        row.nodes += part.row.nodes;
        row.gaussians += part.row.gaussians;
        row.error = std::max(row.error, part.row.error);
        widen(row.box, part.row.box);
        std::ranges::move(part.row.parts, std::back_inserter(row.parts));
        count(whole.levels, 1, std::span(part.levels).subspan(1));
    }
    count(whole.levels.front(), row);
    return whole;
}

/// Chunk of nodes above the parts' coarsest chunks, which are written.
Subtree chunk_above(ChunkFolder& folder, const Coding& coding, std::vector<Subtree> parts,
                    std::size_t most, const HierarchyBuilder& build) {
    Gaussians all = none_like(parts.front().chunk);
    for (const Subtree& part : parts)
        append_run(all, part.chunk, {0, part.row.gaussians}, coding.rotated);
    const Hierarchy hierarchy = build(all);
    const Chunk cut = chunk_tree(hierarchy, all.size(), most, most).front();

    Subtree above;
    Row& row = above.row;
    above.chunk = gathered(cut, all, hierarchy, coding.rotated);
    row.nodes = row.gaussians = static_cast<std::uint32_t>(above.chunk.size());
    row.box = box_of(above.chunk, coding.precision.step);
    for (std::uint32_t n = cut.nodes.first; n < cut.nodes.last; ++n)
        row.error = std::max(row.error, hierarchy.error[n]);
    vog::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
        write_root(folder, coding, parts[n]);
        if (!parts[n].row.parts.empty()) folder.write_table(parts[n].row);
    });
    for (Subtree& part : parts) {
        row.error = std::max(row.error, part.row.error);
        widen(row.box, part.row.box);
        row.parts.push_back(std::move(part.row));
        count(above.levels, 1, part.levels);
    }
    count(above.levels.front(), row);
    return above;
}

}  // namespace

Subtree write_tree(ChunkFolder& folder, const Coding& coding, const Gaussians& model,
                   const Hierarchy& hierarchy, bool is_part) {
    if (model.size() == 0) return {};
    const std::vector<Chunk> chunks =
        chunk_tree(hierarchy, model.size(), is_part ? kMostOfChunk : kMostOfRoot);
    std::vector<Row> rows(chunks.size());
    Subtree tree;
    vog::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t n) {
        Gaussians chunk = gathered(chunks[n], model, hierarchy, coding.rotated);
        Row& row = rows[n];
        row.nodes = static_cast<std::uint32_t>(chunks[n].nodes.size());
        row.gaussians = static_cast<std::uint32_t>(chunk.size());
        for (std::uint32_t node = chunks[n].nodes.first; node < chunks[n].nodes.last; ++node)
            row.error = std::max(row.error, hierarchy.error[node]);
        row.box = box_of(chunk, coding.precision.step);
        if (is_part && n == 0)
            tree.chunk = std::move(chunk);
        else
            folder.write_chunk(row,
                               chunk_contents(chunk, row.nodes, coding.precision, coding.fields));
    });
    // Chunks are breadth first: parts come behind what they belong to.
    for (std::size_t n = chunks.size(); n-- > 0;) {
        if (chunks[n].depth >= tree.levels.size()) tree.levels.resize(chunks[n].depth + 1);
        count(tree.levels[chunks[n].depth], rows[n]);
        for (std::size_t part = chunks[n].parts.first; part < chunks[n].parts.last; ++part)
            widen(rows[n].box, rows[part].box);
    }
    nest(folder, rows, chunks, 0, kDepthsOfFile);
    tree.row = std::move(rows.front());
    return tree;
}

void write_root(ChunkFolder& folder, const Coding& coding, Subtree& tree) {
    folder.write_chunk(tree.row,
                       chunk_contents(tree.chunk, tree.row.nodes, coding.precision, coding.fields));
    tree.levels.front().bytes += tree.row.all_bytes();
    tree.chunk = {};
}

Subtree joined(ChunkFolder& folder, const Coding& coding, std::vector<Subtree> parts,
               std::size_t most, const HierarchyBuilder& build) {
    std::erase_if(parts, [](const Subtree& part) { return part.row.gaussians == 0; });
    if (parts.empty()) return {};
    std::size_t size = 0;
    for (const Subtree& part : parts) size += part.row.gaussians;
    return size <= most ? one_chunk(std::move(parts), coding)
                        : chunk_above(folder, coding, std::move(parts), most, build);
}

Subtree joined_over(const Collective& processes, ChunkFolder& folder, const Coding& coding,
                    Subtree tree, const Gaussians& like, const HierarchyBuilder& build) {
    std::vector<std::size_t> holders(static_cast<std::size_t>(processes.count));
    std::iota(holders.begin(), holders.end(), std::size_t{0});
    const auto self = static_cast<std::size_t>(processes.index);
    while (holders.size() > 1) {
        const std::size_t groups = (holders.size() + kGroup - 1) / kGroup;
        std::vector<std::string> to(static_cast<std::size_t>(processes.count));
        std::vector<std::size_t> firsts, own;  // own: the group whose first this process is
        for (std::size_t group = 0; group < groups; ++group) {
            const std::size_t begin = group * holders.size() / groups,
                              end = (group + 1) * holders.size() / groups;
            firsts.push_back(holders[begin]);
            for (std::size_t n = begin; n < end; ++n) {
                if (holders[begin] == self) own.push_back(holders[n]);
                if (holders[n] == self && n > begin)
                    to[holders[begin]] = message_of(std::exchange(tree, {}));
            }
        }
        const std::vector<std::string> from = processes.exchange_bytes(to);
        std::vector<Subtree> parts;
        for (const std::size_t other : own)
            parts.push_back(other == self ? std::move(tree) : subtree_of(from[other], like));
        if (!own.empty())
            tree = joined(folder, coding, std::move(parts),
                          groups == 1 ? kMostOfRoot : kMostOfChunk, build);
        holders = std::move(firsts);
    }
    return tree;
}

}  // namespace vog::site
