// scan_file.h: dense images of scanners, microscopes, telescopes and simulations: the grids of a file, one reader a format.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "io/grid_choice.h"
#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/subject.h"

namespace vog::scan {

/// One image of a file: a frame of a series, a channel, or the only one.
struct ScanGrid {
    std::string name = "value";  ///< "value" of the only image; "t3", "c0", "red" of several
    std::string
        plain_name{};         ///< without the number of one that repeats; or a channel's own, "GFP"
    Vec3i size;               ///< voxels along x, y, z, >= 1
    Affine world_from_index;  ///< from indices, from 0 at the first voxel's centre
    std::string type;         ///< of the stored values: "int16"
    std::string coordinates;  ///< of the world: "RAS, from sform"; empty: those of the file
    Standing standing{};
    std::string length_unit{};  ///< of the world: "mm"; empty: not known
    std::string value_unit{};   ///< "HU"; empty: not known
};

/// Head of a file, and access to its values.
struct ScanFile {
    std::vector<ScanGrid>
        grids;  ///< at least one; names repeat where the file's do, until open_scan numbers them
    std::string note{};  ///< what the file lacks of its format, and how it is read; empty: nothing
    /// Values of grid n, x fastest, scaled as the file states. Blank values are NaN.
    std::function<BigVector<float>(std::size_t n)> read{};
};

/// Whether a file has an extension of this room's formats, or is a folder of TIFF slices.
bool is_scan(const std::filesystem::path& file);
/// Reads the head of a file.
/// throws vog::Error for a missing, foreign, truncated or unsupported file: what, where, got, expected
ScanFile open_scan(const std::filesystem::path& file);
/// Number of the grid of this name, or by the rule of vog::chosen_of.
/// throws vog::Error as chosen_of does
std::size_t chosen_grid(const ScanFile& scan, const std::filesystem::path& file,
                        const GridRequest& request, DefaultGrid* answer = nullptr);

// One reader a format.
ScanFile open_nifti(const std::filesystem::path& file);
ScanFile open_nrrd(const std::filesystem::path& file);
ScanFile open_metaimage(const std::filesystem::path& file);
/// Raw values, with their head in FILE.json.
ScanFile open_raw(const std::filesystem::path& file);

/// Pages of a file, or the slices of a folder or of a pattern with *.
ScanFile open_tiff(const std::filesystem::path& file);
bool is_tiff(const std::filesystem::path& file);
bool is_tiff_folder(const std::filesystem::path& folder);
ScanFile open_fits(const std::filesystem::path& file);

/// Most grids of a file.
inline constexpr std::int64_t kMostGrids = 1 << 16;
/// "red", "green", "blue", "alpha".
std::vector<std::string> color_names(std::uint64_t count);
/// Names "PREFIX0" ... of several grids; "value" of a single one.
std::vector<std::string> numbered_names(const std::string& prefix, std::uint64_t count);
/// Names "t0c0", "t0c1", ... of frames and channels, channels first; as numbered_names where one of them is 1.
std::vector<std::string> frame_names(std::uint64_t frames, std::uint64_t channels);
/// Sets the unit of a grid's lengths from those of its world's axes: "um", "km", OME's "\xc3\x85". Axes of other units
/// than the first are converted to it.
/// throws vog::Error for different units that are no lengths
void set_units(const std::filesystem::path& file, const std::vector<std::string>& units,
               ScanGrid& grid);
/// Whether set_units accepts them.
bool have_common_unit(const std::vector<std::string>& units);
/// Copies of a grid with these names.
std::vector<ScanGrid> named_copies(const ScanGrid& grid, const std::vector<std::string>& names);
/// How scans in right, anterior, superior stand.
inline constexpr Standing kPatient{{0, 0, 1}, {0, 1, 0}};
/// Map of a grid to right, anterior, superior from a space whose x runs to the left or y to the back.
Affine to_ras(const Affine& map, bool left, bool posterior);
/// Map of voxels along `axis` (directions times spacings), with the first one's centre at `origin`.
Affine affine_of_axes(const std::array<Vec3d, 3>& axis, Vec3d origin);

}  // namespace vog::scan
