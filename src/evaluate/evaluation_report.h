// evaluation_report.h: results.csv, and facts that the files of an evaluation share.
#pragma once

#include <filesystem>
#include <string>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// Whether all views of a row have results of fields.
bool has_fields(const EvaluationRow& row);

/// Writes results.csv: a line for each row, with figures from the view `paper`, their mean and their worst over the views.
void write_csv(const std::filesystem::path& file, const Evaluation& evaluation);

}  // namespace vog::evaluation
