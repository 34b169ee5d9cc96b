// conversion_summary.cpp: the one-line summary of a conversion.
#include <fmt/core.h>

#include <string>

#include "vog/convert_moments.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

std::string summary_text(const Gaussians& model, const MomentReport& report,
                         const std::string& of) {
    return summary_text(model.size(), model.source_voxels, report, of);
}

std::string summary_text(std::uint64_t gaussians, std::uint64_t source_voxels,
                         const MomentReport& report, const std::string& of) {
    std::string text = fmt::format("{} Gaussians", gaussians);
    if (source_voxels)
        text += fmt::format(
            ", {:.4g} % of the {}",
            100 * static_cast<double>(gaussians) / static_cast<double>(source_voxels), of);
    text += fmt::format(", mass ratio {:.5f}", report.mass_ratio - report.dropped_mass_share);
    const std::string details = detail_text(report);
    return details.empty() ? text : text + ", " + details;
}

std::string detail_text(const MomentReport& report) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (report.dropped_cells)
        add(fmt::format("{} cells with {:.2g} of the mass dropped", report.dropped_cells,
                        report.dropped_mass_share));
    if (report.measured_error >= 0)
        add(
            fmt::format("measured error {:.4g} in the worst view, {:.4g} on average (relative L2 "
                        "of T, {} views of {}x{})",
                        report.measured_error, report.mean_error, error_views(Box{}).size(),
                        kErrorViewSize_px, kErrorViewSize_px));
    if (report.interpolation_error >= 0)
        add(fmt::format(
            "{} ({:.4g}, {:.4g} on average)",
            report.as_near_as_interpolation() ? "as near as interpolation is" : "interpolation has",
            report.interpolation_error, report.mean_interpolation_error));
    std::string fields;
    for (const auto& [name, error] : report.field_errors)
        fields += fmt::format("{}{} {:.4g}", fields.empty() ? "" : ", ", printable(name), error);
    if (!fields.empty()) add(fmt::format("means along rays in the worst view: {}", fields));
    if (report.stopped_by_count)
        add(fmt::format("stopped at one Gaussian to {} voxels, or {}", kVoxelsPerGaussian,
                        kSmallCount));
    return text;
}

}  // namespace vog
