// shader_sources.h: embedded sources of the window's shaders, including those shared with the page.
#pragma once

#include <string>

namespace vog::viewer {

/// Source of a shader by its file name, without a #version line.
const char* shader_source(const std::string& name);

}  // namespace vog::viewer
