// camera.cpp: image frames of pinhole cameras, and the orbit and paper views.
#include "vog/camera.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

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
    // A box without extent (one point) is viewed as if its radius were 1.
    const double radius = box.empty() || box.radius() == 0 ? 1 : box.radius();
    const double flat = std::cos(elevation_rad);
    camera.eye = camera.look_at + distance_radii * radius *
                                      Vec3d{flat * std::cos(azimuth_rad), std::sin(elevation_rad),
                                            flat * std::sin(azimuth_rad)};
    camera.fov_degrees = fov_degrees;
    // Looking straight up or down, y is parallel to the view: x is the image's up axis instead.
    if (std::abs(flat) < 1e-6) camera.up = {1, 0, 0};
    return camera;
}

Camera paper_view(const Box& box) {
    return orbit_view(box, kPaperAzimuthRad, kPaperElevationRad, kPaperDistanceRadii,
                      kPaperFovDegrees);
}

}  // namespace vog
