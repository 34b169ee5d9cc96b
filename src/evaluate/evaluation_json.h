// evaluation_json.h: results.json, written after every row and read to resume.
#pragma once

#include <filesystem>

#include "vog/evaluate.h"

namespace vog::evaluation {

void write_results(const std::filesystem::path& file, const Evaluation& evaluation);

/// throws vog::Error naming the file and the key for anything but results of write_results
Evaluation read_results(const std::filesystem::path& file);

}  // namespace vog::evaluation
