// version.h: version, commit and build of the command, for --version and bug reports.
#pragma once

#include <string>

namespace vog::cli {

/// Version of the sources: "0.2.0".
const char* version_number();
/// Commit of the sources, 10 digits, with a "+" for changes beside it; "unknown" without git.
const char* commit_text();
/// Build type of CMake: "Release".
const char* build_type();
/// "vog 0.2.0 (commit 0123456789, Release)".
std::string version_text(const std::string& program);

}  // namespace vog::cli
