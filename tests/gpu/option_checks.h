// option_checks.h: Options, fields and values of GPU renderers against the CPU's pictures.
#pragma once

#include <filesystem>
#include <string>

#include "vog/image.h"

namespace vog::test {

/// Largest difference relative to the largest expected value; infinite where a value is not finite but expected to be.
double worst_of(const DepthImage& expected, const DepthImage& image);

/// Prints one check. returns true if it failed
bool check(const std::string& renderer, const std::string& what, double worst, double tolerance);

/// Checks boxes, kappa, counters, ends of rays, samples, sizes, clips, fields, values and maxima.
/// returns  number of failures
int check_options(const std::filesystem::path& folder);
/// Checks fields, values, maxima and clips of voxels.
int check_volumes();

}  // namespace vog::test
