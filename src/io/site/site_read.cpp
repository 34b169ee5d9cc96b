// site_read.cpp: descriptions and whole models of sites.
#include <fmt/core.h>

#include <algorithm>

#include "core/parallel.h"
#include "data/field_arrays.h"
#include "io/site/chunk_file.h"
#include "io/site/manifest.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog {

using namespace site;

namespace {

/// Appends a chunk's row and those of all below, without their parts.
void collect(const std::filesystem::path& folder, const Row& row, std::size_t fields, int depth,
             std::vector<Row>& rows) {
    // Trees of content names have no cycles; a forged one would be deep.
    constexpr int kMostDepth = 128;
    if (depth > kMostDepth)
        throw Error(fmt::format("{}: a tree of chunks of more than {} depths", folder.string(),
                                kMostDepth));
    if (row.gaussians > row.nodes) {
        Row own = row;
        own.parts.clear();
        rows.push_back(std::move(own));
    }
    if (row.nodes == 0) return;
    const std::vector<Row> read =
        row.table.empty() ? std::vector<Row>() : read_parts(folder, row, fields);
    for (const Row& part : row.table.empty() ? row.parts : read)
        collect(folder, part, fields, depth + 1, rows);
}

}  // namespace

bool is_site(const std::filesystem::path& path) {
    std::error_code code;
    return std::filesystem::is_directory(path, code) &&
           std::filesystem::is_regular_file(path / kManifestName, code);
}

SiteInfo read_site_info(const std::filesystem::path& folder) {
    const Manifest manifest = read_manifest(folder);
    SiteInfo info{manifest.steps, {}};
    for (const ManifestModel& model : manifest.models)
        info.models.push_back({model.name, model.description, model.gaussians, model.levels});
    return info;
}

Gaussians read_site(const std::filesystem::path& folder, std::size_t model) {
    const Manifest manifest = read_manifest(folder);
    const ManifestModel& about = model_at(manifest, model, folder);
    std::vector<Row> rows;
    collect(folder, about.root, field_count(about), 0, rows);
    std::vector<std::size_t> begin{0};
    for (const Row& row : rows) begin.push_back(begin.back() + row.gaussians - row.nodes);
    if (begin.back() != about.gaussians)
        throw Error(fmt::format("{}: damaged: {} Gaussians in chunks, expected {}",
                                (folder / kManifestName).string(), begin.back(), about.gaussians));
    Gaussians whole = about.description;
    allocate(whole, begin.back(), about.rotated);
    vog::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t n) {
        place(read_chunk(folder, rows[n], about), rows[n].nodes, rows[n].gaussians, whole,
              begin[n]);
    });
    return whole;
}

}  // namespace vog
