// field_run.h: one picture of a field, load -> maps -> colours -> image.
#pragma once

#include "shared/render_run.h"

namespace vog::cli {

/// Renders and writes the picture of --show mean or deviation.
/// throws  vog::Error for inputs without the field; CLI::ValidationError for options without effect
std::optional<RenderedPicture> render_field(const RenderArguments& arguments,
                                            const CLI::App& command, const RenderRanks& ranks);

}  // namespace vog::cli
