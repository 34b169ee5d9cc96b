// inputs.cpp: reading of inputs by kind, and parsing of option values.
#include "files/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "files/next_steps.h"
#include "terminal/terminal.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/lod.h"
#include "vog/model_io.h"
#include "vog/periodic.h"
#include "vog/scan_io.h"
#include "vog/shade.h"
#include "vog/site.h"

namespace vog::cli {

namespace fs = std::filesystem;

std::vector<double> parse_numbers(const std::string& text) {
    std::vector<double> values;
    const char *at = text.data(), *end = at + text.size();
    while (true) {
        double value;
        const auto [stop, code] = std::from_chars(at, end, value);
        if (code != std::errc{} || !std::isfinite(value)) return {};
        values.push_back(value);
        if (stop == end) return values;
        if (*stop != ',') return {};
        at = stop + 1;
    }
}

std::string extension_of(const std::string& file) {
    std::string extension = fs::path(file).extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// throws vog::Error for a file that is not there, with the names of a site's models
[[noreturn]] void refuse_missing(const std::string& file) {
    const fs::path folder = fs::path(file).parent_path();
    if (!is_site(folder)) throw Error(fmt::format("{}: no such file", file));
    constexpr std::size_t kMost = 8;
    std::string names;
    const std::vector<fs::path> models = models_of_site(folder);
    for (std::size_t n = 0; n < std::min(models.size(), kMost); ++n)
        names += (n > 0 ? ", " : "") + models[n].filename().string();
    throw Error(fmt::format("{}: no model of this name, expected {}{}", file, names,
                            models.size() > kMost ? ", ..." : ""));
}

FileKind kind_of(const std::string& file, const std::string& grid) {
    if (find_site(file)) return FileKind::model;
    const std::string extension = extension_of(file);
    // A missing file is reported by its reader.
    std::error_code code;
    if (extension == ".vdb" && fs::is_regular_file(file, code) && vdb_holds_points(file, grid))
        return FileKind::points;
    if (is_volume_file(file)) return FileKind::volume;
    for (const char* model : {".ply", ".vogz", ".json", ".spz", ".glb", ".usda", ".usdc", ".usd"})
        if (extension == model) return FileKind::model;
    if (is_points_file(file)) return FileKind::points;
    if (!fs::exists(file, code)) refuse_missing(file);
    if (fs::is_directory(fs::path(file) / "chunks", code))
        throw Error(fmt::format("{}: an incomplete site; run vog page again to complete it", file));
    if (fs::is_directory(file, code) && advice_on(file).empty())
        throw Error(fmt::format("{}: a folder, expected files, such as '{}' (vog {} lists it)",
                                file, (fs::path(file) / "*.vdb").string(), file));
    if (const std::string advice = advice_on(file); !advice.empty())
        throw Error(fmt::format("{}: {}", file, advice));
    if (const std::string advice = advice_on_text(file); !advice.empty())
        throw Error(fmt::format("{}: {}", file, advice));
    throw Error(fmt::format(
        "{}: unknown extension '{}', expected .vdb, .nvdb, .nii, .nii.gz, .nrrd, .nhdr, .mha, "
        ".mhd, .raw, .tif or .fits (volume), .hdf5, .xyz, .extxyz, .pts, .asc, .csv, .ecsv, .tsv, "
        ".dat or .txt (particles), .ply, .vogz or .json (model, index of models), .spz, .glb, "
        ".usda, or .usd (splats); or a file that Python reads: python3 -m vog COMMAND FILE",
        file, extension));
}

FileKind common_kind(const std::vector<std::string>& inputs, const std::string& grid) {
    const FileKind kind = kind_of(inputs.front(), grid);
    for (const std::string& input : inputs)
        if (kind_of(input, grid) != kind)
            throw Error(
                fmt::format("{} and {} are different kinds of data; inputs must all be volumes, "
                            "all particles or all models",
                            input, inputs.front()));
    return kind;
}

LevelOptions level_options(const VolumeInputOptions& options) {
    const auto has_star = [](const std::string& name) { return name.find('*') != name.npos; };
    if (!options.mask.empty() && has_star(options.mask) != has_star(options.grid))
        throw UsageError(
            fmt::format("--grid '{}' and --mask '{}': expected a * in both, or in neither",
                        options.grid, options.mask));
    return {options.grid,   options.mask, options.level_set_to_fog,
            options.values, options.ones, options.refuse_several};
}

LoadedVolumes load_volumes(const std::vector<std::string>& files,
                           const VolumeInputOptions& options) {
    const std::vector<fs::path> paths(files.begin(), files.end());
    LoadedVolumes loaded;
    static_cast<Levels&>(loaded) = read_levels(paths, level_options(options), &loaded.notes);
    const auto of_patient = [](const Volume& volume) { return volume.standing.front != Vec3d{}; };
    const auto stated = std::ranges::find_if(loaded.volumes, of_patient),
               unstated = std::ranges::find_if_not(loaded.volumes, of_patient);
    if (stated != loaded.volumes.end() && unstated != loaded.volumes.end())
        loaded.notes.push_back(
            fmt::format("{} states no axes of a patient as {} does: they may lie half a turn apart",
                        unstated->source, stated->source));
    const Combination combination = combination_of(loaded.volumes.size(), options);
    loaded.overlap = combination.overlap;
    std::string how = combination.text;
    if (combination.by_arrangement) {
        const Arrangement arrangement = arrangement_of(loaded);
        require_mesh(arrangement);
        how = arrangement.text;
    }
    if (!how.empty()) loaded.notes.push_back(how);
    return loaded;
}

Combination combination_of(std::size_t volumes, const VolumeInputOptions& options) {
    const bool masked = !options.mask.empty();
    if (volumes < 2 && (options.sum || options.mesh))
        throw UsageError(fmt::format("--{} needs several volumes", options.sum ? "sum" : "mesh"));
    if (volumes < 2) return {masked ? Overlap::hide : Overlap::add, false, {}};
    if (options.sum)
        return {Overlap::add, false, fmt::format("{} volumes add up (--combine sum)", volumes)};
    if (masked)
        return {Overlap::hide, false,
                fmt::format("{} volumes are levels of one mesh, valid inside their masks (--mask)",
                            volumes)};
    if (options.mesh)
        return {Overlap::hide, false,
                fmt::format("{} volumes are levels of one mesh (--combine mesh): where they "
                            "overlap, the finest counts, or the first if voxels are equal",
                            volumes)};
    return {Overlap::hide, true, {}};
}

void require_mesh(const Arrangement& arrangement) {
    if (arrangement.is_mesh()) return;
    const bool quantities = arrangement.kind == Arrangement::Kind::quantities;
    throw Error(fmt::format(
        "{}; use {}, --combine sum (densities add up) or --combine mesh (the finest counts, or the "
        "first if voxels are equal)",
        arrangement.text,
        quantities ? "one of them (--grid NAME)"
                   : "one at a time (time steps: -o FOLDER/ of convert, render and export)"));
}

Points load_points(const std::vector<std::string>& files, const PointInputOptions& options,
                   const VolumeInputOptions& volume, std::vector<std::string>& notes) {
    const std::vector<fs::path> paths(files.begin(), files.end());
    Points points = read_points(
        paths, {options.columns, volume.grid, volume.values, volume.refuse_several}, &notes);
    ValueNotes changed;
    if (volume.values.clip_negative)
        changed.clipped_negative = clip_negative(points, options.value);
    if (const std::string text = values_text(changed, points.source); !text.empty())
        notes.push_back(text);
    if (const std::string name = smoothing_radius(points).name;
        options.radius == kAutoSmoothing && !name.empty())
        notes.push_back(fmt::format(
            "{}: '{}' sets the sizes of the Gaussians (--radius adaptive: distances of neighbours)",
            points.source, name));
    return points;
}

void print_notes(const std::vector<std::string>& notes) {
    for (const std::string& text : notes) note(text);
}

std::optional<Box> period_of(const PointInputOptions& options) {
    if (!options.periodic) return {};
    if (options.periodic->empty() || *options.periodic == "auto") return Box{};
    try {
        return box_of_numbers(parse_numbers(*options.periodic));
    } catch (const Error&) {
        throw UsageError(
            fmt::format("--periodic {}: expected auto, the box's edge, x,y,z edges or "
                        "x0,y0,z0,x1,y1,z1 (after the inputs, or with a value)",
                        *options.periodic));
    }
}

PointOptions point_options(const PointInputOptions& options) {
    PointOptions result;
    if (!options.value.empty()) result.value = options.value;
    result.neighbours = options.neighbours;
    result.periodic = period_of(options);
    const auto radius = parse_numbers(options.radius);
    if (radius.empty()) {
        result.smoothing = options.radius == "adaptive" ? "" : options.radius;
        return result;
    }
    if (radius.size() != 1 || !(radius.front() > 0))
        throw UsageError(fmt::format(
            "--radius {}: expected a number > 0, 'adaptive' or an attribute", options.radius));
    result.radius = radius.front();
    return result;
}

std::vector<std::string> model_files(const std::vector<std::string>& files) {
    std::vector<std::string> all;
    for (const std::string& file : files) {
        if (extension_of(file) != ".json") {
            all.push_back(file);
            continue;
        }
        for (const fs::path& named : read_model_index(file)) all.push_back(named.string());
    }
    return all;
}

std::vector<std::string> models_of_one_site(const std::vector<std::string>& inputs) {
    if (inputs.size() != 1 || !is_site(inputs.front())) return {};
    const std::vector<fs::path> models = models_of_site(inputs.front());
    if (models.size() < 2) return {};
    return {models.begin(), models.end()};
}

void note_first_model(const std::string& site, const std::vector<std::string>& models) {
    note(fmt::format("{}: showing the first of {} models; {} is another", site, models.size(),
                     models[1]));
}

bool all_sites(const std::vector<std::string>& files) {
    return !files.empty() && std::ranges::all_of(files, [](const std::string& file) {
        return find_site(file).has_value();
    });
}

Gaussians load_model(const std::string& file, Hierarchy* hierarchy, const ValueRules& rules) {
    ValueNotes changed;
    Gaussians model = read_model(file, hierarchy, rules, &changed);
    if (const std::string text = values_text(changed, file); !text.empty()) note(text);
    return model;
}

Gaussians load_models(const std::vector<std::string>& files, Hierarchy* hierarchy,
                      const std::optional<SiteView>& view, const ValueRules& rules) {
    Gaussians model;
    Hierarchy one;
    for (const std::string& file : model_files(files)) {
        const std::size_t before = model.size();
        if (view) {
            const SitePath site = *find_site(file);
            SiteCut cut(site.folder, site.model);
            append(model, cut.choose(view->frame, {view->pixel_error, true}));
            view->report->chunks += cut.report().chunks;
            view->report->bytes_read += cut.report().bytes_read;
            continue;
        }
        Gaussians read = load_model(file, hierarchy ? &one : nullptr, rules);
        // Files of other formats leave the hierarchy to their readers.
        if (hierarchy && one.empty() && extension_of(file) != ".ply") one = build_hierarchy(read);
        append(model, read);
        if (hierarchy) append(*hierarchy, one, before);
    }
    if (hierarchy) set_origin(hierarchy->nodes, model.origin);
    return model;
}

Subject subject_of(std::span<const Volume> volumes) {
    Box box;
    for (const Volume& volume : volumes) box.include(world_box(volume));
    return vog::subject_of(box, content_of(volumes, box));
}

Subject subject_of(const std::string& input, const VolumeInputOptions& volume,
                   const PointInputOptions& points) {
    const FileKind kind = kind_of(input, volume.grid);
    if (const auto site = find_site(input))
        return vog::subject_of(read_site_info(site->folder).models[site->model].description);
    if (kind == FileKind::model)
        return vog::subject_of(load_models({input}, nullptr, {}, volume.values));
    if (kind == FileKind::points) {
        std::vector<std::string> notes;
        return vog::subject_of(
            convert_points(load_points({input}, points, volume, notes), point_options(points)));
    }
    const fs::path file(input);
    return subject_of(read_levels(std::span(&file, 1), level_options(volume)).volumes);
}

Vec3d parse_vector(const std::string& option, const std::string& text) {
    const auto v = parse_numbers(text);
    if (v.size() != 3) throw UsageError(fmt::format("{} {}: expected x,y,z", option, text));
    return {v[0], v[1], v[2]};
}

}  // namespace vog::cli
