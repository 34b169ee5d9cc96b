// tiff_files.h: Files of a TIFF stack, one slice each.
#pragma once

#include <filesystem>
#include <vector>

namespace vog::scan {

/// The file, or the slices of a folder or a pattern in the order of their numbers.
/// throws vog::Error for numbers that repeat, skip one or lack in a name
std::vector<std::filesystem::path> tiff_files(const std::filesystem::path& file);

}  // namespace vog::scan
