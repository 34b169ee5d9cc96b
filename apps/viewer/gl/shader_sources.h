// shader_sources.h: the shaders of the window, its own and the ones shared with the page, embedded when building.
#pragma once

#include <string>

namespace vog::viewer {

/// Text of a shader by its file's name, without a #version line.
const char* shader_source(const std::string& name);

}  // namespace vog::viewer
