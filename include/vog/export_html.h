// vog/export_html.h: models as one page for a browser: the data, a WebGL2 viewer, nothing else.
// No server, no network, no other file; it opens from a disk or from anywhere (docs/web.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/shade.h"

namespace vog {

/// One entry of the page's switch.
struct HtmlModel {
    std::string name;               ///< what the switch says
    std::vector<Gaussians> levels;  ///< finest first, at least one: what the detail slider offers
};

struct HtmlOptions {
    std::string title = "vog";       ///< plain text, as is the description
    std::string description{};       ///< may have several lines
    std::optional<Camera> camera{};  ///< first view; default: the paper view of the first model
    std::optional<double>
        extinction{};  ///< > 0; default: auto_extinction of each model's first view
    TransferFunction tf = named_transfer_function("inferno");
    ShadeOptions shading{};
    /// The background is black or white as the reader's system is dark or light, not shading's.
    bool system_background = false;
};

struct HtmlReport {
    std::size_t bytes = 0;         ///< of the file
    std::size_t viewer_bytes = 0;  ///< of it: all but the models
    std::size_t gaussians = 0;     ///< of the finest levels
    double extinction = 1;         ///< of the first model
};

/// Every Gaussian takes 14 or 20 bytes before compression (docs/web.md, "What is in the page"):
///   mean      within 1/512 of its smallest standard deviation
///   scale     within 1/2048, as a half float would be
///   rotation  within 0.0005 rad
///   density   mass within 1/2048
/// Those without density are left out.
/// file    written beside its name and renamed when whole
/// throws  vog::Error for no model, a model without levels, an invalid one or one too large for a
///         browser, an unusable camera, transfer function or extinction
HtmlReport write_html(const std::filesystem::path& file, std::span<const HtmlModel> models,
                      const HtmlOptions& options = {});

}  // namespace vog
