// camera.cpp: camera frames, the named views, camera files.
#include "vog/camera.h"

#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/atomic_file.h"
#include "vog/error.h"

namespace vog {

namespace {

bool finite(Vec3d v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(Vec3d v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

constexpr int kMaxImagePixels = 1 << 28;  // 16384 x 16384: a gigabyte of T

}  // namespace

CameraFrame frame_of(const Camera& camera, int width, int height) {
    if (width < 1 || height < 1 || std::int64_t{width} * height > kMaxImagePixels)
        throw Error(fmt::format("image size {}x{}: expected at least 1x1 and at most {} pixels",
                                width, height, kMaxImagePixels));
    if (!finite(camera.eye) || !finite(camera.look_at) || !finite(camera.up))
        throw Error("camera: eye, look_at or up is not finite");
    if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180))
        throw Error(fmt::format("camera: field of view {} degrees, expected in (0, 180)",
                                camera.fov_degrees));
    const Vec3d view = camera.look_at - camera.eye;
    if (length(view) == 0)
        throw Error(fmt::format("camera: eye and look_at are both {}", text(camera.eye)));
    const Vec3d forward = normalized(view);
    const Vec3d side = cross(forward, camera.up);
    constexpr double kParallel = 1e-9;  // sine of the angle between up and the view
    if (length(side) <= kParallel * length(camera.up))
        throw Error(fmt::format("camera: up {} is zero or parallel to the view {}", text(camera.up),
                                text(forward)));

    CameraFrame frame;
    frame.width = width;
    frame.height = height;
    frame.eye = camera.eye;
    frame.forward = forward;
    frame.right = normalized(side);
    frame.up = cross(frame.right, forward);
    const double half_tangent = std::tan(camera.fov_degrees * std::numbers::pi / 360);
    frame.pixels_per_unit = 0.5 * height / half_tangent;
    const double pixel = 1 / frame.pixels_per_unit;
    frame.step_x = pixel * frame.right;
    frame.step_y = -pixel * frame.up;
    frame.corner = forward - 0.5 * (width - 1) * frame.step_x - 0.5 * (height - 1) * frame.step_y;
    return frame;
}

Camera orbit_view(const Box& box, double azimuth_rad, double elevation_rad, double distance_radii,
                  double fov_degrees) {
    Camera camera;
    camera.look_at = box.empty() ? Vec3d{} : box.center();
    // A box without extent (one point) still gets a view: of its unit neighbourhood.
    const double radius = box.empty() || box.radius() == 0 ? 1 : box.radius();
    const double flat = std::cos(elevation_rad);
    camera.eye = camera.look_at + distance_radii * radius *
                                      Vec3d{flat * std::cos(azimuth_rad), std::sin(elevation_rad),
                                            flat * std::sin(azimuth_rad)};
    camera.fov_degrees = fov_degrees;
    // Straight down or up, y cannot be the image's up: x takes its place.
    if (std::abs(flat) < 1e-6) camera.up = {1, 0, 0};
    return camera;
}

Camera paper_view(const Box& box) {
    return orbit_view(box, kPaperAzimuthRad, kPaperElevationRad, kPaperDistanceRadii,
                      kPaperFovDegrees);
}

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
            } else {
                throw Error(
                    fmt::format("{}: unknown key '{}', expected eye, look_at, up or fov_degrees",
                                file.string(), key));
            }
        }
    } catch (const nlohmann::json::exception& error) {
        throw Error(fmt::format("{}: not a camera file: {}", file.string(), error.what()));
    }
    if (!has_eye || !has_look_at)
        throw Error(fmt::format("{}: no key '{}'", file.string(), has_eye ? "look_at" : "eye"));
    frame_of(camera, 1, 1);  // throws where the numbers make no camera
    return camera;
}

void write_camera(const std::filesystem::path& file, const Camera& camera) {
    const auto array = [](Vec3d v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    const nlohmann::ordered_json json = {{"eye", array(camera.eye)},
                                         {"look_at", array(camera.look_at)},
                                         {"up", array(camera.up)},
                                         {"fov_degrees", camera.fov_degrees}};
    write_beside_and_rename(file, [&](const std::filesystem::path& beside) {
        std::ofstream out(beside);
        out << json.dump(2) << "\n";
        if (!out.flush()) throw Error(fmt::format("{}: cannot write", file.string()));
    });
}

}  // namespace vog
