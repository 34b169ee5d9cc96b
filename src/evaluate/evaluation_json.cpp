// evaluation_json.cpp: evaluation results as JSON; infinite and undefined numbers are null.
#include "evaluate/evaluation_json.h"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "evaluate/evaluation_report.h"
#include "vog/error.h"

namespace vog::evaluation {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "vog evaluation 1";
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Metrics of a view: key in the file, member, and the value that null stands for.
struct Figure {
    const char* name;
    double ViewResult::*member;
    double if_null;
};
constexpr Figure kFigures[] = {
    {"psnr_v_db", &ViewResult::psnr_v_db, kInfinity},
    {"psnr_v_covered_db", &ViewResult::psnr_v_covered_db, kInfinity},
    {"psnr_rgb_db", &ViewResult::psnr_rgb_db, kInfinity},
    {"ssim", &ViewResult::ssim, std::numeric_limits<double>::quiet_NaN()},
    {"relative_l2", &ViewResult::relative_l2, kInfinity},
    {"bias", &ViewResult::bias, kInfinity},
    {"largest_dt", &ViewResult::largest_dt, kInfinity},
    {"off_by_more_than_1", &ViewResult::off_by_1, 0},
    {"off_by_more_than_4", &ViewResult::off_by_4, 0},
};

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number(const Json& json, double if_null) {
    return json.is_null() ? if_null : json.get<double>();
}

Json vector(Vec3d v) { return {v.x, v.y, v.z}; }
Vec3d vector(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json to_json(const Timing& timing) {
    return {{"min", timing.min_ms},
            {"median", timing.median_ms},
            {"max", timing.max_ms},
            {"runs", timing.runs}};
}
Timing timing_from(const Json& json) {
    return {json.at("min").get<double>(), json.at("median").get<double>(),
            json.at("max").get<double>(), json.at("runs").get<int>()};
}

Json to_json(const EvaluationView& view) {
    return {{"name", view.name},
            {"camera",
             {{"eye", vector(view.camera.eye)},
              {"look_at", vector(view.camera.look_at)},
              {"up", vector(view.camera.up)},
              {"fov_degrees", view.camera.fov_degrees}}},
            {"extinction", view.extinction},
            {"covered", view.covered},
            {"reference_ms", to_json(view.reference)}};
}
EvaluationView view_from(const Json& json) {
    const Json& camera = json.at("camera");
    return {json.at("name").get<std::string>(),
            {vector(camera.at("eye")), vector(camera.at("look_at")), vector(camera.at("up")),
             camera.at("fov_degrees").get<double>()},
            json.at("extinction").get<double>(),
            json.at("covered").get<double>(),
            timing_from(json.at("reference_ms"))};
}

Json to_json(const ViewResult& result) {
    Json json = {{"view", result.view}};
    for (const Figure& figure : kFigures) json[figure.name] = number(result.*figure.member);
    json["render_ms"] = to_json(result.render);
    for (const FieldResult& field : result.fields)
        json["fields"].push_back({{"mean_l2", number(field.mean_l2)},
                                  {"deviation_l2", number(field.deviation_l2)},
                                  {"missing", field.missing}});
    return json;
}
ViewResult result_from(const Json& json) {
    ViewResult result;
    result.view = json.at("view").get<std::string>();
    for (const Figure& figure : kFigures)
        result.*figure.member = number(json.at(figure.name), figure.if_null);
    result.render = timing_from(json.at("render_ms"));
    if (json.contains("fields"))
        for (const Json& field : json.at("fields"))
            result.fields.push_back({number(field.at("mean_l2"), kInfinity),
                                     number(field.at("deviation_l2"), kInfinity),
                                     field.at("missing").get<double>()});
    return result;
}

Json to_json(const EvaluationRow& row, const std::vector<std::string>& fields,
             const std::vector<std::string>& functions) {
    Json json = {{"series", row.series},
                 {"step", row.step},
                 {"label", row.label},
                 {"options", row.options},
                 {"aabb_sigma", row.aabb_sigma},
                 {"gaussians", row.gaussians},
                 {"bytes", row.bytes},
                 {"mass_ratio", row.mass_ratio},
                 {"convert_ms", to_json(row.convert)}};
    // Mean and worst over the views, as the tables show them.
    const auto both = [](const Spread& s) {
        return Json{{"mean", number(s.mean)}, {"worst", number(s.worst)}};
    };
    json["psnr_v_db"] = both(spread(row, &ViewResult::psnr_v_db, true));
    json["relative_l2"] = both(spread(row, &ViewResult::relative_l2, false));
    if (has_fields(row))
        for (std::size_t n = 0; n < fields.size(); ++n)
            json["fields"][fields[n]] = {
                {"mean_l2", both(spread(row, n, &FieldResult::mean_l2))},
                {"deviation_l2", both(spread(row, n, &FieldResult::deviation_l2))}};
    for (std::size_t n = 0; n < row.values.size(); ++n) {
        Json& of_function = json["volume"][functions[n]];
        of_function = {{"psnr_rgb_db", both(spread(row, n, &ValueResult::psnr_rgb_db))},
                       {"ssim", both(spread(row, n, &ValueResult::ssim))}};
        for (std::size_t view = 0; view < row.values[n].size(); ++view)
            of_function["views"].push_back(
                {{"view", kValueViews[view]},
                 {"psnr_rgb_db", number(row.values[n][view].psnr_rgb_db)},
                 {"ssim", number(row.values[n][view].ssim)}});
    }
    if (row.voxels)
        json["voxels"] = {{"relative_l2", row.voxels->relative_l2},
                          {"psnr_db", number(row.voxels->psnr_db)},
                          {"mean", row.voxels->mean},
                          {"worst", row.voxels->worst}};
    for (const ViewResult& result : row.views) json["views"].push_back(to_json(result));
    return json;
}
EvaluationRow row_from(const Json& json, const std::vector<std::string>& functions) {
    EvaluationRow row;
    row.series = json.at("series").get<std::string>();
    row.step = json.at("step").get<std::string>();
    row.label = json.at("label").get<std::string>();
    row.options = json.at("options").get<std::string>();
    row.aabb_sigma = json.at("aabb_sigma").get<double>();
    row.gaussians = json.at("gaussians").get<std::uint64_t>();
    row.bytes = json.at("bytes").get<std::uint64_t>();
    row.mass_ratio = json.at("mass_ratio").get<double>();
    row.convert = timing_from(json.at("convert_ms"));
    for (const Json& view : json.at("views")) row.views.push_back(result_from(view));
    if (json.contains("voxels")) {
        const Json& voxels = json.at("voxels");
        row.voxels = {voxels.at("relative_l2").get<double>(),
                      number(voxels.at("psnr_db"), kInfinity), voxels.at("mean").get<double>(),
                      voxels.at("worst").get<double>()};
    }
    if (!json.contains("volume")) return row;
    constexpr double kNoSsim = std::numeric_limits<double>::quiet_NaN();
    for (const std::string& function : functions) {
        std::vector<ValueResult>& results = row.values.emplace_back();
        const Json& views = json.at("volume").at(function).at("views");
        for (std::size_t n = 0; n < std::size(kValueViews); ++n)
            results.push_back({number(views.at(n).at("psnr_rgb_db"), kInfinity),
                               number(views.at(n).at("ssim"), kNoSsim)});
    }
    return row;
}

Evaluation evaluation_from(const std::filesystem::path& file, const Json& json) {
    Evaluation evaluation;
    const Json& data = json.at("data");
    evaluation.title = data.at("title").get<std::string>();
    evaluation.active_voxels = data.at("active_voxels").get<std::uint64_t>();
    evaluation.bounding_voxels = data.at("bounding_voxels").get<std::uint64_t>();
    evaluation.leaves = data.at("leaves").get<std::uint64_t>();
    evaluation.dense_leaves = data.at("dense_leaves").get<std::uint64_t>();
    evaluation.tiles = data.at("tiles").get<std::uint64_t>();
    evaluation.mass = data.at("mass").get<double>();
    const Json& settings = json.at("settings");
    evaluation.width = settings.at("width").get<int>();
    evaluation.height = settings.at("height").get<int>();
    evaluation.tf = settings.at("tf").get<std::string>();
    evaluation.extinction = settings.at("extinction").get<std::string>();
    if (settings.contains("fields"))
        evaluation.fields = settings.at("fields").get<std::vector<std::string>>();
    if (settings.contains("functions"))
        evaluation.functions = settings.at("functions").get<std::vector<std::string>>();
    evaluation.voxels = settings.value("voxels", false);
    evaluation.machine = json.at("machine").at("processor").get<std::string>();
    evaluation.threads = json.at("machine").at("threads").get<int>();
    for (const Json& view : json.at("views")) evaluation.views.push_back(view_from(view));
    for (const Json& row : json.at("rows")) {
        evaluation.rows.push_back(row_from(row, evaluation.functions));
        for (const ViewResult& view : evaluation.rows.back().views)
            if (!view.fields.empty() && view.fields.size() != evaluation.fields.size())
                throw Error(fmt::format("{}: {} fields in view {} of '{}', expected {}",
                                        file.string(), view.fields.size(), view.view,
                                        evaluation.rows.back().label, evaluation.fields.size()));
        if (evaluation.rows.back().views.size() != evaluation.views.size())
            throw Error(fmt::format("{}: {} views of '{}', expected {}", file.string(),
                                    evaluation.rows.back().views.size(),
                                    evaluation.rows.back().label, evaluation.views.size()));
    }
    return evaluation;
}

}  // namespace

void write_results(const std::filesystem::path& file, const Evaluation& evaluation) {
    Json json = {{"format", kFormat},
                 {"data",
                  {{"title", evaluation.title},
                   {"active_voxels", evaluation.active_voxels},
                   {"bounding_voxels", evaluation.bounding_voxels},
                   {"leaves", evaluation.leaves},
                   {"dense_leaves", evaluation.dense_leaves},
                   {"tiles", evaluation.tiles},
                   {"mass", evaluation.mass}}},
                 {"settings",
                  {{"width", evaluation.width},
                   {"height", evaluation.height},
                   {"tf", evaluation.tf},
                   {"extinction", evaluation.extinction}}},
                 {"machine", {{"processor", evaluation.machine}, {"threads", evaluation.threads}}},
                 {"views", Json::array()},
                 {"rows", Json::array()}};
    for (const EvaluationView& view : evaluation.views) json["views"].push_back(to_json(view));
    for (const EvaluationRow& row : evaluation.rows)
        json["rows"].push_back(to_json(row, evaluation.fields, evaluation.functions));
    // Without fields, pictures by value and voxels the file is as before.
    if (evaluation.voxels) json["settings"]["voxels"] = true;
    if (!evaluation.fields.empty()) json["settings"]["fields"] = evaluation.fields;
    if (!evaluation.functions.empty()) json["settings"]["functions"] = evaluation.functions;
    const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
    write_file(file, [&](std::ofstream& out) { out << text << "\n"; });
}

Evaluation read_results(const std::filesystem::path& file) {
    require_readable(file);
    try {
        std::ifstream in(file, std::ios::binary);
        const Json json = Json::parse(in);
        if (json.at("format") != kFormat)
            throw Error(fmt::format("{}: format {}, expected \"{}\"", file.string(),
                                    json.at("format").dump(), kFormat));
        return evaluation_from(file, json);
    } catch (const nlohmann::json::exception& error) {
        throw Error(
            fmt::format("{}: not the results of an evaluation, or damaged: {} (without resume they "
                        "are replaced)",
                        file.string(), json_fault(error)));
    }
}

}  // namespace vog::evaluation
