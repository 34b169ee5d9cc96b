// picture_request.h: the request of a picture by the options of `vog render` and of pages.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "options/color_options.h"
#include "options/quantity_options.h"
#include "options/value_options.h"
#include "pictures/drawing_options.h"
#include "vog/picture.h"

namespace vog::cli {

/// Request without camera, size and renderer.
/// throws  CLI::ValidationError for texts that are none, vog::Error for transfer functions that cannot be read
PictureRequest picture_request(const QuantityArguments& quantity, const ColorArguments& color,
                               const ValueArguments& value);

/// Scales of a first picture, for later ones under the same.
struct SharedScales {
    double extinction = 1, low = 0, high = 0, unit_distance = 0;
    double log = 0;  ///< 1: the range is logarithmic
};
SharedScales scales_of(const Picture& picture);
/// Sets the scales where the request leaves them open.
void share(const SharedScales& scales, PictureRequest& request);

/// Lines on what the transfer function of a volume picture is.
/// request  before its defaults were set
std::vector<std::string> transfer_notes(const PictureRequest& request,
                                        const ResolvedPicture& picture);

}  // namespace vog::cli
