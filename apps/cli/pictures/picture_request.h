// picture_request.h: scales that pictures share, and notes on requests.
#pragma once

#include <string>
#include <vector>

#include "vog/picture.h"

namespace vog::cli {

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

/// A line on each visible layer.
std::vector<std::string> layer_notes(const ResolvedPicture& picture);

}  // namespace vog::cli
