// evaluation_report.cpp: texts and number formats shared by the Markdown and the HTML report.
#include "evaluate/evaluation_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "vog/text.h"

namespace vog::evaluation {

namespace {

template <class Member>
std::vector<std::string> distinct(const Evaluation& evaluation, Member member) {
    std::vector<std::string> names;
    for (const EvaluationRow& row : evaluation.rows)
        if (std::find(names.begin(), names.end(), row.*member) == names.end())
            names.push_back(row.*member);
    return names;
}

}  // namespace

std::string picture_name(const EvaluationRow* row, const std::string& view, bool difference) {
    const std::string subject = row ? row->series + "-" + row->step : "reference";
    return fmt::format("{}-{}{}.png", subject, view, difference ? "-difference" : "");
}

bool is_paper_series(const std::string& series) { return series == "mean" || series == "mass"; }
bool is_moment_series(const std::string& series) {
    return series == "uniform" || series == "adaptive";
}

std::vector<std::string> series_of(const Evaluation& evaluation) {
    return distinct(evaluation, &EvaluationRow::series);
}
std::vector<std::string> steps_of(const Evaluation& evaluation) {
    return distinct(evaluation, &EvaluationRow::step);
}

std::string series_title(const std::string& series) {
    if (series == "mean") return "paper's amplitude";
    if (series == "mass") return "mass conserved";
    if (series == "uniform") return "moments, uniform cells";
    if (series == "adaptive") return "moments, adaptive cut";
    if (series == "model") return "models";
    return series;
}

std::string step_title(const std::string& step) {
    if (step.find('.') != std::string::npos) return step;  // file of a model
    if (step.starts_with("lod")) return "LOD " + step.substr(3);
    if (step.starts_with("sigma")) return "σ = " + step.substr(5);
    if (step.starts_with("block")) return step.substr(5) + "³";
    return step;
}

const EvaluationRow* find_row(const Evaluation& evaluation, const std::string& series,
                              const std::string& step) {
    for (const EvaluationRow& row : evaluation.rows)
        if (row.series == series && row.step == step) return &row;
    return nullptr;
}

const ViewResult* find_view(const EvaluationRow& row, const std::string& view) {
    for (const ViewResult& result : row.views)
        if (result.view == view) return &result;
    return nullptr;
}

bool has_fields(const EvaluationRow& row) {
    return !row.views.empty() && std::ranges::none_of(row.views, [](const ViewResult& view) {
        return view.fields.empty();
    });
}

std::string decibel_text(double decibels) {
    return std::isinf(decibels) ? "∞" : fmt::format("{:.2f}", decibels);
}

double frames_per_second(const Timing& timing) {
    return timing.median_ms > 0 ? 1000 / timing.median_ms : 0;
}

std::vector<std::string> report_facts(const Evaluation& evaluation) {
    const double sparse =
        100 * static_cast<double>(evaluation.active_voxels) /
        static_cast<double>(std::max<std::uint64_t>(evaluation.bounding_voxels, 1));
    return {
        fmt::format(
            "{}: {} active voxels ({:.1f} % of the {} in the bounding box), {} leaves (8³ voxels), "
            "{} of them dense (all voxels active), {} tiles.",
            evaluation.title, count_text(evaluation.active_voxels), sparse,
            count_text(evaluation.bounding_voxels), count_text(evaluation.leaves),
            count_text(evaluation.dense_leaves), count_text(evaluation.tiles)),
        fmt::format("{}×{} pixels, {} threads of {}. Frames per second: 1 / median time of "
                    "rendering the optical depth T on the CPU, without loading and shading.",
                    evaluation.width, evaluation.height, evaluation.threads, evaluation.machine),
        fmt::format(
            "Reference: the voxels, integrated exactly in a NanoVDB tree of {}. Extinction (factor "
            "on density): {}, the same for both pictures of a view. RGB figures and pictures: "
            "transfer function {} of V = 1 - exp(-T).",
            bytes_text(evaluation.reference_bytes),
            evaluation.extinction == "auto" ? "in each view the value at which the 99th percentile "
                                              "of the reference's non-zero T is 4"
                                            : evaluation.extinction,
            evaluation.tf),
    };
}

}  // namespace vog::evaluation
