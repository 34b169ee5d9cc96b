// modules.h: shaders of pages.
#pragma once

#include <map>
#include <string>

namespace vog::web {

/// Shaders without comments, by the names of their files.
std::map<std::string, std::string> shader_texts();

}  // namespace vog::web
