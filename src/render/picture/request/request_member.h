// request_member.h: a member of requests with its values in JSON, and kinds of such members.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "vog/request_schema.h"

namespace vog::requests {

using Json = nlohmann::ordered_json;

/// Values of a member in JSON. read() gets the key for its messages; null is an open member's default.
struct Values {
    std::function<Json(const PictureRequest&)> write;
    std::function<void(const std::string&, const Json&, PictureRequest&)> read;
};
struct Entry {
    RequestMember schema;
    Values values;
};
/// All members, in the order that they are written in; the camera is the last.
const std::vector<Entry>& entries();
const Entry& entry_of(const std::string& key);

/// throws  RequestError " VALUE: expected ..."
[[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& expected);
double number(const std::string& key, const Json& value, const std::string& expected);
/// A row of so many numbers.
std::vector<double> row(const std::string& key, const Json& value, std::size_t count,
                        const std::string& expected);

/// Numbers of a range, with a text on it.
struct Range {
    double low, high;
    const char* text;
};

/// A truth, a text, or a number of the range.
template <class Value>
Value checked(const std::string& key, const Json& value, const Range& range) {
    if constexpr (std::same_as<Value, bool>) {
        if (!value.is_boolean()) refuse(key, value, "true or false");
    } else if constexpr (std::same_as<Value, std::string>) {
        if (!value.is_string()) refuse(key, value, "text");
    } else {
        const double given = number(key, value, range.text);
        if (!(given >= range.low && given <= range.high) ||
            (std::integral<Value> && given != std::floor(given)))
            refuse(key, value, range.text);
    }
    return value.get<Value>();
}

/// A member that has a value always. get(request) is a reference to it.
template <class Get>
Values plain(Get get, Range range = {}) {
    using Value = std::remove_cvref_t<decltype(get(std::declval<PictureRequest&>()))>;
    return {[get](const PictureRequest& r) { return Json(get(r)); },
            [get, range](const std::string& key, const Json& value, PictureRequest& r) {
                get(r) = checked<Value>(key, value, range);
            }};
}
/// An optional number.
template <class Get>
Values open(Get get, Range range) {
    using Value =
        typename std::remove_cvref_t<decltype(get(std::declval<PictureRequest&>()))>::value_type;
    return {[get](const PictureRequest& r) { return get(r) ? Json(*get(r)) : Json(); },
            [get, range](const std::string& key, const Json& value, PictureRequest& r) {
                get(r).reset();
                if (!value.is_null()) get(r) = checked<Value>(key, value, range);
            }};
}
/// A word, by the enum's order.
template <class Get>
Values choice(Get get, std::vector<std::string> words) {
    using Enum = std::remove_cvref_t<decltype(get(std::declval<PictureRequest&>()))>;
    return {
        [get, words](const PictureRequest& r) { return words[static_cast<std::size_t>(get(r))]; },
        [get, words](const std::string& key, const Json& value, PictureRequest& r) {
            const auto found = value.is_string()
                                   ? std::ranges::find(words, value.get<std::string>())
                                   : words.end();
            if (found == words.end())
                refuse(key, value, fmt::format("'{}'", fmt::join(words, "', '")));
            get(r) = static_cast<Enum>(found - words.begin());
        }};
}
/// Two optional numbers, the first one below the second unless they are a centre and a width.
template <class Get>
Values pair(Get get, bool ascending, const char* expected) {
    return {[get](const PictureRequest& r) { return get(r) ? Json(*get(r)) : Json(); },
            [=](const std::string& key, const Json& value, PictureRequest& r) {
                get(r).reset();
                if (value.is_null()) return;
                const std::vector<double> two = row(key, value, 2, expected);
                if (!(ascending ? two[0] < two[1] : two[1] > 0)) refuse(key, value, expected);
                get(r).emplace(two[0], two[1]);
            }};
}

// Members of other kinds (request_values.cpp).
Values transfer_values();
Values bands_values();
Values gradient_values();
Values background_values();
Values weights_values();
Values box_values();
Values planes_values();
Values plane_values();
Values size_values();
Values renderer_values();
Values camera_values();
Values light_values();  // request_lights.cpp
Values light_from_values();
Values clip_lights_values();
Values layers_values();  // request_layers.cpp
/// A layer of a command line: "stars.ply,field=age,tf=inferno,range=0,1", where the file may be missing.
/// throws  RequestError for words that are none of its values
Layer layer_of_words(const std::string& text);
/// Words of a command line as JSON: numbers, rows of them, else text.
Json words_value(const std::string& text);
/// Colours by their names in CSS: "black, white, ..."
std::string color_names();
/// Colour of a band or a surface: [r, g, b], a name or "#rrggbb".
/// throws  RequestError for another value
std::array<float, 3> rgb_of(const std::string& key, const Json& value);

}  // namespace vog::requests
