// inputs.h: what the words on the command line stand for: files, sizes, colours.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/convert_points.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/volume.h"
#include "vog/volume_io.h"

namespace vog::cli {

enum class FileKind { volume, points, model };

/// By extension, and for .vdb by what the grids of this name hold; throws vog::Error listing the
/// known ones.
FileKind kind_of(const std::filesystem::path& file, const std::string& grid = {});
/// The one kind of all inputs; throws vog::Error where they differ.
FileKind common_kind(const std::vector<std::string>& inputs, const std::string& grid);

struct VolumeInputOptions {
    std::string grid;  ///< name or pattern with '*' and '?'; empty: the default grid
    std::string mask;  ///< name; a '*' in it is what the '*' of `grid` stands for
    bool no_mask = false;
    bool level_set_to_fog = false;
};
/// Adds --grid, --mask, --no-mask and --level-set-to-fog.
void add_volume_options(CLI::App& command, VolumeInputOptions& options);
/// throws CLI::ValidationError for options that clash
LevelOptions level_options(const VolumeInputOptions& options);
/// Reads volumes: of each file one, or all whose names match --grid; says on standard error what
/// reading changed. Masks come with them where --mask is given.
VolumeSet load_volumes(const std::vector<std::string>& files, const VolumeInputOptions& options);
/// Several volumes, or masked ones, hide each other, unless --no-mask is given.
Overlap overlap_of(std::size_t volumes, const VolumeInputOptions& options);

inline constexpr const char* kPointGroup = "Particles";
struct PointInputOptions {
    std::vector<std::string> columns;
    std::string value, radius = "adaptive";
    int neighbours = PointOptions{}.neighbours;
};
/// Adds --columns, --value, --radius and --neighbours, as the group kPointGroup.
void add_point_options(CLI::App& command, PointInputOptions& options);
/// Reads particles and joins them.
Points load_points(const std::vector<std::string>& files, const PointInputOptions& options,
                   const std::string& grid);
/// One Gaussian a particle. throws CLI::ValidationError for a radius that is no number
PointOptions point_options(const PointInputOptions& options);
/// Options of a group that do not go with the rest were ignored otherwise.
/// throws CLI::ValidationError: "--radius does not go with volumes"
void refuse_group(const CLI::App& command, const std::string& group, const std::string& with);

/// Files of models, indices replaced by what they name.
std::vector<std::string> model_files(const std::vector<std::string>& files);
/// Reads models and joins them.
/// hierarchy  becomes that of those which have one; null: not read
Gaussians load_models(const std::vector<std::string>& files, Hierarchy* hierarchy = nullptr);

/// What views of an input look at, without its values where that is known without.
Box box_of(const std::string& input, const VolumeInputOptions& volume,
           const PointInputOptions& points);

/// "640x480" or "512". throws CLI::ValidationError: wrong usage
struct Size {
    int width = 512, height = 512;
};
Size parse_size(const std::string& text);
/// "1,1,1", "white", "black" or "transparent". throws CLI::ValidationError
Rgba parse_background(const std::string& text);
/// "x,y,z". throws CLI::ValidationError naming `option`
Vec3d parse_vector(const std::string& option, const std::string& text);

/// A number > 0; "auto" and its kin are the caller's. throws CLI::ValidationError
double parse_extinction(const std::string& text);

/// Checks before any work that `output` can be written: its extension is one of `extensions`, its
/// folder exists, and it is none of the inputs. throws vog::Error
void check_output(const std::string& output, const std::vector<std::string>& inputs,
                  const std::vector<std::string>& extensions);

}  // namespace vog::cli
