// request_file.h: --request: pictures drawn again from the record that they keep (vog/picture_record.h).
#pragma once

#include "pictures/render_run.h"

namespace vog::cli {

/// Sets the request that the options state, without a camera. Of --request the file's where no option states another, and its inputs where
/// the command line names none.
/// throws  vog::Error for a file that holds none, or one whose options of reading are none
void take_request(RenderArguments& arguments, GivenOptions& command);
/// Inputs of layers: those of the command line, and the files that layers name. The first one is the picture's.
/// throws  UsageError for a layer of an input that is not there
void place_layers(DrawingArguments& drawing, PictureRequest& request);
/// Options of reading the inputs that the command line states.
std::map<std::string, std::vector<std::string>> reading_options(const GivenOptions& command);

}  // namespace vog::cli
