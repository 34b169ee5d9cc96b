// evaluation_report.h: the pages an evaluation writes, and what they share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// Difference maps of the report end at this many of 255, in every row: rows can be compared.
inline constexpr double kMapLimit = 20;

/// The views whose pictures are kept.
inline constexpr const char* kPictureViews[] = {"paper", "inside"};
/// Name of a picture in the folder `pictures`. row: null for the reference's.
std::string picture_name(const EvaluationRow* row, const std::string& view, bool difference);

/// The paper's amplitude, and the same Gaussians with the amplitude that conserves mass.
bool is_paper_series(const std::string& series);
/// Uniform cells, and the adaptive cut.
bool is_moment_series(const std::string& series);
/// Series of the evaluation, and steps of all its series, in order of their first row.
std::vector<std::string> series_of(const Evaluation& evaluation);
std::vector<std::string> steps_of(const Evaluation& evaluation);
/// "paper's amplitude", "moments, uniform cells", or the series itself.
std::string series_title(const std::string& series);
/// "LOD 1", "σ = 2", "4³", or the step itself.
std::string step_title(const std::string& step);
/// Null if there is no such row.
const EvaluationRow* find_row(const Evaluation& evaluation, const std::string& series,
                              const std::string& step);
/// Null if the row was not rendered from that view.
const ViewResult* find_view(const EvaluationRow& row, const std::string& view);

/// Two digits after the point: "44.21"; infinity is "∞".
std::string decibel_text(double decibels);
double frames_per_second(const Timing& timing);

/// A table of the report. In a row with one cell, the cell is a heading over the rows that follow.
struct ReportTable {
    std::string title, about;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
    std::size_t paper_columns = 0;  ///< the last so many columns are the paper's own figures
};
/// The paper's tables 1 to 4, one of moments, one of every other series, and one of the views.
std::vector<ReportTable> report_tables(const Evaluation& evaluation);
/// One sentence each: the data, the machine and settings, the protocol.
std::vector<std::string> report_facts(const Evaluation& evaluation);

void write_markdown(const std::filesystem::path& file, const Evaluation& evaluation);
/// One page that needs no other file. pictures: the folder it takes them from; absent ones are left
/// out.
void write_report(const std::filesystem::path& file, const Evaluation& evaluation,
                  const std::filesystem::path& pictures);

}  // namespace vog::evaluation
