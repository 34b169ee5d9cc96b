// shader_sources.h: the files of apps/viewer/shaders, embedded when building.
#pragma once

#include <string>

namespace vog::viewer {

/// Text of a shader by its file's name, without a #version line.
const char* shader_source(const std::string& name);

}  // namespace vog::viewer
