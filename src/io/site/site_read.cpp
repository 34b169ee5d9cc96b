// site_read.cpp: descriptions and whole models of sites.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "io/site/chunk_file.h"
#include "io/site/manifest.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog {

using namespace site;

namespace {

namespace fs = std::filesystem;

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

/// Name of a model by its place, from 0 on.
std::string place_name(std::size_t model) { return fmt::format("#{}", model + 1); }

/// Names of a site's models: those of the manifest read before, as long as that is the same file.
std::vector<std::string> model_names(const fs::path& folder) {
    static std::mutex mutex;
    static std::pair<fs::path, fs::file_time_type> before;
    static std::vector<std::string> names;
    std::error_code code;
    const std::pair now{fs::absolute(folder), fs::last_write_time(folder / kManifestName, code)};
    const std::lock_guard lock(mutex);
    if (now == before) return names;
    std::vector<std::string> read;
    for (const ManifestModel& model : read_manifest(folder).models) read.push_back(model.name);
    names = std::move(read);
    before = now;
    return names;
}

}  // namespace

bool is_site(const fs::path& path) {
    std::error_code code;
    return fs::is_directory(path, code) && fs::is_regular_file(path / kManifestName, code);
}

std::optional<SitePath> find_site(const fs::path& path) {
    if (is_site(path)) return SitePath{path, 0};
    const fs::path folder = path.parent_path();
    std::error_code code;
    if (!path.has_filename() || fs::exists(path, code) || !is_site(folder)) return {};
    const std::vector<std::string> names = model_names(folder);
    const std::string name = path.filename().string();
    auto found = std::ranges::find(names, name);
    if (found == names.end())
        for (found = names.begin(); found != names.end(); ++found)
            if (name == place_name(static_cast<std::size_t>(found - names.begin()))) break;
    if (found == names.end()) return {};
    return SitePath{folder, static_cast<std::size_t>(found - names.begin())};
}

std::vector<fs::path> models_of_site(const fs::path& given) {
    const fs::path folder = given.has_filename() ? given : given.parent_path();  // site/ is site
    const std::vector<std::string> names = model_names(folder);
    std::map<std::string, int> count;
    for (const std::string& name : names) ++count[name];
    std::vector<fs::path> paths;
    for (std::size_t n = 0; n < names.size(); ++n) {
        const fs::path named = folder / names[n];
        bool found = count[names[n]] == 1 && named.parent_path() == folder;
        if (found) {
            const auto site = find_site(named);
            found = site && site->folder == folder && site->model == n;
        }
        paths.push_back(found ? named : folder / place_name(n));
    }
    return paths;
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
