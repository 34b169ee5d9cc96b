// rate_report.h: files of a comparison of bytes and error.
#pragma once

#include <filesystem>
#include <string>

#include "vog/rate_distortion.h"

namespace vog::evaluation {

/// Writes rate_distortion.json, .csv and .md, and the plots. throws vog::Error if one cannot be written
void write_rate_report(const std::filesystem::path& folder, const RateDistortion& results);

/// One plot of a figure over bytes.
struct RatePlot {
    std::string file;  ///< "V.svg"
    std::string svg;   ///< a whole file
};
/// PSNR of V, of pictures by value under each function, and of voxels.
std::vector<RatePlot> rate_plots(const RateDistortion& results);

/// "1.5 MB"; none: "-".
std::string rate_bytes_text(const std::optional<double>& bytes);

}  // namespace vog::evaluation
