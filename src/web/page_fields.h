// page_fields.h: fields of a page's models: what the page's JSON says of them, and their data.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "web/web_codec.h"

namespace vog::web {

/// Fields of a model.
/// shapes     [levels]
/// view       for the ranges of maps
/// add_data   receives the encoded bytes of a field at a level: field, level, zlib stream
nlohmann::ordered_json fields_json(
    std::span<const Gaussians> levels, std::span<const WebShapes> shapes, const WebFrame& frame,
    const Camera& view,
    const std::function<void(std::size_t, std::size_t, const std::string&)>& add_data);

}  // namespace vog::web
