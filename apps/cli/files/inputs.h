// inputs.h: input files and their options, and the parsing of sizes, colours and vectors.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "files/input_choices.h"
#include "terminal/usage_error.h"
#include "vog/camera.h"
#include "vog/convert_points.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/site.h"
#include "vog/volume.h"
#include "vog/volume_io.h"

namespace vog::cli {

/// Extension in lower case, with its dot: ".ply".
std::string extension_of(const std::string& file);

enum class FileKind { volume, points, model };

/// Kind of a file by its extension; a .vdb by the contents of its grids of this name.
/// throws vog::Error for an unknown extension, with the known ones
FileKind kind_of(const std::string& file, const std::string& grid = {});
/// The common kind of all inputs. throws vog::Error where they differ
FileKind common_kind(const std::vector<std::string>& inputs, const std::string& grid);

/// Library options from the command line. throws UsageError for options that exclude each
/// other
LevelOptions level_options(const VolumeInputOptions& options);
/// Volumes with notes on how they combine and on values that reading changed.
struct LoadedVolumes : VolumeSet {
    std::vector<std::string> notes;  ///< one line each, to print and for --json
};
/// Reads volumes: one per file, or all grids whose names match --grid, with their masks where --mask
/// is given.
/// throws vog::Error for several volumes that are neither levels nor parts, unless --combine is given
LoadedVolumes load_volumes(const std::vector<std::string>& files,
                           const VolumeInputOptions& options);
/// Combination of several volumes by the options alone.
struct Combination {
    Overlap overlap = Overlap::add;
    bool by_arrangement = false;  ///< no option says it: levels or parts by arrangement_of
    std::string text;             ///< note on the options' effect; empty: one volume
};
Combination combination_of(std::size_t volumes, const VolumeInputOptions& options);
/// throws vog::Error with the options that help, unless volumes may hide each other
void require_mesh(const Arrangement& arrangement);

/// Reads the particles of all files as one set.
/// notes  receives a line on each file's particles that were left out or changed
Points load_points(const std::vector<std::string>& files, const PointInputOptions& options,
                   const VolumeInputOptions& volume, std::vector<std::string>& notes);
/// Prints each note on standard error.
void print_notes(const std::vector<std::string>& notes);
/// Box of --periodic; an empty one: that of the data. None: not given.
/// throws  UsageError for other texts
std::optional<Box> period_of(const PointInputOptions& options);
/// Library options from the command line: one Gaussian per particle. throws UsageError
/// for a number as radius that is not > 0
PointOptions point_options(const PointInputOptions& options);
/// Files of models, with each index (.json) replaced by the files it names.
std::vector<std::string> model_files(const std::vector<std::string>& files);
/// A view for which sites are read: chunks beyond it, or finer than its pixels, are left in their files.
struct SiteView {
    CameraFrame frame;
    double pixel_error = 1;  ///< CutOptions::pixel_error
    std::shared_ptr<SiteCutReport> report =
        std::make_shared<SiteCutReport>();  ///< sums over the sites
};
/// Models of a single input that is a site of several; empty: other inputs.
std::vector<std::string> models_of_one_site(const std::vector<std::string>& inputs);
/// Note that of a site's models the first is taken, and how another one is named.
void note_first_model(const std::string& site, const std::vector<std::string>& models);
/// Whether all files are sites, or models of them.
bool all_sites(const std::vector<std::string>& files);
/// Reads all models as one.
/// hierarchy  set to the hierarchies of the models that have one; null: not read
/// view       of sites alone (all_sites); none: whole models
/// rules      for splats of other programs; those left out are reported on standard error
Gaussians load_models(const std::vector<std::string>& files, Hierarchy* hierarchy = nullptr,
                      const std::optional<SiteView>& view = {}, const ValueRules& rules = {});
/// Reads one model as load_models does.
Gaussians load_model(const std::string& file, Hierarchy* hierarchy, const ValueRules& rules);

/// What views of volumes frame.
Subject subject_of(std::span<const Volume> volumes);
/// What views of an input frame. Volumes are read whole.
Subject subject_of(const std::string& input, const VolumeInputOptions& volume,
                   const PointInputOptions& points);

/// Finite numbers separated by commas; empty for other texts.
std::vector<double> parse_numbers(const std::string& text);
/// Parses "x,y,z". throws UsageError, with the name of the option, for other texts
Vec3d parse_vector(const std::string& option, const std::string& text);

}  // namespace vog::cli
