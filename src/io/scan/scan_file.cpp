// scan_file.cpp: choice of a format by extension and of a grid by name; maps and names that formats share.
#include "io/scan/scan_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "io/byte_source.h"
#include "io/file_extension.h"
#include "vog/error.h"
#include "vog/text.h"
#include "vog/units.h"

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
    std::map<std::string, int> repeats, numbers;
    for (ScanGrid& grid : scan.grids) {
        const double det = determinant(grid.world_from_index.linear);
        const Vec3d shift = grid.world_from_index.translation;
        if (!std::isfinite(det) || det == 0 || !std::isfinite(shift.x + shift.y + shift.z))
            throw Error(
                fmt::format("{}: transform is singular or not finite, expected an invertible one",
                            file.string()));
        grid.name = grid_name(grid.name);
        grid.plain_name = grid.plain_name.empty() ? grid.name : grid_name(grid.plain_name);
        repeats[grid.name] += 1;
        grid.length_unit = printable(grid.length_unit, 40);
        grid.value_unit = printable(grid.value_unit, 40);
    }
    for (ScanGrid& grid : scan.grids)
        if (repeats[grid.name] > 1) grid.name += fmt::format("[{}]", numbers[grid.name]++);
    return scan;
}

std::size_t chosen_grid(const ScanFile& scan, const std::filesystem::path& file,
                        const GridRequest& request, DefaultGrid* answer) {
    const ScanGrid& chosen = chosen_of(
        scan.grids, file.string(), request, answer,
        [](const ScanGrid&) { return ValueKind::numbers; },
        [](const ScanGrid& grid) { return double{1} * grid.size.x * grid.size.y * grid.size.z; });
    return static_cast<std::size_t>(&chosen - scan.grids.data());
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

std::vector<std::string> frame_names(std::uint64_t frames, std::uint64_t channels) {
    if (frames == 1) return numbered_names("c", channels);
    std::vector<std::string> names;
    for (const std::string& frame : numbered_names("t", frames))
        for (std::uint64_t c = 0; c < channels; ++c)
            names.push_back(channels == 1 ? frame : fmt::format("{}c{}", frame, c));
    return names;
}

bool have_common_unit(const std::vector<std::string>& units) {
    for (const std::string& unit : units)
        if (length_unit_name(unit) != length_unit_name(units[0]) &&
            !(length_unit(length_unit_name(unit)) && length_unit(length_unit_name(units[0]))))
            return false;
    return true;
}

void set_units(const std::filesystem::path& file, const std::vector<std::string>& units,
               ScanGrid& grid) {
    std::vector<std::string> stated = units;
    std::erase(stated, "");
    // Beside an axis without a unit, others must need no conversion: then lengths are plain numbers.
    const bool whole = stated.size() == units.size();
    const bool equal = std::ranges::all_of(stated, [&](const std::string& unit) {
        return length_unit_name(unit) == length_unit_name(stated[0]);
    });
    if (whole ? !have_common_unit(units) : !equal)
        throw Error(fmt::format("{}: axes in units '{}', expected one unit, or units of length",
                                file.string(),
                                printable(fmt::format("{}", fmt::join(units, ", ")), 80)));
    if (!whole || units.empty()) return;
    grid.length_unit = length_unit_name(units[0]);
    for (std::size_t n = 1; n < std::min<std::size_t>(units.size(), 3); ++n) {
        const std::string unit = length_unit_name(units[n]);
        if (unit == grid.length_unit) continue;
        const LengthUnit own = *length_unit(unit), common = *length_unit(grid.length_unit);
        const int power = own.power - common.power;
        const double ten = std::pow(10.0, std::abs(power)), ratio = own.number / common.number;
        const auto converted = [&](double v) {
            return power < 0 ? v * ratio / ten : v * ratio * ten;
        };
        Vec3d& row = grid.world_from_index.linear.row[n];
        row = {converted(row.x), converted(row.y), converted(row.z)};
        double& shift = grid.world_from_index.translation[static_cast<int>(n)];
        shift = converted(shift);
    }
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
