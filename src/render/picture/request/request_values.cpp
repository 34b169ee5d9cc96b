// request_values.cpp: members of requests that are no single number or word: colours, clips, bands.
#include <fmt/core.h>

#include <array>
#include <charconv>

#include "io/camera_json.h"
#include "render/picture/request/request_member.h"
#include "shade/transfer_json.h"
#include "vog/text.h"

namespace vog::requests {

namespace {

using Request = PictureRequest;

struct NamedColor {
    const char* name;
    std::array<float, 3> rgb;
};
constexpr NamedColor kColors[] = {{"black", {0, 0, 0}},         {"white", {1, 1, 1}},
                                  {"gray", {0.5f, 0.5f, 0.5f}}, {"silver", {.75f, .75f, .75f}},
                                  {"red", {1, 0, 0}},           {"green", {0, 0.5f, 0}},
                                  {"lime", {0, 1, 0}},          {"blue", {0, 0, 1}},
                                  {"navy", {0, 0, 0.5f}},       {"yellow", {1, 1, 0}},
                                  {"orange", {1, 0.647f, 0}},   {"brown", {0.647f, 0.165f, 0.165f}},
                                  {"cyan", {0, 1, 1}},          {"magenta", {1, 0, 1}},
                                  {"purple", {0.5f, 0, 0.5f}},  {"pink", {1, 0.753f, 0.796f}},
                                  {"ivory", {1, 1, 0.941f}},    {"tan", {0.824f, 0.706f, 0.549f}}};

}  // namespace

std::array<float, 3> rgb_of(const std::string& key, const Json& value) {
    if (!value.is_string()) {
        const std::vector<double> c = row(key, value, 3, "a colour r,g,b");
        if (std::ranges::any_of(c, [](double part) { return !(part >= 0 && part <= 1); }))
            refuse(key, value, "a colour r,g,b, each 0 to 1");
        return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
    }
    const std::string text = value;
    for (const NamedColor& color : kColors)
        if (text == color.name) return color.rgb;
    if (text.size() != 7 || text[0] != '#' ||
        text.find_first_not_of("0123456789abcdefABCDEF", 1) != text.npos)
        refuse(key, value, "a colour, #rrggbb or one of " + color_names());
    const auto part = [&](std::size_t at) {
        return static_cast<float>(std::stoi(text.substr(at, 2), nullptr, 16)) / 255;
    };
    return {part(1), part(3), part(5)};
}

namespace {

Json bands_json(const std::vector<ValueBand>& bands) {
    Json rows;
    for (const ValueBand& band : bands)
        rows.push_back({band.lower,
                        std::isfinite(band.upper) ? Json(band.upper) : Json(),
                        {band.r, band.g, band.b},
                        band.opacity});
    return rows;
}
/// Sorted bands; one without an upper end ends where the next one begins. A surface without a colour is ivory.
void set_bands(const std::string& key, const Json& value, std::vector<ValueBand>& bands) {
    const std::string expected =
        "lower, upper, colour and opacity of a band, or the value of a surface and, if not ivory, "
        "its colour";
    bands.clear();
    if (value.is_null()) return;
    if (!value.is_array() || value.empty()) refuse(key, value, expected);
    for (const Json& given : value) {
        const Json one = given.is_number() ? Json{given, "ivory"} : given;
        if (!one.is_array() || (one.size() != 2 && one.size() != 4)) refuse(key, one, expected);
        const bool surface = one.size() == 2;
        ValueBand band;
        band.lower = number(key, one[0], "a number as value");
        band.upper = surface || one[1].is_null() ? std::numeric_limits<double>::infinity()
                                                 : number(key, one[1], "a number as value");
        const auto color = rgb_of(key, one[surface ? 1 : 2]);
        band.r = color[0], band.g = color[1], band.b = color[2];
        band.opacity = surface ? kMostOpacity : number(key, one[3], "a number as opacity");
        bands.push_back(band);
    }
    std::ranges::stable_sort(bands, {}, &ValueBand::lower);
    for (std::size_t n = 0; n + 1 < bands.size(); ++n)
        if (std::isinf(bands[n].upper)) bands[n].upper = bands[n + 1].lower;
    (void)band_transfer(bands, 1);  // throws for bands that overlap, and opacities beyond 1
}

Json gradient_json(const TransferRequest& transfer) {
    Json rows;
    for (const auto& [magnitude, factor] : transfer.gradient)
        rows.push_back({transfer.gradient_of_steepest ? Json(fmt::format("{}%", 100 * magnitude))
                                                      : Json(magnitude),
                        factor});
    return rows;
}
/// Pairs of numbers, or words "40:1"; magnitudes may be percentages, "20%".
void set_gradient(const std::string& key, const Json& value, TransferRequest& transfer) {
    const std::string expected =
        "MAGNITUDE:FACTOR, at least two, of ascending magnitudes from 0, all or none of them "
        "percentages, and factors from 0 to 1";
    std::vector<GradientOpacity>& points = transfer.gradient;
    points.clear(), transfer.gradient_of_steepest = false;
    if (value.is_null()) return;
    if (!value.is_array()) refuse(key, value, expected);
    for (const Json& one : value) {
        Json pair = one;
        if (one.is_string()) {
            const std::string text = one;
            const std::size_t colon = std::min(text.find(':'), text.size() - 1);
            pair = {words_value(text.substr(0, colon)), words_value(text.substr(colon + 1))};
        }
        bool share = false;
        if (pair.is_array() && !pair.empty() && pair[0].is_string()) {
            std::string text = pair[0];
            share = text.ends_with('%');
            if (share) text.pop_back();
            pair[0] = words_value(text);
        }
        const std::vector<double> two = row(key, pair, 2, expected);
        if (!points.empty() && share != transfer.gradient_of_steepest) refuse(key, value, expected);
        transfer.gradient_of_steepest = share;
        points.push_back({share ? two[0] / 100 : two[0], two[1]});
    }
    try {
        validate(points);
    } catch (const Error&) {
        refuse(key, value, expected);
    }
}

Json color_json(const Rgba& c) {
    if (c == Rgba{0, 0, 0, 1}) return "black";
    if (c == Rgba{1, 1, 1, 1}) return "white";
    if (c.a == 0) return "transparent";
    return {c.r, c.g, c.b, c.a};
}
Rgba color_of(const std::string& key, const Json& value) {
    const std::string expected = "black, white, transparent or r,g,b, each 0 to 1";
    for (const char* name : {"black", "white", "transparent"})
        if (value == name) return named_background(name);
    if (value.is_string() && value.get<std::string>().find(',') != std::string::npos)
        return color_of(key, words_value(value.get<std::string>()));
    std::vector<double> c =
        row(key, value, value.is_array() && value.size() == 4 ? 4 : 3, expected);
    if (std::ranges::any_of(c, [](double part) { return !(part >= 0 && part <= 1); }))
        refuse(key, value, expected);
    c.resize(4, 1);
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
            static_cast<float>(c[3])};
}

Json weights_json(const VolumeLook& look) {
    return {look.ambient, look.diffuse, look.specular, look.power};
}
void set_weights(const std::string& key, const Json& value, VolumeLook& look) {
    const std::vector<double> w =
        row(key, value, 4, "four numbers: ambient, diffuse, specular and power");
    look.ambient = w[0], look.diffuse = w[1], look.specular = w[2], look.power = w[3];
    validate(look);
}

Json box_json(const Clipping& clip) {
    if (!clip.box) return {};
    const auto [l, u] = std::pair{clip.box->lower, clip.box->upper};
    return {{l.x, l.y, l.z}, {u.x, u.y, u.z}};
}
void set_box(const std::string& key, const Json& value, Clipping& clip) {
    const std::string expected = "x0,y0,z0,x1,y1,z1, the lower corner first";
    clip.box.reset();
    if (value.is_null()) return;
    std::vector<double> c;
    if (value.is_array() && value.size() == 2 && value[0].is_array()) {
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
    const std::string expected = "nx,ny,nz,d of each plane";
    clip.planes.clear();
    if (value.is_null()) return;
    if (!value.is_array()) refuse(key, value, expected);
    for (const Json& one : value) {
        const std::vector<double> p = row(key, one, 4, expected);
        clip.planes.push_back({{p[0], p[1], p[2]}, p[3]});
    }
    validate(clip);
}

/// "z", "z=0.5", or [nx, ny, nz, d].
Json plane_json(const SlicePlane& plane) {
    if (plane.axis.empty())
        return {plane.normal.x, plane.normal.y, plane.normal.z, plane.offset.value_or(0)};
    return plane.offset ? fmt::format("{}={}", plane.axis, *plane.offset) : plane.axis;
}
SlicePlane plane_of(const std::string& key, const Json& value) {
    const std::string expected = fmt::format(
        "{} with or without a position, as in z=0.5, or NX,NY,NZ,D with a normal that is not 0",
        fmt::join(slice_axes(), ", "));
    SlicePlane plane;
    if (value.is_string() && value.get<std::string>().find(',') != std::string::npos) {
        const Json numbers = Json::parse("[" + value.get<std::string>() + "]", nullptr, false);
        if (!numbers.is_discarded()) return plane_of(key, numbers);
        refuse(key, value, expected);
    }
    if (value.is_string()) {
        const std::string text = value;
        const std::size_t equals = std::min(text.find('='), text.size());
        plane.axis = text.substr(0, equals);
        if (std::ranges::count(slice_axes(), plane.axis) == 0) refuse(key, value, expected);
        if (equals == text.size()) return plane;
        double offset = 0;
        const char* end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data() + equals + 1, end, offset);
        if (error != std::errc{} || rest != end || !std::isfinite(offset))
            refuse(key, value, expected);
        plane.offset = offset;
        return plane;
    }
    const std::vector<double> p = row(key, value, 4, expected);
    plane.normal = {p[0], p[1], p[2]}, plane.offset = p[3];
    if (!(length(plane.normal) > 0)) refuse(key, value, expected);
    return plane;
}

Json transfer_json(const TransferPoints& points) {
    return points.points.color.empty() ? Json() : shading::points_json(points);
}
/// Names of maps alone: a record names no files but its inputs.
void set_transfer(const std::string& key, const Json& value, TransferPoints& points) {
    points = value.is_null()     ? TransferPoints{}
             : value.is_string() ? transfer_points(named_transfer_function(value))
                                 : shading::points_of(value, key + ": ");
}

/// [width, height], one number for a square, or "640x480".
void set_size(const std::string& key, const Json& value, Request& r) {
    const std::string expected =
        "pixels, 640x480 or one number for a square, from 1, at most 2^28 in all";
    constexpr double kMostPixels = 1 << 28;
    Json sides = value.is_number() ? Json{value, value} : value;
    if (value.is_string()) {
        const std::string text = value;
        const std::size_t x = text.find('x');
        const Json parsed = Json::parse(
            "[" + text.substr(0, x) + "," + (x == text.npos ? "" : text.substr(x + 1)) + "]",
            nullptr, false);
        if (!parsed.is_discarded()) sides = parsed;
    }
    if (!sides.is_array()) refuse(key, value, expected);
    const std::vector<double> size = row(key, sides, 2, expected);
    for (const double side : size)
        if (!(side >= 1) || side != std::floor(side)) refuse(key, value, expected);
    if (size[0] * size[1] > kMostPixels) refuse(key, value, expected);
    r.width = static_cast<int>(size[0]), r.height = static_cast<int>(size[1]);
}

}  // namespace

std::string color_names() {
    std::vector<std::string> names;
    for (const NamedColor& color : kColors) names.emplace_back(color.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

Values transfer_values() {
    return {
        [](const Request& r) { return transfer_json(r.transfer.points); },
        [](auto& key, auto& value, Request& r) { set_transfer(key, value, r.transfer.points); }};
}
Values bands_values() {
    return {[](const Request& r) { return bands_json(r.transfer.bands); },
            [](auto& key, auto& value, Request& r) { set_bands(key, value, r.transfer.bands); }};
}
Values gradient_values() {
    return {[](const Request& r) { return gradient_json(r.transfer); },
            [](auto& key, auto& value, Request& r) { set_gradient(key, value, r.transfer); }};
}
Values background_values() {
    return {
        [](const Request& r) { return color_json(r.shading.background); },
        [](auto& key, auto& value, Request& r) { r.shading.background = color_of(key, value); }};
}
Values weights_values() {
    return {[](const Request& r) { return weights_json(r.look); },
            [](auto& key, auto& value, Request& r) { set_weights(key, value, r.look); }};
}
Values box_values() {
    return {[](const Request& r) { return box_json(r.options.clip); },
            [](auto& key, auto& value, Request& r) { set_box(key, value, r.options.clip); }};
}
Values planes_values() {
    return {[](const Request& r) { return planes_json(r.options.clip); },
            [](auto& key, auto& value, Request& r) { set_planes(key, value, r.options.clip); }};
}
Values plane_values() {
    return {[](const Request& r) { return r.plane ? plane_json(*r.plane) : Json(); },
            [](auto& key, auto& value, Request& r) {
                r.plane.reset();
                if (!value.is_null()) r.plane = plane_of(key, value);
            }};
}
Values size_values() {
    return {[](const Request& r) { return Json{r.width, r.height}; }, &set_size};
}
Values renderer_values() {
    return {[](const Request& r) { return r.renderer ? Json(info_of(*r.renderer).name) : Json(); },
            [](auto& key, auto& value, Request& r) {
                r.renderer.reset();
                if (value.is_null()) return;
                if (!value.is_string()) refuse(key, value, "a name");
                r.renderer = renderer_named(value.template get<std::string>());
            }};
}
Values camera_values() {
    return {[](const Request& r) { return r.camera ? camera_json(*r.camera) : Json(); },
            [](auto& key, auto& value, Request& r) {
                r.camera.reset();
                if (value.is_null()) return;
                if (!value.is_object()) refuse(key, value, "an object with eye and look_at");
                r.camera = camera_of(value, key);
            }};
}

}  // namespace vog::requests
