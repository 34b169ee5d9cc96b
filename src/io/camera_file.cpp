// camera_file.cpp: cameras as JSON files.
#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "vog/camera.h"
#include "vog/error.h"

namespace vog {

Camera read_camera(const std::filesystem::path& file) {
    require_readable(file);
    Camera camera;
    bool has_eye = false, has_look_at = false;
    try {
        std::ifstream in(file);
        const auto json = nlohmann::json::parse(in);
        if (!json.is_object())
            throw Error(fmt::format("{}: expected a JSON object", file.string()));
        for (const auto& [key, value] : json.items()) {
            const auto vector = [&, &name = key, &entry = value] {
                if (!entry.is_array() || entry.size() != 3)
                    throw Error(fmt::format("{}: '{}' is {}, expected [x, y, z]", file.string(),
                                            name, entry.dump()));
                return Vec3d{entry[0].get<double>(), entry[1].get<double>(),
                             entry[2].get<double>()};
            };
            if (key == "eye") {
                camera.eye = vector(), has_eye = true;
            } else if (key == "look_at") {
                camera.look_at = vector(), has_look_at = true;
            } else if (key == "up") {
                camera.up = vector();
            } else if (key == "fov_degrees") {
                camera.fov_degrees = value.get<double>();
            } else if (key == "orthographic_width") {
                camera.orthographic_width = value.get<double>();
                if (!(camera.orthographic_width > 0))
                    throw Error(fmt::format("{}: 'orthographic_width' is {}, expected above 0",
                                            file.string(), camera.orthographic_width));
            } else {
                throw Error(
                    fmt::format("{}: unknown key '{}', expected eye, look_at, up, fov_degrees or "
                                "orthographic_width",
                                file.string(), key));
            }
        }
    } catch (const nlohmann::json::exception& error) {
        throw Error(fmt::format("{}: not a camera file: {}", file.string(), json_fault(error)));
    }
    if (!has_eye || !has_look_at)
        throw Error(fmt::format("{}: no key '{}'", file.string(), has_eye ? "look_at" : "eye"));
    frame_of(camera, 1, 1);  // throws if the values make no valid camera
    return camera;
}

void write_camera(const std::filesystem::path& file, const Camera& camera) {
    const auto array = [](Vec3d v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    nlohmann::ordered_json json = {
        {"eye", array(camera.eye)}, {"look_at", array(camera.look_at)}, {"up", array(camera.up)}};
    if (camera.orthographic())
        json["orthographic_width"] = camera.orthographic_width;
    else
        json["fov_degrees"] = camera.fov_degrees;
    write_file(file, [&](std::ofstream& out) { out << json.dump(2) << "\n"; });
}

}  // namespace vog
