// points_files.cpp: choice of the particle format by extension.
#include "io/points/points_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/paging.h"
#include "vog/error.h"

namespace vog {

using namespace point_files;

namespace {

bool is_vdb(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    return extension == ".vdb" || extension == ".VDB";
}

bool is_finite(const Points& points, std::size_t n) {
    const auto finite = [](const auto& v) { return std::isfinite(v.x + v.y + v.z); };
    return finite(points.position[n]) && (points.velocity.empty() || finite(points.velocity[n])) &&
           std::ranges::all_of(points.attributes, [n](const PointAttribute& attribute) {
               return std::isfinite(attribute.value[n]);
           });
}

/// Removes particles with a number that is not finite.
/// returns  their number
/// throws   vog::Error for such a particle, unless `skip`
std::uint64_t keep_finite(Points& points, bool skip) {
    std::size_t kept = 0, first = points.size();
    for (std::size_t n = 0; n < points.size(); ++n) {
        keep_memory_at(n);
        if (!is_finite(points, n)) {
            first = std::min(first, n);
            continue;
        }
        if (skip && kept < n) {
            points.position[kept] = points.position[n];
            if (!points.velocity.empty()) points.velocity[kept] = points.velocity[n];
            for (PointAttribute& attribute : points.attributes)
                attribute.value[kept] = attribute.value[n];
        }
        ++kept;
    }
    const std::size_t skipped = points.size() - kept;
    if (skipped == 0) return 0;
    if (!skip)
        throw Error(
            fmt::format("{}: {} particles with a number that is not finite, the first is "
                        "number {}, expected finite numbers (--skip-nonfinite leaves such "
                        "particles out)",
                        points.source, skipped, first));
    if (kept == 0) throw Error(fmt::format("{}: no particle with finite numbers", points.source));
    points.position.resize(kept);
    if (!points.velocity.empty()) points.velocity.resize(kept);
    for (PointAttribute& attribute : points.attributes) attribute.value.resize(kept);
    return skipped;
}

}  // namespace

Points read_points(const std::filesystem::path& file, const PointReadOptions& options,
                   ValueNotes* notes) {
    if (!options.columns.empty() && (is_vdb(file) || is_hdf5(file)))
        throw Error(fmt::format("{}: columns are of text files; here expected none (--columns)",
                                file.string()));
    Points points = is_vdb(file)    ? read_points_vdb(file, options)
                    : is_hdf5(file) ? read_points_hdf5(file, options)
                                    : read_points_text(file, options);
    const std::uint64_t skipped = keep_finite(points, options.values.skip_nonfinite);
    if (notes) notes->skipped_nonfinite += skipped;
    return points;
}

void write_points(const std::filesystem::path& file, const Points& points) {
    validate(points);
    if (is_hdf5(file))
        throw Error(
            fmt::format("{}: cannot write HDF5, expected .xyz, .csv, .tsv or .vdb", file.string()));
    is_vdb(file) ? write_points_vdb(file, points) : write_points_text(file, points);
}

}  // namespace vog
