// html_text.h: text and bytes as HTML and SVG hold them.
#pragma once

#include <string>

namespace vog {

/// Text as content or within quotes: & < > " are replaced.
std::string escaped(const std::string& text);

/// With padding, without line breaks.
std::string base64(const std::string& bytes);

}  // namespace vog
