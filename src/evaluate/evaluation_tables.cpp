// evaluation_tables.cpp: the tables of the report, as text cells: once for Markdown and HTML.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "evaluate/evaluation_report.h"
#include "evaluate/paper_figures.h"
#include "vog/text.h"

namespace vog::evaluation {

namespace {

/// One of the paper's tables 1 to 3: which steps it shows.
struct PaperTable {
    const char *title, *about;
    std::array<const char*, 3> steps;
};
constexpr PaperTable kPaperTables[] = {
    {"1. Dense leaves: block size",
     "The block in dense leaves varies; sparse leaves by smart grouping.",
     {"lod1", "lod2", "lod3"}},
    {"2. Sparse leaves: strategy",
     "The strategy in sparse leaves varies; a dense leaf is one block of 8³ voxels.",
     {"lod3", "lod4", "lod5"}},
    {"3. Extent of the bounding boxes",
     "LOD 3. A ray counts a Gaussian only if it meets the box of σ times the paper's radii around "
     "its mean.",
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

/// Cells of kQualityColumns for a row; of the view `paper` where nothing else is said.
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
            // The paper has one amplitude: its figures stand beside that one only.
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

/// The paper's table 4. Both series have the same Gaussians: one set of rows.
ReportTable count_table(const Evaluation& evaluation) {
    ReportTable table{"4. Gaussians against voxels",
                      "The paper counts against the voxels of the bounding box; against the active "
                      "voxels, which are what the file stores, the saving is smaller.",
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

/// Uniform cells, then the adaptive cut at their counts and at the paper's.
ReportTable moment_table(const Evaluation& evaluation) {
    ReportTable table{"5. Moments",
                      "Each Gaussian has the mass, mean and covariance of a cell of voxels. The "
                      "adaptive cut chooses the cells for a number of Gaussians: that of the "
                      "uniform cells above, or of the paper's recipe.",
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

/// The views, the speed of the reference in each, and how the first row of every series does.
ReportTable view_table(const Evaluation& evaluation) {
    ReportTable table{
        "The views",
        "V in dB of the finest level from every view: the others of the tables are of "
        "`paper`, or the mean and the worst of all.",
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

}  // namespace

std::vector<ReportTable> report_tables(const Evaluation& evaluation) {
    std::vector<ReportTable> tables;
    for (const PaperTable& paper : kPaperTables) tables.push_back(quality_table(evaluation, paper));
    tables.push_back(count_table(evaluation));
    tables.push_back(moment_table(evaluation));
    for (const std::string& series : series_of(evaluation))
        if (!is_paper_series(series) && !is_moment_series(series))
            tables.push_back(series_table(evaluation, series));
    tables.push_back(view_table(evaluation));
    std::erase_if(tables, [](const ReportTable& table) { return table.rows.empty(); });
    return tables;
}

}  // namespace vog::evaluation
