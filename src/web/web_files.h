// web_files.h: files of the page and shaders, embedded in the library at build time.
#pragma once

#include <string>

namespace vog::web {

/// Text of a file by name without folder.
const char* web_file(const std::string& name);

}  // namespace vog::web
