// value_transfer_run.h: the transfer function of a volume picture, by options, data and a few small pictures.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shared/render_run.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog::cli {

/// Picture of the inputs.
using DrawByValue =
    std::function<VolumeImage(const ValueTransfer&, const Camera&, int width, int height)>;

/// Values and space of the inputs.
struct ValueData {
    std::string input;            ///< file, for messages
    double lower = 0, upper = 0;  ///< least and largest value
    double diagonal = 0;          ///< of the box, world units
};

/// Transfer function and the range that its shares are of.
struct ChosenTransfer {
    ValueTransfer transfer;
    double lower = 0, upper = 0;
    std::vector<std::string> notes;
};
/// The transfer function of --tf, --window, --band and --iso over --range or the data, with --threshold and
/// --unit-distance.
/// draw    draws the inputs small, where the unit distance is to be found
/// camera  of the picture of this size
/// throws  CLI::ValidationError for options that exclude each other, vog::Error for bands outside the data
ChosenTransfer choose_transfer(const RenderArguments& arguments, const CLI::App& command,
                               const ValueData& data, const DrawByValue& draw, const Camera& camera,
                               Size size);

/// Mean of alpha over the pixels that have some; 0 where none has.
double mean_opacity(const VolumeImage& picture);

}  // namespace vog::cli
