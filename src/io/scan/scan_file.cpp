// scan_file.cpp: choice of a format by extension and of a grid by name; maps and names that formats share.
#include "io/scan/scan_file.h"

#include <fmt/format.h>

#include <cmath>

#include "io/byte_source.h"
#include "io/file_extension.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

struct Format {
    const char* extension;
    ScanFile (*open)(const std::filesystem::path&);
};
constexpr Format kFormats[] = {
    {".nii", open_nifti},     {".nii.gz", open_nifti},  {".nrrd", open_nrrd}, {".nhdr", open_nrrd},
    {".mha", open_metaimage}, {".mhd", open_metaimage}, {".raw", open_raw},   {".tif", open_tiff},
    {".tiff", open_tiff},     {".fits", open_fits},     {".fit", open_fits},  {".fts", open_fits},
    {".fits.gz", open_fits},  {".fits.fz", open_fits}};
constexpr Format kFolder{"", open_tiff};

const Format* format_of(const std::filesystem::path& file) {
    std::string extension = lower_extension(file);
    if (extension == ".gz" || extension == ".fz")
        extension = lower_extension(file.stem()) + extension;
    for (const Format& format : kFormats)
        if (extension == format.extension) return &format;
    return is_tiff_folder(file) ? &kFolder : nullptr;
}

}  // namespace

bool is_scan(const std::filesystem::path& file) { return format_of(file) != nullptr; }

ScanFile open_scan(const std::filesystem::path& file) {
    const Format* format = format_of(file);
    if (!format) throw Error(fmt::format("{}: unknown extension of a scan", file.string()));
    ScanFile scan = format->open(file);
    for (ScanGrid& grid : scan.grids) {
        const double det = determinant(grid.world_from_index.linear);
        const Vec3d shift = grid.world_from_index.translation;
        if (!std::isfinite(det) || det == 0 || !std::isfinite(shift.x + shift.y + shift.z))
            throw Error(
                fmt::format("{}: transform is singular or not finite, expected an invertible one",
                            file.string()));
        grid.name = grid_name(grid.name);
        grid.length_unit = printable(grid.length_unit, 40);
        grid.value_unit = printable(grid.value_unit, 40);
    }
    return scan;
}

std::size_t chosen_grid(const ScanFile& scan, const std::filesystem::path& file,
                        const std::string& name) {
    std::string list;
    constexpr std::size_t kListed = 6;
    const std::size_t count = scan.grids.size();
    for (std::size_t n = 0; n < count; ++n) {
        if (count > kListed && n == kListed - 1) list += ", ...";
        if (count <= kListed || n < kListed - 1 || n + 1 == count)
            list += (n ? ", " : "") + scan.grids[n].name;
    }
    if (name.empty()) {
        if (count == 1) return 0;
        throw Error(fmt::format("{}: {} images, expected one by name (it has: {})", file.string(),
                                count, list));
    }
    const std::string requested = grid_name(name);
    for (std::size_t n = 0; n < count; ++n)
        if (scan.grids[n].name == requested) return n;
    throw Error(fmt::format("{}: no grid named '{}' (it has: {})", file.string(), requested, list));
}

std::vector<std::string> color_names(std::uint64_t count) {
    std::vector<std::string> names{"red", "green", "blue", "alpha"};
    names.resize(std::min<std::size_t>(count, names.size()));
    return names;
}

std::vector<std::string> numbered_names(const std::string& prefix, std::uint64_t count) {
    if (count == 1) return {ScanGrid{}.name};
    std::vector<std::string> names;
    for (std::uint64_t n = 0; n < count; ++n) names.push_back(prefix + std::to_string(n));
    return names;
}

std::vector<ScanGrid> named_copies(const ScanGrid& grid, const std::vector<std::string>& names) {
    std::vector<ScanGrid> grids;
    for (const std::string& name : names) {
        grids.push_back(grid);
        grids.back().name = name;
    }
    return grids;
}

Affine to_ras(const Affine& map, bool left, bool posterior) {
    Affine ras = map;
    for (int axis = 0; axis < 2; ++axis) {
        if (!(axis == 0 ? left : posterior)) continue;
        Vec3d& row = ras.linear.row[static_cast<std::size_t>(axis)];
        row = Vec3d{} - row;  // of zeros no -0
        ras.translation[axis] = 0 - ras.translation[axis];
    }
    return ras;
}

Affine affine_of_axes(const std::array<Vec3d, 3>& axis, Vec3d origin) {
    return {transpose(Mat3{{axis[0], axis[1], axis[2]}}), origin};
}

}  // namespace vog::scan
