// request_json.cpp: members of requests by their keys in JSON, one table for writing and reading.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/json_fault.h"
#include "io/camera_json.h"
#include "shade/transfer_json.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/text.h"

namespace vog {

namespace {

using Json = nlohmann::ordered_json;
using Request = PictureRequest;

/// Member of a request. read() gets the key for its messages; null is an open member's default.
struct Member {
    std::string key;
    std::function<Json(const Request&)> write;
    std::function<void(const std::string&, const Json&, Request&)> read;
};

[[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& expected) {
    throw RequestError(key, fmt::format(" {}: expected {}", printable(value.dump(), 60), expected));
}

double number(const std::string& key, const Json& value, const std::string& expected) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(key, value, expected);
    return value.get<double>();
}

/// A row of so many numbers.
std::vector<double> row(const std::string& key, const Json& value, std::size_t count,
                        const std::string& expected) {
    if (!value.is_array() || value.size() != count) refuse(key, value, expected);
    std::vector<double> numbers;
    for (const Json& one : value) numbers.push_back(number(key, one, expected));
    return numbers;
}

/// A choice of words, by the enum's order.
template <class Enum>
Enum word(const std::string& key, const Json& value, const std::vector<std::string>& words) {
    const auto found =
        value.is_string() ? std::ranges::find(words, value.get<std::string>()) : words.end();
    if (found == words.end()) refuse(key, value, fmt::format("'{}'", fmt::join(words, "', '")));
    return static_cast<Enum>(found - words.begin());
}

// --- Kinds of members. get(request) is a reference to the member. ---

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

template <class Get>
Member plain(const char* key, Get get, Range range = {}) {
    using Value = std::remove_cvref_t<decltype(get(std::declval<Request&>()))>;
    return {key, [get](const Request& r) { return Json(get(r)); },
            [get, range](const std::string& name, const Json& value, Request& r) {
                get(r) = checked<Value>(name, value, range);
            }};
}
template <class Get>
Member open(const char* key, Get get, Range range) {
    using Value = typename std::remove_cvref_t<decltype(get(std::declval<Request&>()))>::value_type;
    return {key, [get](const Request& r) { return get(r) ? Json(*get(r)) : Json(); },
            [get, range](const std::string& name, const Json& value, Request& r) {
                get(r).reset();
                if (!value.is_null()) get(r) = checked<Value>(name, value, range);
            }};
}
template <class Get>
Member choice(const char* key, Get get, std::vector<std::string> words) {
    using Enum = std::remove_cvref_t<decltype(get(std::declval<Request&>()))>;
    return {key, [get, words](const Request& r) { return words[static_cast<std::size_t>(get(r))]; },
            [get, words](const std::string& name, const Json& value, Request& r) {
                get(r) = word<Enum>(name, value, words);
            }};
}
/// Two numbers, the first one below the second unless they are a centre and a width.
template <class Get>
Member pair(const char* key, Get get, bool ascending, const char* expected) {
    return {key, [get](const Request& r) { return get(r) ? Json(*get(r)) : Json(); },
            [=](const std::string& name, const Json& value, Request& r) {
                get(r).reset();
                if (value.is_null()) return;
                const std::vector<double> two = row(name, value, 2, expected);
                if (!(ascending ? two[0] < two[1] : two[1] > 0)) refuse(name, value, expected);
                get(r).emplace(two[0], two[1]);
            }};
}

// --- Members of other kinds. ---

Json color_json(const Rgba& c) {
    if (c == Rgba{0, 0, 0, 1}) return "black";
    if (c == Rgba{1, 1, 1, 1}) return "white";
    if (c.a == 0) return "transparent";
    return {c.r, c.g, c.b, c.a};
}
Rgba color_of(const std::string& key, const Json& value) {
    const std::string expected = "'black', 'white', 'transparent' or [r, g, b], each 0 to 1";
    for (const char* name : {"black", "white", "transparent"})
        if (value == name) return named_background(name);
    std::vector<double> c =
        row(key, value, value.is_array() && value.size() == 4 ? 4 : 3, expected);
    if (std::ranges::any_of(c, [](double part) { return !(part >= 0 && part <= 1); }))
        refuse(key, value, expected);
    c.resize(4, 1);
    if (value.size() == 4) c[3] = value[3].get<double>();
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
            static_cast<float>(c[3])};
}

Json light_json(const VolumeLook& look) {
    if (!look.light) return {};
    const Vec3d& to = look.towards_light;
    return to == Vec3d{} ? Json("head") : Json{to.x, to.y, to.z};
}
void set_light(const std::string& key, const Json& value, VolumeLook& look) {
    const std::string expected = "'head' or a direction [x, y, z]";
    look.light = !value.is_null(), look.towards_light = {};
    if (value.is_null() || value == "head") return;
    const std::vector<double> to = row(key, value, 3, expected);
    look.towards_light = {to[0], to[1], to[2]};
    if (look.towards_light == Vec3d{}) refuse(key, value, expected);
}

Json weights_json(const VolumeLook& look) {
    return {look.ambient, look.diffuse, look.specular, look.power};
}
void set_weights(const std::string& key, const Json& value, VolumeLook& look) {
    const std::vector<double> w = row(key, value, 4, "[ambient, diffuse, specular, power]");
    look.ambient = w[0], look.diffuse = w[1], look.specular = w[2], look.power = w[3];
    validate(look);
}

Json box_json(const Clipping& clip) {
    if (!clip.box) return {};
    const auto [l, u] = std::pair{clip.box->lower, clip.box->upper};
    return {{l.x, l.y, l.z}, {u.x, u.y, u.z}};
}
void set_box(const std::string& key, const Json& value, Clipping& clip) {
    const std::string expected = "[[x0, y0, z0], [x1, y1, z1]], the lower corner first";
    clip.box.reset();
    if (value.is_null()) return;
    std::vector<double> c;
    if (value.is_array() && value.size() == 2) {
        c = row(key, value[0], 3, expected);
        const std::vector<double> upper = row(key, value[1], 3, expected);
        c.insert(c.end(), upper.begin(), upper.end());
    } else {
        c = row(key, value, 6, expected);
    }
    clip.box = Box{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
    validate(clip);
}

Json planes_json(const Clipping& clip) {
    Json rows;
    for (const ClipPlane& p : clip.planes)
        rows.push_back({p.normal.x, p.normal.y, p.normal.z, p.offset});
    return rows;
}
void set_planes(const std::string& key, const Json& value, Clipping& clip) {
    const std::string expected = "rows [nx, ny, nz, d]";
    clip.planes.clear();
    if (value.is_null()) return;
    if (!value.is_array()) refuse(key, value, expected);
    for (const Json& one : value) {
        const std::vector<double> p = row(key, one, 4, expected);
        clip.planes.push_back({{p[0], p[1], p[2]}, p[3]});
    }
    validate(clip);
}

Json bands_json(const std::vector<ValueBand>& bands) {
    Json rows;
    for (const ValueBand& band : bands)
        rows.push_back({band.lower,
                        std::isfinite(band.upper) ? Json(band.upper) : Json(),
                        {band.r, band.g, band.b},
                        band.opacity});
    return rows;
}
void set_bands(const std::string& key, const Json& value, std::vector<ValueBand>& bands) {
    const std::string expected = "rows [lower, upper, [r, g, b], opacity], null for no upper end";
    bands.clear();
    if (value.is_null()) return;
    if (!value.is_array() || value.empty()) refuse(key, value, expected);
    for (const Json& one : value) {
        if (!one.is_array() || one.size() != 4) refuse(key, one, expected);
        const std::vector<double> c = row(key, one[2], 3, expected);
        const double upper = one[1].is_null() ? std::numeric_limits<double>::infinity()
                                              : number(key, one[1], expected);
        bands.push_back({number(key, one[0], expected), upper, static_cast<float>(c[0]),
                         static_cast<float>(c[1]), static_cast<float>(c[2]),
                         number(key, one[3], expected)});
    }
    (void)band_transfer(bands, 1);  // throws for bands that overlap
}

Json transfer_json(const TransferPoints& points) {
    return points.points.color.empty() ? Json() : shading::points_json(points);
}
void set_transfer(const std::string& key, const Json& value, TransferPoints& points) {
    // Names of maps alone: a record names no files but its inputs.
    points = value.is_null()     ? TransferPoints{}
             : value.is_string() ? transfer_points(named_transfer_function(value))
                                 : shading::points_of(value, key + ": ");
}

void set_size(const std::string& key, const Json& value, Request& r) {
    const std::string expected = "pixels: [width, height] from 1, at most 2^28 in all";
    const std::vector<double> size = value.is_number()
                                         ? std::vector(2, number(key, value, expected))
                                         : row(key, value, 2, expected);
    constexpr double kMostPixels = 1 << 28;
    for (const double side : size)
        if (!(side >= 1) || side != std::floor(side)) refuse(key, value, expected);
    if (size[0] * size[1] > kMostPixels) refuse(key, value, expected);
    r.width = static_cast<int>(size[0]), r.height = static_cast<int>(size[1]);
}

std::vector<std::string> words_of_show() {
    const auto words = show_words();
    return {words.begin(), words.end()};
}

constexpr double kMost = std::numeric_limits<double>::max(), kLeast = 5e-324;
constexpr Range kAny{-kMost, kMost, "a number"}, kAbove{kLeast, kMost, "a number above 0"},
    kFromZero{0, kMost, "a number from 0"}, kShare{0, 1, "a number from 0 to 1"};

/// All members, in the order that they are written in.
const std::vector<Member>& members() {
#define VOG_MEMBER(path) \
    [](auto& r) -> auto& { return r.path; }
    static const std::vector<Member> all = {
        choice("show", VOG_MEMBER(show), words_of_show()),
        plain("field", VOG_MEMBER(field)),
        {"tf", [](const Request& r) { return transfer_json(r.transfer.points); },
         [](auto& key, auto& value, Request& r) { set_transfer(key, value, r.transfer.points); }},
        pair("range", VOG_MEMBER(transfer.range), true, "[low, high], the lower value first"),
        choice("scale", VOG_MEMBER(fit), {"auto", "linear", "log", "symmetric"}),
        pair("window", VOG_MEMBER(transfer.window), false, "[centre, width], a width above 0"),
        {"bands", [](const Request& r) { return bands_json(r.transfer.bands); },
         [](auto& key, auto& value, Request& r) { set_bands(key, value, r.transfer.bands); }},
        open("threshold", VOG_MEMBER(transfer.threshold), kAny),
        open("unit_distance", VOG_MEMBER(transfer.unit_distance),
             {kLeast, kMost, "a length above 0, world units"}),
        plain("least_column", VOG_MEMBER(least_column), kShare),
        plain("units", VOG_MEMBER(unit)),
        open("extinction", VOG_MEMBER(extinction), kAbove),
        {"background", [](const Request& r) { return color_json(r.shading.background); },
         [](auto& key, auto& value, Request& r) { r.shading.background = color_of(key, value); }},
        plain("blend", VOG_MEMBER(shading.blend)),
        {"light", [](const Request& r) { return light_json(r.look); },
         [](auto& key, auto& value, Request& r) { set_light(key, value, r.look); }},
        {"light_weights", [](const Request& r) { return weights_json(r.look); },
         [](auto& key, auto& value, Request& r) { set_weights(key, value, r.look); }},
        {"clip", [](const Request& r) { return box_json(r.options.clip); },
         [](auto& key, auto& value, Request& r) { set_box(key, value, r.options.clip); }},
        {"clip_planes", [](const Request& r) { return planes_json(r.options.clip); },
         [](auto& key, auto& value, Request& r) { set_planes(key, value, r.options.clip); }},
        {"camera", [](const Request& r) { return r.camera ? camera_json(*r.camera) : Json(); },
         [](auto& key, auto& value, Request& r) {
             r.camera.reset();
             if (value.is_null()) return;
             if (!value.is_object()) refuse(key, value, "an object with eye and look_at");
             r.camera = camera_of(value, key);
         }},
        {"size",
         [](const Request& r) {
             return Json{r.width, r.height};
         },
         &set_size},
        {"renderer",
         [](const Request& r) { return r.renderer ? Json(info_of(*r.renderer).name) : Json(); },
         [](auto& key, auto& value, Request& r) {
             r.renderer.reset();
             if (value.is_null()) return;
             if (!value.is_string()) refuse(key, value, "a name");
             r.renderer = renderer_named(value.template get<std::string>());
         }},
        open("slabs", VOG_MEMBER(slabs), {1, 1024, "1 to 1024"}),
        plain("aabb_sigma", VOG_MEMBER(options.aabb_sigma), kFromZero),
        plain("kappa", VOG_MEMBER(options.kappa), {0, 0.999, "0, or 1.3e-14 to 0.999"}),
        open("pixel_error", VOG_MEMBER(options.pixel_error), kFromZero),
        choice("anyhit", VOG_MEMBER(options.trace.anyhit), {"accumulate", "collect"}),
        plain("hits_per_slab", VOG_MEMBER(options.trace.hits_per_slab), {1, 256, "1 to 256"}),
        plain("stop_transmittance", VOG_MEMBER(options.trace.stop_transmittance),
              {0, 0.999999, "0 to 0.999999"}),
        choice("interpolation", VOG_MEMBER(options.voxels.interpolation), {"constant", "linear"}),
        plain("step", VOG_MEMBER(options.voxels.step_voxels), kFromZero),
        plain("samples", VOG_MEMBER(options.samples), {1, 64, "1 to 64"}),
        plain("color_bar", VOG_MEMBER(marks.color_bar)),
        plain("axes", VOG_MEMBER(marks.axes)),
        plain("scale_bar", VOG_MEMBER(marks.scale_bar)),
        plain("title", VOG_MEMBER(marks.title)),
    };
#undef VOG_MEMBER
    return all;
}

}  // namespace

std::vector<std::string> request_keys() {
    std::vector<std::string> keys;
    for (const Member& member : members()) keys.push_back(member.key);
    return keys;
}

std::string request_json(const PictureRequest& request) {
    static const Request unset;
    Json json = Json::object();
    for (const Member& member : members()) {
        Json value = member.write(request);
        if (value != member.write(unset)) json[member.key] = std::move(value);
    }
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PictureRequest request_of_json(const std::string& text, const PictureRequest& base) {
    static const Request unset;
    Request request = base;
    Json json;
    try {
        json = Json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw Error("request: " + json_fault(error));
    }
    if (!json.is_object()) throw Error("request: expected a JSON object");
    for (const auto& [key, value] : json.items()) {
        const auto found = std::ranges::find(members(), key, &Member::key);
        if (found == members().end())
            throw RequestError(key, fmt::format(": no member of a request, expected {}",
                                                fmt::join(request_keys(), ", ")));
        try {
            const bool open = value.is_null() || (key == "extinction" && value == "auto");
            found->read(key, open ? found->write(unset) : value, request);
        } catch (const nlohmann::json::exception&) {
            refuse(key, value, "another type");
        }
    }
    return request;
}

}  // namespace vog
