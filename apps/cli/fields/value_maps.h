// value_maps.h: pictures and figures of maps of values, which are NaN where nothing is shown.
#pragma once

#include <string>
#include <vector>

#include "shared/render_run.h"
#include "vog/quantity.h"

namespace vog::cli {

/// The picture of a map with --color-bar and --title.
/// label  of the colour bar
Image map_picture(const RenderArguments& arguments, const ValueMap& map, const TransferFunction& tf,
                  const ColorScale& scale, const std::string& label);

/// Figures of the shown values in place of T's.
void set_figures(const RenderArguments& arguments, const std::vector<float>& shown,
                 const ColorScale& scale, RenderedPicture& picture);

}  // namespace vog::cli
