// evaluation_report.h: report pages of an evaluation, and their shared tables and number formats.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// End of the scale of all difference maps, in units of 1/255: one scale, so that rows compare.
inline constexpr double kMapLimit = 20;

/// Views whose pictures are written.
inline constexpr const char* kPictureViews[] = {"paper", "inside"};
/// File name of a picture in the folder `pictures`. row  null: the reference
std::string picture_name(const EvaluationRow* row, const std::string& view, bool difference);

/// Whether a series is the paper's: with its own amplitude, or with the one that conserves mass.
bool is_paper_series(const std::string& series);
/// Whether a series is of moments: uniform cells or the adaptive cut.
bool is_moment_series(const std::string& series);
/// Distinct series, and distinct steps of all series, in order of their first rows.
std::vector<std::string> series_of(const Evaluation& evaluation);
std::vector<std::string> steps_of(const Evaluation& evaluation);
/// Title of a series, such as "moments, uniform cells"; unknown series keep their name.
std::string series_title(const std::string& series);
/// Title of a step, such as "LOD 1", "σ = 2", "4³"; unknown steps keep their name.
std::string step_title(const std::string& step);
/// The row of a series and step; null: none.
const EvaluationRow* find_row(const Evaluation& evaluation, const std::string& series,
                              const std::string& step);
/// The result of a row from a view; null: not rendered from it.
const ViewResult* find_view(const EvaluationRow& row, const std::string& view);

/// Whether all views of a row have results of fields.
bool has_fields(const EvaluationRow& row);
/// Two digits after the point: "44.21"; infinity is "∞".
std::string decibel_text(double decibels);
double frames_per_second(const Timing& timing);

/// A table of the report. A row with a single cell is a heading of the rows that follow.
struct ReportTable {
    std::string title, about;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::size_t paper_columns = 0;  ///< number of last columns that hold the paper's figures
};
/// The paper's tables 1 to 4, one for moments, one for every other series, and one for the views.
std::vector<ReportTable> report_tables(const Evaluation& evaluation);
/// Sentences on the data, on the machine and settings, and on the protocol.
std::vector<std::string> report_facts(const Evaluation& evaluation);

/// Writes results.md.
void write_markdown(const std::filesystem::path& file, const Evaluation& evaluation);
/// Writes a self-contained HTML page.
/// pictures  folder of the pictures to embed; missing ones are left out
void write_report(const std::filesystem::path& file, const Evaluation& evaluation,
                  const std::filesystem::path& pictures);

}  // namespace vog::evaluation
