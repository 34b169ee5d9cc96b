// page_source.h: addresses from which pages load their models.
#pragma once

#include <string>

#include "vog/export_html.h"

namespace vog::web {

/// Checks an address of models.
/// returns  the source that a page's security policy allows for it: its origin, or 'self' for an address relative to the page
/// throws   vog::Error for another scheme than http and https, a user or password, a character that addresses write encoded, a
///          fragment, a folder with a query, a file whose address ends in /
std::string allowed_origin(const HtmlSource& source);

}  // namespace vog::web
