// views.h: the views of a run, one or those of a turn, and the files of their pictures.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pictures/render_run.h"

namespace vog::cli {

/// Whether an output names a picture of many by its number: "turn_%04d.png", "frames/%d.exr".
bool is_numbered(const std::string& output);
/// Outputs of numbered pictures, from 1 on.
/// output     a folder, whose pictures are 0001.png and so on; a name as is_numbered has; empty: no names
/// extension  of pictures in a folder
std::vector<std::string> numbered_outputs(const std::string& output, int count,
                                          const std::string& extension);

/// The camera of the first view of a run.
/// subject  of the inputs
Camera first_camera(const RenderArguments& arguments, const GivenOptions& command,
                    const Subject& subject);

/// Draws one picture with the files of its arguments.
/// returns  its figures; none on ranks other than the root
using DrawView =
    std::function<std::optional<RenderedPicture>(const RenderArguments&, const Camera&)>;
/// Draws the view of the arguments, or those of a turn about it: --turntable pictures about the up axis through the
/// point looked at, counter-clockwise from above: all, or turn_part. A fitted view is as far as the farthest of the turn.
/// All have the extinction and range of the first.
/// subject  of the inputs
/// returns  figures of each picture; none on ranks other than the root
std::vector<RenderedPicture> render_views(const RenderArguments& arguments,
                                          const GivenOptions& command, const Subject& subject,
                                          const DrawView& draw);

/// Writes a picture to the output, or hands it over.
/// record  how it was made, for its file
void save_picture(const RenderArguments& arguments, const Image& picture,
                  const std::string& record);

}  // namespace vog::cli
