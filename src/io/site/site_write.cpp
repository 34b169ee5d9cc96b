// site_write.cpp: chunks of models into a folder, in parallel; tables from the leaves up; the manifest last.
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "data/field_arrays.h"
#include "data/hierarchy_links.h"
#include "io/site/chunk_file.h"
#include "io/site/chunk_name.h"
#include "io/site/chunk_tree.h"
#include "io/site/manifest.h"
#include "io/vogz/vogz_bytes.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog {

using namespace site;

namespace {

namespace fs = std::filesystem;

/// Depths of rows that one file has: parts and their parts, some 72 rows in 14 kB. Deeper ones have tables of their own, so
/// that a view reads rows where it reads chunks.
constexpr int kDepthsOfFile = 2;

void make_folder(const fs::path& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder))
        throw Error(fmt::format("{}: cannot be made: {}", folder.string(),
                                code ? code.message() : "a file of this name exists"));
}

/// throws vog::Error for a folder with a page that is no site's
void require_own(const fs::path& folder) {
    std::error_code code;
    if (fs::exists(folder / kManifestName, code)) {
        try {
            read_manifest(folder);
        } catch (const Error& error) {
            throw Error(fmt::format("{}; expected a new folder, or one that vog export wrote",
                                    error.what()));
        }
    } else if (fs::exists(folder / "index.html", code)) {
        throw Error(fmt::format(
            "{}: has an index.html and no manifest of a site, expected a new folder, or one that "
            "vog export wrote",
            folder.string()));
    }
}

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

/// Nodes, then Gaussians of a chunk.
Gaussians gathered(const Chunk& chunk, const Gaussians& model, const Hierarchy& hierarchy,
                   bool rotated) {
    Gaussians out;
    out.origin = model.origin;
    out.cutoff = model.cutoff;
    out.fields = empty_fields(model.fields);
    append_run(out, hierarchy.nodes, chunk.nodes, rotated);
    for (const Run run : chunk.leaves) append_run(out, model, run, rotated);
    return out;
}

}  // namespace

struct SiteWriter::State {
    fs::path folder;
    VogzPrecision precision;
    Manifest manifest;
    SiteReport report;
    std::set<std::string> files;  ///< names of files in the folder of chunks
    std::mutex mutex;

    /// Writes a file of the folder of chunks unless it is there. returns whether it was
    bool put(const fs::path& file, const std::string& bytes);
    void write_chunk(Row& row, const std::vector<std::string>& contents);
    void nest(std::vector<Row>& rows, const std::vector<Chunk>& chunks, std::size_t n, int depths);
};

bool SiteWriter::State::put(const fs::path& file, const std::string& bytes) {
    {
        const std::lock_guard lock(mutex);
        if (!files.insert(file.filename().string()).second) return true;
    }
    std::error_code code;
    const bool there = fs::is_regular_file(file, code) && fs::file_size(file, code) == bytes.size();
    if (!there) write_file(file, [&](std::ofstream& out) { out << bytes; });
    const std::lock_guard lock(mutex);
    report.bytes += bytes.size();
    return there;
}

void SiteWriter::State::write_chunk(Row& row, const std::vector<std::string>& contents) {
    row.name = content_name(contents);
    // The shapes come last: a chunk that has them is whole.
    bool there = true;
    for (std::size_t k = contents.size(); k-- > 0;) {
        const fs::path file =
            k == 0 ? shapes_path(folder, row.name) : field_path(folder, row.name, k - 1);
        there = put(file, contents[k]) && there;
    }
    for (const std::string& content : contents)
        row.bytes.push_back(static_cast<std::uint32_t>(content.size()));
    const std::lock_guard lock(mutex);
    report.kept += there ? 1 : 0;
}

/// Moves the rows of a chunk's parts into its own, `depths` of them; below, into tables.
void SiteWriter::State::nest(std::vector<Row>& rows, const std::vector<Chunk>& chunks,
                             std::size_t n, int depths) {
    Row& row = rows[n];
    const Run parts = chunks[n].parts;
    if (parts.size() == 0) return;
    for (std::size_t part = parts.first; part < parts.last; ++part) {
        nest(rows, chunks, part, depths == 0 ? kDepthsOfFile - 1 : depths - 1);
        row.parts.push_back(std::move(rows[part]));
    }
    if (depths > 0) return;
    const std::string text = table_text(row.parts);
    row.table = content_name(std::span(&text, 1));
    row.table_bytes = static_cast<std::uint32_t>(text.size());
    put(table_path(folder, row.table), text);
    row.parts.clear();
}

SiteWriter::SiteWriter(const fs::path& folder, const VogzPrecision& precision)
    : state_(std::make_unique<State>()) {
    vogz::require_valid(precision);
    state_->folder = folder;
    state_->precision = precision;
    require_own(folder);
    make_folder(folder);
    make_folder(folder / kChunksName);
}
SiteWriter::~SiteWriter() = default;

void SiteWriter::add(const std::string& name, const Gaussians& model, const Hierarchy& hierarchy) {
    State& s = *state_;
    const std::string where = fmt::format("{}: {}", s.folder.string(), name);
    validate(model);
    validate(hierarchy, model, where);
    if (model.size() == 0)
        throw Error(fmt::format("{}: no Gaussians, expected one at least", where));
    if (!in_one_order(hierarchy))
        throw Error(
            fmt::format("{}: a hierarchy joined from several, expected one built of the whole "
                        "model (build_hierarchy)",
                        where));
    const auto empty = std::ranges::find_if(model.density, [](float d) { return !(d > 0); });
    if (empty != model.density.end())
        throw Error(fmt::format("{}: Gaussian {} has no density, expected some", where,
                                empty - model.density.begin()));

    const bool rotated =
        !model.axis_aligned() || (!hierarchy.empty() && !hierarchy.nodes.axis_aligned());
    const std::vector<Chunk> chunks = chunk_tree(hierarchy, model.size());
    const auto roundings = field_roundings(model.fields, s.precision.field_step);
    std::vector<Row> rows(chunks.size());
    vog::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t n) {
        const Gaussians chunk = gathered(chunks[n], model, hierarchy, rotated);
        Row& row = rows[n];
        row.nodes = static_cast<std::uint32_t>(chunks[n].nodes.size());
        row.gaussians = static_cast<std::uint32_t>(chunk.size());
        for (std::uint32_t node = chunks[n].nodes.first; node < chunks[n].nodes.last; ++node)
            row.error = std::max(row.error, hierarchy.error[node]);
        row.box = box_of(chunk, s.precision.step);
        s.write_chunk(row, chunk_contents(chunk, row.nodes, s.precision, roundings));
    });

    ManifestModel out;
    out.name = name;
    out.description = select(model, {});
    out.description.source_voxels = model.source_voxels;
    out.description.summary = model.summary;
    out.rotated = rotated;
    out.gaussians = model.size();
    // Chunks are breadth first: parts come behind what they belong to.
    for (std::size_t n = chunks.size(); n-- > 0;) {
        if (chunks[n].depth >= out.levels.size()) out.levels.resize(chunks[n].depth + 1);
        SiteLevel& level = out.levels[chunks[n].depth];
        ++level.chunks;
        level.gaussians += rows[n].gaussians;
        level.bytes += rows[n].all_bytes();
        level.error = std::max(level.error, double{rows[n].error});
        for (std::size_t part = chunks[n].parts.first; part < chunks[n].parts.last; ++part)
            for (std::size_t k = 0; k < 3; ++k) {
                rows[n].box[k] = std::min(rows[n].box[k], rows[part].box[k]);
                rows[n].box[k + 3] = std::max(rows[n].box[k + 3], rows[part].box[k + 3]);
            }
    }
    s.nest(rows, chunks, 0, kDepthsOfFile);
    out.root = std::move(rows.front());
    s.report.gaussians += out.gaussians;
    s.report.chunks += chunks.size();
    if (s.manifest.models.empty()) s.report.root_bytes = out.root.bytes.front();
    s.manifest.models.push_back(std::move(out));
}

SiteReport SiteWriter::finish(bool steps) {
    State& s = *state_;
    if (s.manifest.models.empty())
        throw Error(fmt::format("{}: no model, expected one or more", s.folder.string()));
    s.manifest.steps = steps;
    const std::string text = manifest_text(s.manifest);
    write_file(s.folder / kManifestName, [&](std::ofstream& out) { out << text; });
    s.report.bytes += text.size();
    // Names of content alone: whatever else lies in the folder stays.
    for (const fs::directory_entry& entry : fs::directory_iterator(s.folder / kChunksName)) {
        const std::string file = entry.path().filename().string();
        if (!is_content_name(entry.path().stem().string()) || s.files.contains(file)) continue;
        std::error_code code;
        if (fs::remove(entry.path(), code)) ++s.report.removed;
    }
    return s.report;
}

}  // namespace vog
