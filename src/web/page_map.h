// page_map.h: a transfer function in the JSON of a page.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "vog/shade.h"

namespace vog::web {

inline nlohmann::ordered_json map_json(const TransferFunction& tf) {
    using Json = nlohmann::ordered_json;
    Json colors = Json::array(), opacity = Json::array();
    // Four digits are finer than the 8 bits of the display.
    const auto rounded = [](float v) { return std::round(double{v} * 1e4) / 1e4; };
    const auto brief = [](float v) { return std::stod(fmt::format("{}", v)); };
    for (const ColorPoint& c : tf.color)
        colors.push_back({brief(c.v), rounded(c.r), rounded(c.g), rounded(c.b)});
    for (const OpacityPoint& o : tf.opacity) opacity.push_back({brief(o.v), rounded(o.opacity)});
    return {{"name", tf.name}, {"colors", colors}, {"opacity", opacity}};
}

}  // namespace vog::web
