// value_maps.h: pictures of maps of values, which are NaN where nothing is shown, from inputs to files and their report.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/render_run.h"
#include "vog/quantity.h"

namespace vog::cli {

/// A map that was drawn.
struct MapPicture {
    std::string name, unit;     ///< of the shown number: "deviation of temperature", "K"
    ValueMap shown;             ///< coloured
    std::vector<float> values;  ///< of the figures in reports
    DepthImage covered;         ///< > 0 where reports count a pixel
    ColorScale scale;
    std::optional<CutReport> cut{};
};

/// Inputs ready for maps.
struct MapDrawing {
    Drawing drawing;                                                 ///< for views and reports
    std::function<void(const Camera&, Size, const Progress&)> draw;  ///< keeps the map
    std::function<MapPicture(const QuantityArguments&)> picture;     ///< of the map, on the root
    std::function<void(const std::string& file)> write;              ///< its numbers
};

/// Loads, draws, colours and saves the map of each view.
/// returns  figures of the shown values in place of T's; none on ranks other than the root
std::vector<RenderedPicture> render_map(const RenderArguments& arguments, const CLI::App& command,
                                        const RenderRanks& ranks,
                                        const std::function<MapDrawing()>& load);

}  // namespace vog::cli
