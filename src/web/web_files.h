// web_files.h: the files of the page, and the shaders shared with the window, embedded when building.
#pragma once

#include <string>

namespace vog::web {

/// Text of a file by its name, without folder.
const char* web_file(const std::string& name);

}  // namespace vog::web
