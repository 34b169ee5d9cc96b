// html_text.h: text and bytes for embedding in HTML and SVG.
#pragma once

#include <string>

namespace vog {

/// Text with & < > " replaced by entities, for element content and quoted attributes.
std::string escaped(const std::string& text);

/// Base64 with padding and without line breaks.
std::string base64(const std::string& bytes);

}  // namespace vog
