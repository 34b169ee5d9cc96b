// chunk_name.h: names of a site's files by their content, so that a cache never holds another content under a name.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vog::site {

/// 32 lower-case hexadecimal digits: the 128 bits of XXH3 of some bytes, one string behind the other.
std::string content_name(std::span<const std::string> contents);
/// Whether a text has the form of such a name: no other is ever made part of a path.
bool is_content_name(std::string_view text);

}  // namespace vog::site
