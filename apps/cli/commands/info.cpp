// info.cpp: vog info: the contents of files: grids, models, particles.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "commands/commands.h"
#include "files/inputs.h"
#include "files/next_steps.h"
#include "terminal/terminal.h"
#include "vog/error.h"
#include "vog/model_io.h"
#include "vog/periodic.h"
#include "vog/points.h"
#include "vog/scan_io.h"
#include "vog/site.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

Json array(Vec3d v) { return {v.x, v.y, v.z}; }
Json array(Vec3i v) { return {v.x, v.y, v.z}; }
Json array(const Box& box) {
    if (box.empty()) return nullptr;
    return {{"lower", array(box.lower)}, {"upper", array(box.upper)}};
}
/// Both corners, with as many digits as tell them apart: 6 of the box's size.
std::string text(const Box& box) {
    const Vec3d size = box.upper - box.lower;
    double least = std::numeric_limits<double>::infinity(), farthest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] > 0) least = std::min(least, size[axis]);
        farthest = std::max({farthest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
    }
    const double more = std::ceil(std::log10(std::max(1.0, farthest / least)));
    constexpr int kDigits = 6, kMost = 17;
    const int digits = std::min(kMost, kDigits + static_cast<int>(std::min(more, 1.0 * kMost)));
    const auto corner = [&](Vec3d v) {
        return fmt::format("({:.{}g}, {:.{}g}, {:.{}g})", v.x, digits, v.y, digits, v.z, digits);
    };
    return corner(box.lower) + " to " + corner(box.upper);
}
/// A unit as it stands behind a number; empty: none.
std::string after_number(const std::string& unit) { return unit.empty() ? "" : " " + unit; }
std::string text(Vec3i v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

void fact(const std::string& name, const std::string& value) {
    print_line(fmt::format("  {:<14} {}", name, value));
}

Json as_json(const VolumeInfo& volume) {
    const GridInfo& grid = volume.grid;
    Json json = {{"name", grid.name},
                 {"type", grid.type},
                 {"class", grid.grid_class},
                 {"half_stored", grid.half_stored},
                 {"active_voxels", grid.active_voxels},
                 {"active_tiles",
                  {{"8", grid.active_tiles[0]},
                   {"128", grid.active_tiles[1]},
                   {"4096", grid.active_tiles[2]}}},
                 {"leaves", grid.leaves},
                 {"dense_leaves", grid.dense_leaves},
                 {"index_box", {{"lower", array(grid.lower)}, {"upper", array(grid.upper)}}},
                 {"world_box", array(grid.world)},
                 {"min", grid.min},
                 {"max", grid.max},
                 {"memory_bytes", grid.memory_bytes}};
    if (grid.points) json["points"] = grid.points;
    if (!volume.coordinates.empty()) json["coordinates"] = volume.coordinates;
    if (!volume.length_unit.empty()) json["length_unit"] = volume.length_unit;
    if (!volume.value_unit.empty()) json["value_unit"] = volume.value_unit;
    if (volume.background != 0) json["background"] = volume.background;
    if (!volume.note.empty()) json["note"] = volume.note;
    if (grid.affine) {
        Json rows = Json::array();
        for (int r = 0; r < 3; ++r) {
            const Vec3d row = grid.world_from_index.linear.row[static_cast<std::size_t>(r)];
            rows.push_back({row.x, row.y, row.z, grid.world_from_index.translation[r]});
        }
        json["world_from_index"] = rows;
    }
    return json;
}

void print(const VolumeInfo& volume) {
    const GridInfo& grid = volume.grid;
    print_line(fmt::format("grid '{}'", grid.name));
    fact("type", grid.type + (grid.half_stored ? ", stored as half" : ""));
    fact("class", grid.grid_class);
    if (grid.points) fact("points", count_text(grid.points));
    fact("active voxels", count_text(grid.active_voxels));
    fact("active tiles",
         fmt::format("{} of 8^3, {} of 128^3, {} of 4096^3", count_text(grid.active_tiles[0]),
                     count_text(grid.active_tiles[1]), count_text(grid.active_tiles[2])));
    fact("leaves", fmt::format("{}, {} of them dense", count_text(grid.leaves),
                               count_text(grid.dense_leaves)));
    if (grid.active_voxels) {
        const Vec3i size = grid.upper - grid.lower + Vec3i{1, 1, 1};
        fact("bounding box", fmt::format("{} to {}, {}x{}x{} voxels", text(grid.lower),
                                         text(grid.upper), size.x, size.y, size.z));
        fact("value range", fmt::format("{:.6g} to {:.6g}{}", grid.min, grid.max,
                                        after_number(volume.value_unit)));
    }
    if (volume.background != 0)
        fact("background", fmt::format("{:.6g}, density is the value above it", volume.background));
    if (!volume.note.empty()) fact("note", volume.note);
    if (!volume.coordinates.empty()) fact("coordinates", volume.coordinates);
    if (grid.affine) {
        if (!grid.world.empty()) fact("world box", text(grid.world));
        const Mat3& m = grid.world_from_index.linear;
        fact("voxel size",
             fmt::format("{:.6g} x {:.6g} x {:.6g}{}", length(m.column(0)), length(m.column(1)),
                         length(m.column(2)), after_number(volume.length_unit)));
        for (int r = 0; r < 3; ++r) {
            const Vec3d row = m.row[static_cast<std::size_t>(r)];
            fact(r == 0 ? "transform" : "",
                 fmt::format("{:>12.6g} {:>12.6g} {:>12.6g} {:>12.6g}", row.x, row.y, row.z,
                             grid.world_from_index.translation[r]));
        }
    } else {
        fact("transform", "not affine (a frustum)");
    }
    fact("memory", bytes_text(grid.memory_bytes));
}

/// Calls take(field, kind) for each field of a model.
template <class Take>
void for_each_field(const Fields& fields, const Take& take) {
    for (const ScalarField& field : fields.scalar) take(field, "scalar");
    for (const VectorField& field : fields.vector) take(field, "vector");
}

Json as_json(const Gaussians& model, const Hierarchy& hierarchy, std::uint64_t bytes) {
    Json fields = Json::array();
    for_each_field(model.fields, [&](const auto& field, const char* kind) {
        fields.push_back({{"name", field.name},
                          {"kind", kind},
                          {"unit", field.unit},
                          {"min", field.lower},
                          {"max", field.upper}});
    });
    Box bounds;
    for (std::size_t i = 0; i < model.size(); ++i) bounds.include(support_box(model, i));
    return {{"gaussians", model.size()},
            {"rotated", !model.axis_aligned()},
            {"kernel", "truncated Gaussian"},
            {"cutoff", model.cutoff},
            {"mass", mass_without_images(model)},
            {"bounds", array(bounds)},
            {"box", array(model.box)},
            {"origin", array(model.origin)},
            {"fields", fields},
            {"nodes", hierarchy.size()},
            {"bytes", bytes},
            {"source", model.source},
            {"source_voxels", model.source_voxels},
            {"method", model.method},
            {"options", model.options},
            {"reached", model.summary}};
}

void print(const Gaussians& model, const Hierarchy& hierarchy, std::uint64_t bytes) {
    Box bounds;
    for (std::size_t i = 0; i < model.size(); ++i) bounds.include(support_box(model, i));
    print_line("model");
    fact("Gaussians",
         count_text(model.size()) + (model.axis_aligned() ? ", axis-aligned" : ", rotated"));
    fact("kernel", fmt::format("Gaussian, cut at {:.6g} standard deviations", model.cutoff));
    fact("mass", fmt::format("{:.8g} (density times world volume)", mass_without_images(model)));
    if (!bounds.empty()) fact("bounds", text(bounds));
    if (!model.box.empty()) fact("data box", text(model.box));
    const Vec3d o = model.origin;
    if (o != Vec3d{})
        fact("origin", fmt::format("({}, {}, {}), which means are relative to", o.x, o.y, o.z));
    for_each_field(model.fields, [&](const auto& field, const char* kind) {
        fact("field", fmt::format("{}, {}, {:.6g} to {:.6g}{}", field.name, kind, field.lower,
                                  field.upper, after_number(field.unit)));
    });
    if (!model.source.empty()) fact("source", model.source);
    if (model.source_voxels)
        fact("share", fmt::format("{:.3g} % of {} active voxels or particles",
                                  100.0 * static_cast<double>(model.size()) /
                                      static_cast<double>(model.source_voxels),
                                  count_text(model.source_voxels)));
    if (!model.method.empty()) fact("method", model.method + " " + model.options);
    if (!model.summary.empty()) fact("summary", model.summary);
    fact("hierarchy", hierarchy.empty() ? "none" : count_text(hierarchy.size()) + " nodes");
    fact("size", bytes_text(bytes));
}

struct ValueRange {
    std::string name, unit;     ///< unit empty: not known
    double low = 0, high = 0;   ///< in the unit of the file
    std::uint64_t missing = 0;  ///< particles without the value
};
/// Names of the particles' values, as --value has them, with their ranges.
std::vector<ValueRange> value_ranges(const Points& points) {
    std::vector<ValueRange> ranges;
    for (const std::string& name : point_value_names(points)) {
        if (name == "count") continue;
        BigVector<float> values = point_values(points, name, true);
        const auto missing = std::erase_if(values, [](float value) { return std::isnan(value); });
        const auto attribute = std::ranges::find(points.attributes, name, &PointAttribute::name);
        const bool own = attribute != points.attributes.end();
        const double unit = own ? attribute->unit : 1;
        ValueRange& range = ranges.emplace_back(ValueRange{
            name, own ? attribute->unit_name : point_value_unit(points, name), 0, 0, missing});
        if (values.empty()) continue;
        const auto [low, high] = std::ranges::minmax(values);
        range.low = unit * double{low}, range.high = unit * double{high};
    }
    return ranges;
}

Json as_json(const Points& points) {
    Json values = Json::array();
    for (const ValueRange& range : value_ranges(points)) {
        values.push_back({{"name", range.name}, {"min", range.low}, {"max", range.high}});
        if (!range.unit.empty()) values.back()["unit"] = range.unit;
        if (range.missing) values.back()["missing"] = range.missing;
    }
    Json json = {{"particles", points.size()},
                 {"box", array(bounds(points))},
                 {"velocities", !points.velocity.empty()},
                 {"values", values}};
    if (!points.length_unit.empty()) json["length_unit"] = points.length_unit;
    return json;
}

/// Particles of one type of a file. Where numbers are not finite, those particles are left out, with a note.
/// nonfinite  set where some are
Points described_points(const std::filesystem::path& file, const std::string& type,
                        std::vector<std::string>& notes, bool& nonfinite) {
    PointReadOptions options{.grid = type};
    try {
        return read_points(std::span(&file, 1), options, &notes);
    } catch (const Error&) {
        // Whatever else is wrong is said again.
        options.values.skip_nonfinite = true;
        Points points = read_points(std::span(&file, 1), options, &notes);
        nonfinite = true;
        return points;
    }
}

/// type  of the particles; empty: the format has none
void print(const Points& points, const std::string& type, const std::vector<std::string>& notes) {
    const Box box = bounds(points);
    print_line(type.empty() ? "particles" : fmt::format("particles '{}'", type));
    fact("count", count_text(points.size()));
    fact("box", text(box) + after_number(points.length_unit));
    fact("velocities", points.velocity.empty() ? "none" : "yes");
    for (const ValueRange& range : value_ranges(points))
        fact(range.name,
             fmt::format("{:.6g} to {:.6g}", range.low, range.high) + after_number(range.unit) +
                 (range.missing ? fmt::format(", {} missing", count_text(range.missing)) : ""));
    for (const std::string& note : notes) fact("note", note);
}

void print_nonfinite(const ValueNotes& notes) {
    if (notes.skipped_nonfinite)
        fact("not finite", fmt::format("{} more, which --skip-nonfinite leaves out",
                                       count_text(notes.skipped_nonfinite)));
}

/// Models of a site, from its manifest alone.
Json as_json(const SiteInfo& site) {
    Json models = Json::array();
    for (const SiteModelInfo& model : site.models) {
        Json levels = Json::array(), fields = Json::array();
        for (const SiteLevel& level : model.levels)
            levels.push_back({{"chunks", level.chunks},
                              {"gaussians", level.gaussians},
                              {"bytes", level.bytes},
                              {"error", level.error}});
        for (const std::string& name : model.description.fields.names()) fields.push_back(name);
        models.push_back({{"name", model.name},
                          {"gaussians", model.gaussians},
                          {"box", array(view_box(model.description))},
                          {"fields", fields},
                          {"levels", levels},
                          {"source", model.description.source}});
    }
    return {{"steps", site.steps}, {"models", models}};
}

void print(const SiteInfo& site) {
    print_line(fmt::format("site of {} model{}{}", site.models.size(),
                           site.models.size() > 1 ? "s" : "", site.steps ? ", steps in time" : ""));
    for (const SiteModelInfo& model : site.models) {
        fact("model", printable(model.name));
        fact("Gaussians", count_text(model.gaussians));
        if (!model.description.box.empty()) fact("data box", text(model.description.box));
        if (!model.description.fields.empty())
            fact("fields", fmt::format("{}", fmt::join(model.description.fields.names(), ", ")));
        for (std::size_t depth = 0; depth < model.levels.size(); ++depth) {
            const SiteLevel& level = model.levels[depth];
            fact(fmt::format("depth {}", depth),
                 fmt::format("{} chunks, {} Gaussians and nodes, {}, error {:.4g}",
                             count_text(level.chunks), count_text(level.gaussians),
                             bytes_text(level.bytes), level.error));
        }
    }
}

}  // namespace

std::vector<FileContents> print_contents(const std::vector<std::string>& files, bool json) {
    Json all = Json::array();
    std::vector<FileContents> contents;
    for (const std::string& file : files) {
        const FileKind kind = kind_of(file);
        contents.push_back({file, kind, {}, {}, {}, false, false});
        // Numbers that are not finite are counted, not refused: the other commands say what to do about them.
        const ValueRules rules{.skip_nonfinite = true};
        ValueNotes notes;
        if (is_site(file)) {
            const SiteInfo site = read_site_info(file);
            contents.back().fields = site.models.front().description.fields.names();
            all.push_back({{"file", file}, {"site", as_json(site)}});
            if (!json) {
                print_line(file);
                print(site);
            }
            continue;
        }
        if (kind == FileKind::model) {
            Hierarchy hierarchy;
            const Gaussians model = read_model(file, &hierarchy, rules, &notes);
            const std::uint64_t bytes = std::filesystem::file_size(file);
            contents.back().fields = model.fields.names();
            contents.back().measures_volume =
                model.options.find("--measure volume") != model.options.npos;
            contents.back().nonfinite = notes.skipped_nonfinite > 0;
            all.push_back({{"file", file}, {"model", as_json(model, hierarchy, bytes)}});
            if (!json) {
                print_line(file);
                print(model, hierarchy, bytes);
                print_nonfinite(notes);
            }
            continue;
        }
        if (kind == FileKind::points && extension_of(file) != ".vdb") {
            std::vector<std::string> types = point_types(file);
            contents.back().particle_types = types;
            const bool several = types.size() > 1;
            if (types.empty()) types.emplace_back();
            Json sets = Json::array();
            for (const std::string& type : types) {
                std::vector<std::string> texts;
                const Points points =
                    described_points(file, type, texts, contents.back().nonfinite);
                sets.push_back(as_json(points));
                if (!type.empty()) sets.back()["type"] = type;
                if (!texts.empty()) sets.back()["notes"] = texts;
                if (json) continue;
                if (sets.size() == 1) print_line(file);
                print(points, type, texts);
            }
            all.push_back({{"file", file}, {"points", several ? sets : sets.front()}});
            continue;
        }
        contents.back().grids = inspect_volume(file);
        if (!json) print_line(file);
        Json grids = Json::array();
        for (const VolumeInfo& grid : contents.back().grids) {
            grids.push_back(as_json(grid));
            if (!json) print(grid);
        }
        all.push_back({{"file", file}, {"grids", grids}});
    }
    if (json) print_json(Json{{"files", all}});
    return contents;
}

void add_info(CLI::App& app) {
    auto files = std::make_shared<std::vector<std::string>>();
    auto json = std::make_shared<bool>(false);
    CLI::App* command =
        app.add_subcommand("info", "Show the contents of volumes, particles and models");
    command
        ->add_option("files", *files,
                     "Volumes, particles or models: any file that convert, render or export reads")
        ->required();
    command->add_flag("--json", *json, "Print a single JSON object");
    command->callback([files, json] { print_contents(*files, *json); });
}

}  // namespace vog::cli
