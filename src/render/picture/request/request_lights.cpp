// request_lights.cpp: lights in requests: "head", "studio", [1, 2, 1], "camera:0,1,1=0.4", or a list of lights.
#include "render/picture/request/request_member.h"
#include "vog/text.h"

namespace vog::requests {

namespace {

constexpr std::string_view kOfCamera = "camera:";
/// " VALUE: expected ..."
[[noreturn]] void refuse_light(const std::string& key, const Json& value) {
    refuse(key, value,
           fmt::format("{}head, x,y,z or camera:x,y,z, with or without a strength, as in head=0.5",
                       key == "light" ? "studio, " : ""));
}

/// [x, y, z], "head", or a text with what else it has.
Json light_json(const DirectionalLight& light) {
    const auto& [to, of_camera, strength] = light;
    const bool plain = !of_camera && strength == 1, head = to == Vec3d{};
    if (plain) return head ? Json("head") : Json{to.x, to.y, to.z};
    std::string text =
        head ? "head" : fmt::format("{}{},{},{}", of_camera ? kOfCamera : "", to.x, to.y, to.z);
    if (strength != 1) text += fmt::format("={}", strength);
    return text;
}
Json lights_json(const std::vector<DirectionalLight>& lights) {
    if (lights.size() == 1) return light_json(lights.front());
    Json all;
    for (const DirectionalLight& light : lights) all.push_back(light_json(light));
    return all;
}

/// Text of a light: itself, or the parts that commas divide.
std::string text_of(const Json& value) {
    if (!value.is_array()) return value.is_string() ? value.get<std::string>() : value.dump();
    std::string text;
    for (const Json& part : value)
        text +=
            (text.empty() ? "" : ",") + (part.is_string() ? part.get<std::string>() : part.dump());
    return text;
}

DirectionalLight light_of(const std::string& key, const Json& value) {
    const std::string text = text_of(value);
    DirectionalLight light;
    const std::size_t equals = std::min(text.find('='), text.size());
    if (equals < text.size()) {
        const Json strength = words_value(text.substr(equals + 1));
        if (!strength.is_number() || !(strength.get<double>() >= 0))
            refuse(key, value, "a finite strength, 0 or more, as in head=0.5");
        light.strength = strength;
    }
    std::string to = text.substr(0, equals);
    if (to == "head") return light;
    light.of_camera = to.starts_with(kOfCamera);
    if (light.of_camera) to.erase(0, kOfCamera.size());
    const Json numbers = words_value(to);
    if (!numbers.is_array() || numbers.size() != 3) refuse_light(key, value);
    for (int axis = 0; axis < 3; ++axis) {
        const Json& one = numbers[static_cast<std::size_t>(axis)];
        if (!one.is_number()) refuse_light(key, value);
        light.towards[axis] = one;
    }
    const double length2 = dot(light.towards, light.towards);
    if (!(length2 > 0 && std::isfinite(length2)))
        refuse(key, value, "a direction of a length above 0");
    return light;
}

/// A light, or a list of lights: the words of one light, divided by commas, have a number, that of y.
std::vector<DirectionalLight> lights_of(const std::string& key, const Json& value) {
    const bool list =
        value.is_array() && !value.empty() && std::ranges::none_of(value, &Json::is_number);
    if (!list) return {light_of(key, value)};
    if (value.size() > kMostDirectionalLights)
        throw RequestError(key, fmt::format(": {} lights, expected {} at most", value.size(),
                                            kMostDirectionalLights));
    std::vector<DirectionalLight> lights;
    for (const Json& one : value) {
        if (one == "studio") refuse(key, value, "studio alone; `light_from` has its lights");
        lights.push_back(light_of(key, one));
    }
    return lights;
}

void set_light(const std::string& key, const Json& value, VolumeLook& look) {
    const Json& one = value.is_array() && value.size() == 1 ? value.front() : value;
    look.studio = one == "studio", look.lights.clear();
    look.light = !value.is_null() && !look.studio;
    if (look.light && one != "head") look.lights = lights_of(key, one);
}
void set_light_from(const std::string& key, const Json& value, VolumeLook& look) {
    if (value.is_null()) return;
    if (look.light) throw RequestError(key, " has no effect beside `light`, which has a direction");
    look.lights = lights_of(key, value);
}

}  // namespace

Values light_values() {
    return {[](const PictureRequest& r) {
                const VolumeLook& look = r.look;
                if (look.studio) return Json("studio");
                return look.light ? lights_json(vog::lights_of(look)) : Json();
            },
            [](auto& key, auto& value, PictureRequest& r) { set_light(key, value, r.look); }};
}
// Of shadows alone: the lights of surfaces are those of `light`.
Values light_from_values() {
    return {[](const PictureRequest& r) {
                return r.look.light || r.look.lights.empty() ? Json() : lights_json(r.look.lights);
            },
            [](auto& key, auto& value, PictureRequest& r) { set_light_from(key, value, r.look); }};
}
Values clip_lights_values() {
    return {[](const PictureRequest& r) { return Json(r.look.clip_lights); },
            [](auto& key, auto& value, PictureRequest& r) {
                if (value != true && value != false && value != 0 && value != 1)
                    refuse(key, value, "0 or 1, false or true");
                r.look.clip_lights = value == true || value == 1;
            }};
}

}  // namespace vog::requests
