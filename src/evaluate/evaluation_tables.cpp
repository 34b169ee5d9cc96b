// evaluation_tables.cpp: tables of the report as text cells, for Markdown and HTML.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "evaluate/evaluation_report.h"
#include "evaluate/paper_figures.h"
#include "vog/text.h"

namespace vog::evaluation {

namespace {

/// One of the paper's tables 1 to 3, with the steps of its rows.
struct PaperTable {
    const char *title, *about;
    std::array<const char*, 3> steps;
};
constexpr PaperTable kPaperTables[] = {
    {"1. Dense leaves: block size",
     "The block size in dense leaves varies; sparse leaves use smart grouping.",
     {"lod1", "lod2", "lod3"}},
    {"2. Sparse leaves: strategy",
     "The strategy in sparse leaves varies; a dense leaf is one block of 8³ voxels.",
     {"lod3", "lod4", "lod5"}},
    {"3. Extent of the bounding boxes",
     "LOD 3. A Gaussian contributes to a ray only if the ray meets the box of σ times the paper's "
     "radii around its mean.",
     {"sigma1", "sigma2", "sigma3"}},
};
constexpr const char* kLevels[] = {"lod1", "lod2", "lod3", "lod4", "lod5"};

std::string percent(std::uint64_t part, std::uint64_t whole) {
    const double share =
        100 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(whole, 1));
    return fmt::format("{:.3g} %", share);
}

const std::vector<std::string> kQualityColumns = {"",
                                                  "Gaussians",
                                                  "of active voxels",
                                                  "size",
                                                  "V, dB",
                                                  "V, dB (mean)",
                                                  "V, dB (worst)",
                                                  "covered, dB (mean)",
                                                  "covered, dB (worst)",
                                                  "RGB, dB",
                                                  "L2 of T",
                                                  "bias of T",
                                                  "frames/s",
                                                  "convert, ms"};

/// Cells of kQualityColumns for a row; from the view `paper` unless the column names mean or worst.
std::vector<std::string> quality_cells(const Evaluation& evaluation, const EvaluationRow& row) {
    const ViewResult* paper = find_view(row, "paper");
    if (!paper) return {};
    const Spread psnr = spread(row, &ViewResult::psnr_v_db, true);
    const Spread covered = spread(row, &ViewResult::psnr_v_covered_db, true);
    return {fmt::format("{}: {}", step_title(row.step), row.label),
            count_text(row.gaussians),
            percent(row.gaussians, evaluation.active_voxels),
            bytes_text(row.bytes),
            decibel_text(paper->psnr_v_db),
            decibel_text(psnr.mean),
            decibel_text(psnr.worst),
            decibel_text(covered.mean),
            decibel_text(covered.worst),
            decibel_text(paper->psnr_rgb_db),
            fmt::format("{:.4f}", paper->relative_l2),
            fmt::format("{:.3f}", paper->bias),
            fmt::format("{:.1f}", frames_per_second(paper->render)),
            fmt::format("{:.1f}", row.convert.median_ms)};
}

bool has_paper_figures(const Evaluation& evaluation) {
    return paper_figures(evaluation, kLevels[0]) != nullptr;
}

ReportTable quality_table(const Evaluation& evaluation, const PaperTable& paper) {
    ReportTable table{paper.title, paper.about, kQualityColumns, {}, 0};
    if (has_paper_figures(evaluation)) {
        for (const char* column : {"dB", "frames/s", "Gaussians"}) table.columns.push_back(column);
        table.paper_columns = 3;
    }
    for (const std::string& series : series_of(evaluation)) {
        if (!is_paper_series(series)) continue;
        table.rows.push_back({series_title(series)});
        for (const char* step : paper.steps) {
            const EvaluationRow* row = find_row(evaluation, series, step);
            if (!row) continue;
            std::vector<std::string> cells = quality_cells(evaluation, *row);
            // The paper has one amplitude: its figures stand beside the series of that amplitude.
            const PaperFigures* figures =
                series == "mean" ? paper_figures(evaluation, step) : nullptr;
            if (figures)
                cells.insert(cells.end(), {fmt::format("{:.2f}", figures->psnr_db),
                                           fmt::format("{:.1f}", figures->frames_per_second),
                                           figures->gaussians});
            cells.resize(table.columns.size());
            table.rows.push_back(cells);
        }
    }
    return table;
}

/// The paper's table 4. Both amplitudes have the same Gaussians, hence one set of rows.
ReportTable count_table(const Evaluation& evaluation) {
    ReportTable table{"4. Gaussians against voxels",
                      "The paper compares with the number of voxels in the bounding box. Compared "
                      "with the active voxels, which are the ones that the file stores, the saving "
                      "is smaller.",
                      {"", "Gaussians", "of active voxels", "of bounding-box voxels", "size"},
                      {},
                      0};
    if (has_paper_figures(evaluation)) {
        table.columns.insert(table.columns.end(), {"Gaussians", "of bounding-box voxels"});
        table.paper_columns = 2;
    }
    for (const char* step : kLevels) {
        const EvaluationRow* row = find_row(evaluation, "mean", step);
        if (!row) row = find_row(evaluation, "mass", step);
        if (!row) continue;
        std::vector<std::string> cells = {
            fmt::format("{}: {}", step_title(step), row->label), count_text(row->gaussians),
            percent(row->gaussians, evaluation.active_voxels),
            percent(row->gaussians, evaluation.bounding_voxels), bytes_text(row->bytes)};
        if (const PaperFigures* figures = paper_figures(evaluation, step))
            cells.insert(cells.end(), {figures->gaussians, figures->bounding_share});
        cells.resize(table.columns.size());
        table.rows.push_back(cells);
    }
    return table;
}

/// Uniform cells, then adaptive cuts with the counts of the uniform cells and of the paper.
ReportTable moment_table(const Evaluation& evaluation) {
    ReportTable table{"5. Moments",
                      "Each Gaussian has the mass, mean and covariance of a cell of voxels. The "
                      "adaptive cut chooses cells of several sizes for a given number of "
                      "Gaussians: that of the uniform cells above, or that of the paper's "
                      "conversion.",
                      kQualityColumns,
                      {},
                      0};
    for (const std::string& series : series_of(evaluation)) {
        if (!is_moment_series(series)) continue;
        table.rows.push_back({series_title(series)});
        for (const EvaluationRow& row : evaluation.rows)
            if (row.series == series) table.rows.push_back(quality_cells(evaluation, row));
    }
    return table;
}

ReportTable series_table(const Evaluation& evaluation, const std::string& series) {
    ReportTable table{series_title(series), "", kQualityColumns, {}, 0};
    for (const EvaluationRow& row : evaluation.rows)
        if (row.series == series) table.rows.push_back(quality_cells(evaluation, row));
    return table;
}

/// The views, with the reference's speed and the first row of every series from each.
ReportTable view_table(const Evaluation& evaluation) {
    ReportTable table{
        "The views",
        "PSNR of V in dB of each series' finest level, from every view. The other tables show the "
        "view `paper`, or the mean and the worst over all views.",
        {"view", "covered", "extinction", "reference, frames/s"},
        {},
        0};
    const std::vector<std::string> all = series_of(evaluation);
    std::vector<const EvaluationRow*> first;
    for (const std::string& series : all)
        for (const EvaluationRow& row : evaluation.rows)
            if (row.series == series) {
                first.push_back(&row);
                table.columns.push_back(
                    fmt::format("{}, {}", step_title(row.step), series_title(series)));
                break;
            }
    for (const EvaluationView& view : evaluation.views) {
        std::vector<std::string> cells = {view.name, fmt::format("{:.1f} %", 100 * view.covered),
                                          fmt::format("{:.4g}", view.extinction),
                                          fmt::format("{:.1f}", frames_per_second(view.reference))};
        for (const EvaluationRow* row : first) {
            const ViewResult* result = find_view(*row, view.name);
            cells.push_back(result ? decibel_text(result->psnr_v_db) : "");
        }
        table.rows.push_back(cells);
    }
    return table;
}

/// Errors of the maps of fields, of all rows that have them.
ReportTable field_table(const Evaluation& evaluation) {
    ReportTable table{"Fields",
                      "Maps of each field against those of the voxels, over pixels with a column "
                      "above a thousandth "
                      "of the largest, weighted by it: relative L2 of the mean along the ray, and "
                      "L2 of the deviation "
                      "over the root mean square of the field; of vectors the component along the "
                      "view. Mean and worst "
                      "over all views.",
                      {"", "Gaussians"},
                      {},
                      0};
    for (const std::string& field : evaluation.fields)
        for (const char* part : {"mean", "deviation"})
            for (const char* over : {"mean", "worst"})
                table.columns.push_back(fmt::format("{}: {} ({})", field, part, over));
    for (const std::string& series : series_of(evaluation)) {
        std::vector<std::vector<std::string>> rows;
        for (const EvaluationRow& row : evaluation.rows) {
            if (row.series != series || !has_fields(row)) continue;
            std::vector<std::string>& cells = rows.emplace_back();
            cells = {fmt::format("{}: {}", step_title(row.step), row.label),
                     count_text(row.gaussians)};
            for (std::size_t n = 0; n < evaluation.fields.size(); ++n)
                for (const auto figure : {&FieldResult::mean_l2, &FieldResult::deviation_l2}) {
                    const Spread error = spread(row, n, figure);
                    cells.push_back(fmt::format("{:.2f} %", 100 * error.mean));
                    cells.push_back(fmt::format("{:.2f} %", 100 * error.worst));
                }
        }
        if (rows.empty()) continue;
        table.rows.push_back({series_title(series)});
        table.rows.insert(table.rows.end(), rows.begin(), rows.end());
    }
    return table;
}

/// PSNR and SSIM of the pictures by value, of all rows that have them.
ReportTable value_table(const Evaluation& evaluation) {
    ReportTable table{"Volume rendering by value",
                      "Pictures by value against those of the voxels, over black, under each "
                      "transfer function, from "
                      "the view `paper` and both directions of the three axes: PSNR of RGB, and "
                      "SSIM of the luma. "
                      "Mean and worst over these views.",
                      {"", "Gaussians"},
                      {},
                      0};
    for (const std::string& function : evaluation.functions)
        for (const char* figure :
             {"RGB, dB (mean)", "RGB, dB (worst)", "SSIM (mean)", "SSIM (worst)"})
            table.columns.push_back(fmt::format("{}: {}", function, figure));
    for (const std::string& series : series_of(evaluation)) {
        std::vector<std::vector<std::string>> rows;
        for (const EvaluationRow& row : evaluation.rows) {
            if (row.series != series || row.values.empty()) continue;
            std::vector<std::string>& cells = rows.emplace_back();
            cells = {fmt::format("{}: {}", step_title(row.step), row.label),
                     count_text(row.gaussians)};
            for (std::size_t n = 0; n < row.values.size(); ++n) {
                const Spread psnr = spread(row, n, &ValueResult::psnr_rgb_db);
                const Spread ssim = spread(row, n, &ValueResult::ssim);
                cells.insert(cells.end(),
                             {decibel_text(psnr.mean), decibel_text(psnr.worst),
                              fmt::format("{:.4f}", ssim.mean), fmt::format("{:.4f}", ssim.worst)});
            }
        }
        if (rows.empty()) continue;
        table.rows.push_back({series_title(series)});
        table.rows.insert(table.rows.end(), rows.begin(), rows.end());
    }
    return table;
}

/// Errors of the voxels, of all rows that have them.
ReportTable voxel_table(const Evaluation& evaluation) {
    ReportTable table{"Voxels",
                      "The model turned back into voxels, on the volume's own lattice, against the "
                      "volume: relative L2, PSNR "
                      "against the largest voxel, mean and worst difference of a voxel in percent "
                      "of the largest.",
                      {"", "Gaussians", "L2", "PSNR, dB", "mean", "worst"},
                      {},
                      0};
    for (const std::string& series : series_of(evaluation)) {
        std::vector<std::vector<std::string>> rows;
        for (const EvaluationRow& row : evaluation.rows)
            if (row.series == series && row.voxels)
                rows.push_back({fmt::format("{}: {}", step_title(row.step), row.label),
                                count_text(row.gaussians),
                                fmt::format("{:.4f}", row.voxels->relative_l2),
                                decibel_text(row.voxels->psnr_db),
                                fmt::format("{:.3f} %", 100 * row.voxels->mean),
                                fmt::format("{:.1f} %", 100 * row.voxels->worst)});
        if (rows.empty()) continue;
        table.rows.push_back({series_title(series)});
        table.rows.insert(table.rows.end(), rows.begin(), rows.end());
    }
    return table;
}

}  // namespace

std::vector<ReportTable> report_tables(const Evaluation& evaluation) {
    std::vector<ReportTable> tables;
    for (const PaperTable& paper : kPaperTables) tables.push_back(quality_table(evaluation, paper));
    tables.push_back(count_table(evaluation));
    tables.push_back(moment_table(evaluation));
    for (const std::string& series : series_of(evaluation))
        if (!is_paper_series(series) && !is_moment_series(series))
            tables.push_back(series_table(evaluation, series));
    if (!evaluation.fields.empty()) tables.push_back(field_table(evaluation));
    if (!evaluation.functions.empty()) tables.push_back(value_table(evaluation));
    if (evaluation.voxels) tables.push_back(voxel_table(evaluation));
    tables.push_back(view_table(evaluation));
    std::erase_if(tables, [](const ReportTable& table) { return table.rows.empty(); });
    return tables;
}

}  // namespace vog::evaluation
