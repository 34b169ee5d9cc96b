// evaluation_json.h: results.json: written after every row, read to resume an evaluation.
#pragma once

#include <filesystem>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// Writes the evaluation so far, beside the file and renamed when complete.
void write_results(const std::filesystem::path& file, const Evaluation& evaluation);

/// Reads a file of write_results. throws vog::Error, with file and key, for other contents
Evaluation read_results(const std::filesystem::path& file);

}  // namespace vog::evaluation
