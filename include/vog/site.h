// vog/site.h: streamed models: a folder that any web server can serve, of which a view loads what it needs.
// A site has a page (vog/export_html.h, write_site_page), a manifest, and chunks of some thousand Gaussians: the nodes of a
// hierarchy (vog/lod.h) region by region and depth by depth, down to the model itself. Chunks are named by their content.
// Any mix of coarse and fine chunks is a picture of the same mass, without seams and in any order. docs/streaming.md has the
// rules and figures, docs/formats.md the files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/lod.h"
#include "vog/vogz.h"

namespace vog {

struct Collective;

/// Chunks of one depth of the tree: 0 the coarsest, one chunk.
struct SiteLevel {
    std::uint64_t chunks = 0;     ///< number of them
    std::uint64_t gaussians = 0;  ///< in them, nodes included
    std::uint64_t bytes = 0;      ///< size of their files
    double error = 0;             ///< largest geometric error of a node, world units; 0: no nodes
};

/// Sizes of a written site.
struct SiteReport {
    std::uint64_t gaussians = 0;   ///< sum over the models
    std::uint64_t chunks = 0;      ///< different ones
    std::uint64_t bytes = 0;       ///< size of chunks, fields, manifest and tables
    std::uint64_t root_bytes = 0;  ///< size of the first model's coarsest chunk without fields
    std::uint64_t kept = 0;        ///< chunks that the folder had already
    std::uint64_t removed = 0;     ///< files of an earlier export that none of the models uses
};

/// Builder of a hierarchy over some Gaussians, which it may sort: build_hierarchy, with the options of the model.
using HierarchyBuilder = std::function<Hierarchy(Gaussians&)>;

/// Writes models into a folder, one after another; the manifest comes last. A folder whose export was interrupted is
/// completed: chunks that it has are not written again.
class SiteWriter {
  public:
    /// folder     made if it does not exist. One that has a manifest of a site is exported anew
    /// precision  of the numbers
    /// processes  write the site together, each a part of every model (vog/distributed.h); all make the same calls in the same
    ///            order. Null: a single process
    /// throws     vog::Error for a precision out of range, a folder that has another page, cannot be made, is not the same of
    ///            all processes, or that another SiteWriter writes into
    SiteWriter(const std::filesystem::path& folder, const VogzPrecision& precision = {},
               const Collective* processes = nullptr);
    ~SiteWriter();
    SiteWriter(const SiteWriter&) = delete;
    SiteWriter& operator=(const SiteWriter&) = delete;

    /// Writes the chunks of a model.
    /// name       for people
    /// model      all densities > 0, at least one Gaussian. Several processes pass a part each, which may be empty; origin,
    ///            cutoff, box, texts and fields of all parts are those of the model
    /// hierarchy  of this model, as build_hierarchy makes it
    /// build      for the nodes above the parts of several processes
    /// throws     vog::Error for an invalid model or hierarchy, or if a file cannot be written
    /// cost       O(N) time, parallel; memory for a chunk a thread, and for the coarsest chunks of eight processes
    void add(const std::string& name, const Gaussians& model, const Hierarchy& hierarchy,
             const HierarchyBuilder& build = {});
    /// Writes the manifest, and removes chunks that it does not name.
    /// steps    whether the models are steps in time
    /// returns  report of the whole; with several processes on process 0, elsewhere nothing
    /// throws   vog::Error without a model, or if a file cannot be written
    SiteReport finish(bool steps = false);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Description of a model of a site.
struct SiteModelInfo {
    std::string name;
    Gaussians
        description;  ///< origin, cutoff, box, texts, names and ranges of fields; no Gaussians
    std::uint64_t gaussians = 0;    ///< size of the model
    std::vector<SiteLevel> levels;  ///< coarsest first
};
/// Description of a site.
struct SiteInfo {
    bool steps = false;  ///< whether the models are steps in time
    std::vector<SiteModelInfo> models;
};
/// Whether a path is a folder with a manifest.
bool is_site(const std::filesystem::path& path);
/// A model of a site.
struct SitePath {
    std::filesystem::path folder;
    std::size_t model = 0;  ///< place among the site's models
};
/// Model of a path: FOLDER, the first one of a site; FOLDER/NAME, where no file has that name; FOLDER/#N, the Nth from 1 on.
/// returns  none: the path of something else
/// throws   vog::Error for a malformed manifest
std::optional<SitePath> find_site(const std::filesystem::path& path);
/// Paths of a site's models as find_site takes them: by their names, or where two have one name by their places.
/// throws  vog::Error for a missing or malformed manifest
std::vector<std::filesystem::path> models_of_site(const std::filesystem::path& folder);
/// throws  vog::Error for a missing or malformed manifest
SiteInfo read_site_info(const std::filesystem::path& folder);

/// Reads a whole model of a site: its Gaussians without nodes.
/// model   place among the site's models
/// throws  vog::Error for a missing, malformed or damaged file, or a model that the site lacks
Gaussians read_site(const std::filesystem::path& folder, std::size_t model = 0);

/// Counts of a view of a site.
struct SiteCutReport {
    std::size_t chunks = 0;        ///< drawn
    std::size_t gaussians = 0;     ///< drawn
    std::size_t missing = 0;       ///< chunks in whose place coarser ones are drawn for now
    std::size_t pending = 0;       ///< missing chunks that will be read; others cannot be
    std::uint64_t revision = 0;    ///< number that changes with what is drawn
    std::uint64_t bytes_read = 0;  ///< sum over all views so far
    std::uint64_t held_bytes = 0;  ///< memory of decoded chunks
};

/// Cuts through a model of a site for a sequence of views: a chunk is replaced by its parts where its box is in view and its
/// error larger than CutOptions::pixel_error at the box's nearest point. Chunks are read when a view needs them, and dropped,
/// those of the longest ago first, beyond a limit of memory.
class SiteCut {
  public:
    /// memory_bytes  limit of decoded chunks; a view that needs more holds more
    /// throws        vog::Error as read_site
    SiteCut(const std::filesystem::path& folder, std::size_t model = 0,
            std::uint64_t memory_bytes = std::uint64_t{1} << 30);
    ~SiteCut();
    SiteCut(SiteCut&&) noexcept;
    SiteCut& operator=(SiteCut&&) noexcept;

    const SiteModelInfo& info() const;
    /// Gaussians of a view, all of which are read.
    /// returns  valid until the next call; the same bytes whatever views came before
    /// throws   vog::Error for a missing or damaged chunk, or an invalid option
    const Gaussians& choose(const CameraFrame& frame, const CutOptions& options = {});
    /// Gaussians of a view as far as chunks are in memory, coarser ones in place of others; those are read in the background,
    /// the largest error first, after which `arrived` is called once from another thread, until a later call wants others.
    const Gaussians& choose_available(const CameraFrame& frame, const CutOptions& options,
                                      const std::function<void()>& arrived);
    /// Counts of the last view.
    const SiteCutReport& report() const;
    /// Line on the first chunk that could not be read in the background; empty: none.
    std::string fault() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
