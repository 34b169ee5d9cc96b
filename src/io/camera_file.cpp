// camera_file.cpp: cameras as JSON files.
#include <fmt/core.h>

#include <fstream>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "io/camera_json.h"
#include "vog/error.h"

namespace vog {

Camera camera_of(const nlohmann::ordered_json& json, const std::string& where) try {
    Camera camera;
    if (!json.is_object()) throw Error(where + ": expected a JSON object");
    for (const auto& [key, value] : json.items()) {
        const auto vector = [&, &name = key, &entry = value] {
            if (!entry.is_array() || entry.size() != 3)
                throw Error(
                    fmt::format("{}: '{}' is {}, expected [x, y, z]", where, name, entry.dump()));
            return Vec3d{entry[0].get<double>(), entry[1].get<double>(), entry[2].get<double>()};
        };
        if (key == "eye") {
            camera.eye = vector();
        } else if (key == "look_at") {
            camera.look_at = vector();
        } else if (key == "up") {
            camera.up = vector();
        } else if (key == "fov_degrees") {
            camera.fov_degrees = value.get<double>();
        } else if (key == "orthographic_width") {
            camera.orthographic_width = value.get<double>();
            if (!(camera.orthographic_width > 0))
                throw Error(fmt::format("{}: 'orthographic_width' is {}, expected above 0", where,
                                        camera.orthographic_width));
        } else {
            throw Error(
                fmt::format("{}: unknown key '{}', expected eye, look_at, up, fov_degrees or "
                            "orthographic_width",
                            where, key));
        }
    }
    if (json.contains("fov_degrees") && json.contains("orthographic_width"))
        throw Error(where + ": fov_degrees and orthographic_width, expected one of them");
    for (const char* key : {"eye", "look_at"})
        if (!json.contains(key)) throw Error(fmt::format("{}: no key '{}'", where, key));
    frame_of(camera, 1, 1);  // throws if the values make no valid camera
    return camera;
} catch (const nlohmann::json::exception& error) {
    throw Error(fmt::format("{}: not a camera file: {}", where, json_fault(error)));
}

nlohmann::ordered_json camera_json(const Camera& camera) {
    const auto array = [](Vec3d v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    nlohmann::ordered_json json = {
        {"eye", array(camera.eye)}, {"look_at", array(camera.look_at)}, {"up", array(camera.up)}};
    if (camera.orthographic())
        json["orthographic_width"] = camera.orthographic_width;
    else
        json["fov_degrees"] = camera.fov_degrees;
    return json;
}

Camera read_camera(const std::filesystem::path& file) {
    require_readable(file);
    nlohmann::ordered_json json;
    try {
        std::ifstream in(file);
        json = nlohmann::ordered_json::parse(in);
    } catch (const nlohmann::json::exception& error) {
        throw Error(fmt::format("{}: not a camera file: {}", file.string(), json_fault(error)));
    }
    // The report of `vog render --json`.
    if (json.is_object() && json.contains("camera")) json = nlohmann::ordered_json(json["camera"]);
    return camera_of(json, file.string());
}

void write_camera(const std::filesystem::path& file, const Camera& camera) {
    write_file(file, [&](std::ofstream& out) { out << camera_json(camera).dump(2) << "\n"; });
}

}  // namespace vog
