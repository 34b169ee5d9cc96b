// points_files.cpp: choice of the particle format by extension.
#include "io/points/points_files.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/paging.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

using namespace point_files;

namespace {

bool is_vdb(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    return extension == ".vdb" || extension == ".VDB";
}

/// Whether a particle can be read: its numbers are finite; others than its position may be missing (NaN).
/// strict  none is missing
bool is_readable(const Points& points, std::size_t n, bool strict) {
    const auto good = [strict](float x) { return std::isfinite(x) || (!strict && std::isnan(x)); };
    const Vec3d p = points.position[n];
    if (!std::isfinite(p.x + p.y + p.z)) return false;
    if (!points.velocity.empty())
        for (int axis = 0; axis < 3; ++axis)
            if (!good(points.velocity[n][axis])) return false;
    return std::ranges::all_of(points.attributes, [&](const PointAttribute& attribute) {
        return good(attribute.value[n]);
    });
}

/// Removes particles with a number that is not finite.
/// returns  their number
/// throws   vog::Error for such a particle, unless `skip`; missing values are no error
std::uint64_t keep_finite(Points& points, bool skip) {
    std::size_t kept = 0, first = points.size();
    for (std::size_t n = 0; n < points.size(); ++n) {
        keep_memory_at(n);
        if (!is_readable(points, n, skip)) {
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
            fmt::format("{}: {} particles with a number that is not finite, the first is number "
                        "{}, expected finite numbers (--skip-nonfinite leaves such particles out)",
                        points.source, skipped, first));
    if (kept == 0) throw Error(fmt::format("{}: no particle with finite numbers", points.source));
    points.position.resize(kept);
    if (!points.velocity.empty()) points.velocity.resize(kept);
    for (PointAttribute& attribute : points.attributes) attribute.value.resize(kept);
    return skipped;
}

/// note  receives the columns of a text that are read by their places, or the choice among grids; null: not reported
Points read_file(const std::filesystem::path& file, const PointReadOptions& options,
                 ValueNotes* notes, std::string* note) {
    if (!options.columns.empty() && (is_vdb(file) || is_hdf5(file)))
        throw Error(fmt::format("{}: columns are of text files; here expected none (--columns)",
                                file.string()));
    Points points = is_vdb(file)    ? read_points_vdb(file, options, note)
                    : is_hdf5(file) ? read_points_hdf5(file, options)
                                    : read_points_text(file, options, note);
    const std::uint64_t skipped = keep_finite(points, options.values.skip_nonfinite);
    if (notes) notes->skipped_nonfinite += skipped;
    return points;
}

/// Note on files that are not all those of their snapshot; empty: they are.
/// file       one of them that has the type
/// files      their number
/// particles  of the type in them
std::string missing_parts(const std::filesystem::path& file, std::size_t files,
                          const std::string& type, std::uint64_t particles) {
    if (!is_hdf5(file)) return {};
    const SnapshotPart part = part_of_hdf5(file, type);
    if (!(part.files > static_cast<double>(files)) ||
        part.particles == static_cast<double>(particles))
        return {};
    return fmt::format(
        "{}: {} of the {} files of a snapshot, with {}{} particles; name all files to read the "
        "others",
        printable(file.string()), files, part.files, particles,
        part.particles > 0 ? fmt::format(" of {:.0f}", part.particles) : "");
}

}  // namespace

LikelyGrid point_files::likely_type(const std::string& file, const ParticleTypes& types,
                                    bool refuse) {
    return likely_grid(
        file, types.name, [&](std::size_t n) { return types.particles[n]; }, refuse, "PartType0");
}

std::vector<std::string> point_types(const std::filesystem::path& file) {
    return is_hdf5(file) ? types_of_hdf5(file).name : std::vector<std::string>{};
}

Points read_points(const std::filesystem::path& file, const PointReadOptions& options,
                   ValueNotes* notes) {
    return read_file(file, options, notes, nullptr);
}

bool is_points_file(const std::filesystem::path& file) { return is_text(file) || is_hdf5(file); }

namespace {

/// Type of particles of a snapshot or of its parts: the requested one, or the one that is meant. Empty: no snapshot.
/// note  receives the choice
std::string common_type(std::span<const std::filesystem::path> files,
                        const PointReadOptions& options, std::string& note) {
    ParticleTypes all;
    for (const auto& file : files) {
        if (!is_hdf5(file)) continue;
        const ParticleTypes types = types_of_hdf5(file);
        for (std::size_t n = 0; n < types.name.size(); ++n) {
            const auto at = std::ranges::find(all.name, types.name[n]) - all.name.begin();
            if (at == std::ssize(all.name)) {
                all.name.push_back(types.name[n]);
                all.particles.push_back(0);
            }
            all.particles[static_cast<std::size_t>(at)] += types.particles[n];
        }
    }
    if (all.name.empty()) return options.grid;
    if (options.grid.empty()) {
        const LikelyGrid likely = likely_type(files.front().string(), all, options.refuse_several);
        note = likely.note;
        return all.name[likely.index];
    }
    if (files.size() == 1 || std::ranges::count(all.name, options.grid)) return options.grid;
    throw Error(fmt::format("{}: no particles '{}'; choose some with --grid (the files have: {})",
                            files.front().string(), printable(options.grid),
                            fmt::join(all.name, ", ")));
}

void refuse_twice(std::span<const std::filesystem::path> files) {
    std::set<std::filesystem::path> named;
    for (const auto& file : files) {
        std::error_code code;  // the reader says why a file cannot be opened
        const std::filesystem::path whole = std::filesystem::weakly_canonical(file, code);
        if (!code && !named.insert(whole).second)
            throw Error(fmt::format("{}: named twice, expected each file once", file.string()));
    }
}

}  // namespace

Points read_points(std::span<const std::filesystem::path> files, const PointReadOptions& options,
                   std::vector<std::string>* notes) {
    refuse_twice(files);
    PointReadOptions chosen = options;
    const auto note = [&](const std::string& text) {
        if (notes && !text.empty()) notes->push_back(text);
    };
    std::string choice;
    chosen.grid = common_type(files, options, choice);
    note(choice);
    Points points;
    std::uint64_t skipped = 0;
    const std::filesystem::path* part = nullptr;  // the first with the type
    for (const auto& file : files) {
        if (files.size() > 1 && is_hdf5(file)) {
            const std::vector<std::string> types = point_types(file);
            if (std::ranges::find(types, chosen.grid) == types.end()) {
                note(fmt::format("{}: no particles of {}", printable(file.string()), chosen.grid));
                continue;
            }
        }
        ValueNotes changed;
        std::string by_place;
        append(points, read_file(file, chosen, &changed, &by_place));
        skipped += changed.skipped_nonfinite;
        note(by_place);
        note(values_text(changed, file.string()));
        if (!part) part = &file;
    }
    if (part) note(missing_parts(*part, files.size(), chosen.grid, points.size() + skipped));
    for (const PointAttribute& attribute : points.attributes)
        if (attribute.unit != 1)
            note(fmt::format("{}: '{}' is divided by {:g}: its numbers are beyond single precision",
                             points.source, attribute.name, attribute.unit));
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
