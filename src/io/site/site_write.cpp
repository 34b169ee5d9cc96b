// site_write.cpp: models into a folder, of one process or several; the manifest last.
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <optional>
#include <set>
#include <sstream>

#include "core/atomic_file.h"
#include "data/fields/field_arrays.h"
#include "data/hierarchy_links.h"
#include "io/site/chunk_file.h"
#include "io/site/chunk_name.h"
#include "io/site/manifest.h"
#include "io/site/tree/subtree.h"
#include "io/vogz/vogz_bytes.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/site.h"
#include "vog/temporary_file.h"

namespace vog {

using namespace site;

namespace {

namespace fs = std::filesystem;

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
            throw Error(
                fmt::format("{}; expected a new folder, or one that vog page wrote", error.what()));
        }
    } else if (fs::exists(folder / "index.html", code)) {
        throw Error(
            fmt::format("{}: has an index.html and no manifest of a site, expected a new folder, "
                        "or one that vog page wrote",
                        folder.string()));
    }
}

/// Lock of a folder, which ends with the process at the latest; file systems without locks give none.
class FolderLock {
  public:
    /// throws vog::Error for a folder that another process holds
    explicit FolderLock(const fs::path& folder)
        : file_(::open(folder.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ::close(file_);
            throw Error(fmt::format("{}: another export writes into this folder",
                                    folder.parent_path().string()));
        }
    }
    ~FolderLock() {
        if (file_ >= 0) ::close(file_);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int file_;
};

/// throws vog::Error, on all processes, unless they see one folder under the name
void require_shared(const fs::path& folder, const Collective& processes) {
    std::optional<TemporaryFile> mark;
    if (processes.is_root()) mark.emplace(folder / kManifestName);
    // Another folder under the name would take chunks of this process: the file's name is random.
    const std::string name = mark ? mark->path().filename().string() : std::string();
    const auto count = static_cast<std::size_t>(processes.count);
    const std::string given =
        processes.exchange_bytes(std::vector<std::string>(count, name)).front();
    std::error_code code;
    if (!fs::exists(folder / given, code))
        throw Error(fmt::format(
            "{}: the folder of the first process is not there, expected one that all share",
            folder.string()));
    double done = 1;  // the mark stays until all have looked for it
    processes.sum(done);
}

/// Facts of a model that all parts share.
struct Whole {
    std::uint64_t gaussians = 0;
    bool rotated = false;
    Fields fields;  ///< without values; ranges of all parts
};
/// throws vog::Error, on all processes, for parts with different origins, cutoffs or fields
Whole whole_of(const Gaussians& part, bool rotated, const Collective& processes,
               const std::string& where) {
    Whole whole{part.size(), rotated, empty_fields(part.fields)};
    if (!processes.several()) return whole;
    double sums[2] = {double(part.size()), rotated ? 1.0 : 0.0};
    processes.sum(sums);
    whole.gaussians = static_cast<std::uint64_t>(sums[0]);
    whole.rotated = sums[1] > 0;
    std::vector<double> ranges;  // upper ends, and lower ones with the other sign
    const auto each = [&](const auto& visit) {
        std::ranges::for_each(whole.fields.scalar, visit);
        std::ranges::for_each(whole.fields.vector, visit);
    };
    each([&](const auto& field) { ranges.insert(ranges.end(), {field.upper, -field.lower}); });
    // Numbers that are the same of all parts, and negative ones: their maxima are opposite then.
    double same[10] = {part.origin.x, part.origin.y, part.origin.z, part.cutoff,
                       double(ranges.size())};
    std::transform(same, same + 5, same + 5, std::negate<>());
    processes.max(same);
    if (!std::equal(same, same + 5, same + 5, [](double a, double b) { return a == -b; }))
        throw Error(fmt::format(
            "{}: parts with other origins, cutoffs or fields, expected the same of all", where));
    // A spread is that of the whole data: parts have the same one, or none is known.
    for (const ScalarField& field : whole.fields.scalar)
        for (const double value : {field.spread.low, field.spread.middle, field.spread.high})
            ranges.insert(ranges.end(), {value, -value});
    processes.max(ranges);
    auto range = ranges.begin();
    each([&](auto& field) {
        field.upper = *range++;
        field.lower = -*range++;
    });
    for (ScalarField& field : whole.fields.scalar)
        for (int n = 0; n < 3; ++n, range += 2)
            field.spread.known = field.spread.known && range[0] == -range[1];
    return whole;
}

}  // namespace

struct SiteWriter::State {
    ChunkFolder folder;
    VogzPrecision precision;
    Collective processes;
    Manifest manifest;
    SiteReport report;
    bool again = false;  ///< whether the folder had a manifest
    std::optional<FolderLock> lock;

    void gather_files(std::set<std::string>& files);
};

/// Adds names of files, and figures of the report, of all processes to those of process 0.
void SiteWriter::State::gather_files(std::set<std::string>& files) {
    double sums[2] = {double(report.bytes), double(report.kept)};
    processes.sum(sums);
    report.bytes = static_cast<std::uint64_t>(sums[0]);
    report.kept = static_cast<std::uint64_t>(sums[1]);
    std::vector<std::string> to(static_cast<std::size_t>(processes.count));
    if (!processes.is_root())
        for (const std::string& file : files) to.front() += file + '\n';
    for (const std::string& names : processes.exchange_bytes(to)) {
        std::istringstream in(names);
        for (std::string file; std::getline(in, file);) files.insert(file);
    }
}

SiteWriter::SiteWriter(const fs::path& folder, const VogzPrecision& precision,
                       const Collective* processes)
    : state_(new State{ChunkFolder(folder),
                       precision,
                       processes ? *processes : Collective{},
                       {},
                       {},
                       false,
                       {}}) {
    vogz::require_valid(precision);
    require_own(folder);
    const Collective& all = state_->processes;
    double checked = 1;  // by all, before anything is made
    all.sum(checked);
    if (all.is_root()) {
        make_folder(folder);
        make_folder(folder / kChunksName);
        state_->lock.emplace(folder / kChunksName);
        state_->again = is_site(folder);
    }
    if (all.several()) require_shared(folder, all);
}
SiteWriter::~SiteWriter() = default;

void SiteWriter::add(const std::string& name, const Gaussians& model, const Hierarchy& hierarchy,
                     const HierarchyBuilder& build) {
    State& s = *state_;
    const std::string where = fmt::format("{}: {}", s.folder.site().string(), name);
    validate(model);
    validate(hierarchy, model, where);
    if (!in_one_order(hierarchy))
        throw Error(
            fmt::format("{}: a hierarchy joined from several, expected one built of the whole "
                        "model (build_hierarchy)",
                        where));
    const auto empty = std::ranges::find_if(model.density, [](float d) { return !(d > 0); });
    if (empty != model.density.end())
        throw Error(fmt::format("{}: Gaussian {} has no density, expected some", where,
                                empty - model.density.begin()));
    const bool several = s.processes.several();
    if (several && !build)
        throw Error(fmt::format("{}: no builder of the nodes above the parts", where));
    const Whole whole = whole_of(
        model, !model.axis_aligned() || (!hierarchy.empty() && !hierarchy.nodes.axis_aligned()),
        s.processes, where);
    if (whole.gaussians == 0)
        throw Error(fmt::format("{}: no Gaussians, expected one at least", where));

    const Coding coding{s.precision, whole.rotated,
                        field_roundings(whole.fields, s.precision.field_step)};
    Subtree tree = write_tree(s.folder, coding, model, hierarchy, several);
    if (several) tree = joined_over(s.processes, s.folder, coding, std::move(tree), model, build);
    if (several && s.processes.is_root()) write_root(s.folder, coding, tree);

    ManifestModel out;
    out.name = name;
    out.description = select(model, {});
    out.description.source_voxels = model.source_voxels;
    out.description.summary = model.summary;
    out.description.fields = whole.fields;
    out.rotated = whole.rotated;
    out.gaussians = whole.gaussians;
    out.levels = std::move(tree.levels);
    out.root = std::move(tree.row);
    s.report.gaussians += out.gaussians;
    for (const SiteLevel& level : out.levels) s.report.chunks += level.chunks;
    if (s.manifest.models.empty() && s.processes.is_root())
        s.report.root_bytes = out.root.bytes.front();
    s.manifest.models.push_back(std::move(out));
}

SiteReport SiteWriter::finish(bool steps) {
    State& s = *state_;
    const fs::path& folder = s.folder.site();
    if (s.manifest.models.empty())
        throw Error(fmt::format("{}: no model, expected one or more", folder.string()));
    s.report.bytes = s.folder.bytes();
    s.report.kept = s.folder.kept();
    std::set<std::string> files = s.folder.files();
    if (s.processes.several()) s.gather_files(files);
    if (!s.processes.is_root()) return {};
    s.manifest.steps = steps;
    const std::string text = manifest_text(s.manifest);
    write_file(folder / kManifestName, [&](std::ofstream& out) { out << text; });
    s.report.bytes += text.size();
    // Names of content alone, where there was a site: whatever else lies in the folder stays.
    if (!s.again) return s.report;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / kChunksName)) {
        const std::string file = entry.path().filename().string();
        if (!is_content_name(entry.path().stem().string()) || files.contains(file)) continue;
        std::error_code code;
        if (fs::remove(entry.path(), code)) ++s.report.removed;
    }
    return s.report;
}

}  // namespace vog
