// trackball.cpp: rotations and translations of the camera.
#include "ui/trackball.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vog/error.h"

namespace vog::viewer {

namespace {

struct Axes {
    Vec3d right, up, forward;
};
Axes axes_of(const Camera& camera) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    return {frame.right, frame.up, frame.forward};
}

double half_tangent(const Camera& camera) {
    return std::tan(camera.fov_degrees * std::numbers::pi / 360);
}
double distance_of(const Camera& camera) { return length(camera.look_at - camera.eye); }

/// Half the height of the picture at look_at, world units.
/// aspect  width / height of the picture
double half_height(const Camera& camera, double aspect) {
    return camera.orthographic() ? 0.5 * camera.orthographic_width / aspect
                                 : distance_of(camera) * half_tangent(camera);
}

/// Rotation by Rodrigues' formula; axis of unit length, angle in radians.
Vec3d turned(Vec3d v, Vec3d axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
}

/// Rotates eye and up about look_at.
Camera turned_around(const Camera& camera, Vec3d axis, double angle) {
    Camera result = camera;
    result.eye = camera.look_at + turned(camera.eye - camera.look_at, axis, angle);
    result.up = normalized(turned(axes_of(camera).up, axis, angle));
    return result;
}

/// Direction to the trackball's surface under the pointer, in camera axes (right, up, backward).
Vec3d on_ball(ScreenPoint p) {
    constexpr double kRadius = 0.8;  // of half the picture's height
    const double r2 = p.x * p.x + p.y * p.y, inner = 0.5 * kRadius * kRadius;
    const double z = r2 < inner ? std::sqrt(kRadius * kRadius - r2) : inner / std::sqrt(r2);
    return normalized(Vec3d{p.x, p.y, z});
}

}  // namespace

Camera rotated(const Camera& camera, ScreenPoint from, ScreenPoint to) {
    const Vec3d a = on_ball(from), b = on_ball(to), across = cross(a, b);
    const double sine = length(across);
    if (sine < 1e-12) return camera;
    const Axes axes = axes_of(camera);
    const Vec3d axis =
        normalized(across.x * axes.right + across.y * axes.up - across.z * axes.forward);
    // The ball turns with the pointer, hence the camera in the opposite sense; twice the angle, as
    // in Shoemake's arcball: half a turn from rim to rim.
    return turned_around(camera, axis, -2 * std::atan2(sine, dot(a, b)));
}

Camera orbited(const Camera& camera, double right_rad, double up_rad) {
    const Camera aside = turned_around(camera, axes_of(camera).up, right_rad);
    return turned_around(aside, axes_of(aside).right, -up_rad);
}

Camera turned_about(const Camera& camera, Vec3d axis, double angle_rad) {
    return turned_around(camera, normalized(axis), angle_rad);
}

Camera looked_around(const Camera& camera, double right_rad, double up_rad) {
    const Axes axes = axes_of(camera);
    Camera result = camera;
    Vec3d view = turned(camera.look_at - camera.eye, axes.up, -right_rad);
    const Vec3d right = turned(axes.right, axes.up, -right_rad);
    view = turned(view, right, up_rad);
    result.look_at = camera.eye + view;
    result.up = normalized(turned(axes.up, right, up_rad));
    return result;
}

Camera rolled(const Camera& camera, double angle_rad) {
    const Axes axes = axes_of(camera);
    Camera result = camera;
    // The picture turns clockwise when the camera turns counterclockwise.
    result.up = normalized(turned(axes.up, axes.forward, -angle_rad));
    return result;
}

Camera panned(const Camera& camera, ScreenPoint from, ScreenPoint to, double aspect) {
    const double scale = half_height(camera, aspect);
    return flown(camera, (from.x - to.x) * scale, (from.y - to.y) * scale, 0);
}

Camera zoomed(const Camera& camera, ScreenPoint at, double factor, double least_distance,
              double aspect) {
    const Axes axes = axes_of(camera);
    if (camera.orthographic()) {
        const double shift = (1 - factor) * half_height(camera, aspect);
        Camera result = flown(camera, at.x * shift, at.y * shift, 0);
        result.orthographic_width *= factor;
        return result;
    }
    const double distance = std::max(distance_of(camera), least_distance);
    const double slope = half_tangent(camera);
    const Vec3d target = camera.eye + distance * (axes.forward + (at.x * slope) * axes.right +
                                                  (at.y * slope) * axes.up);
    Camera result = camera;
    result.up = axes.up;
    result.eye = target + factor * (camera.eye - target);
    result.look_at = result.eye + std::max(distance * factor, least_distance) * axes.forward;
    return result;
}

Camera flown(const Camera& camera, double right, double up, double forward) {
    const Axes axes = axes_of(camera);
    const Vec3d step = right * axes.right + up * axes.up + forward * axes.forward;
    Camera result = camera;
    result.eye = camera.eye + step;
    result.look_at = camera.look_at + step;
    return result;
}

Camera named_view(const Camera& camera, const std::string& name, const Subject& subject,
                  double aspect, Vec3d up) {
    Orbit orbit;
    orbit.fov_degrees = camera.fov_degrees;
    orbit.up = up;
    orbit.orthographic = camera.orthographic();
    set_view(orbit, name);
    return orbit_view(name == "paper" ? Subject(subject.box) : subject, orbit, aspect);
}

Camera with_projection(const Camera& camera, bool orthographic, double aspect) {
    if (camera.orthographic() == orthographic) return camera;
    Camera result = camera;
    if (orthographic) {
        result.orthographic_width = 2 * distance_of(camera) * half_tangent(camera) * aspect;
    } else {
        const double distance = camera.orthographic_width / (2 * half_tangent(camera) * aspect);
        result.eye = camera.look_at - distance * axes_of(camera).forward;
        result.orthographic_width = 0;
    }
    return result;
}

ScreenPoint light_place(const DirectionalLight& light, const Camera& camera) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    Vec3d to = light.towards;
    if (!light.of_camera) to = {dot(to, frame.right), dot(to, frame.up), -dot(to, frame.forward)};
    const double across = std::hypot(to.x, to.y);
    if (!(across > 0)) return {0, to.z < 0 ? kLightRim : 0};
    const double away = kLightRim * std::atan2(across, to.z) / (std::numbers::pi * across);
    return {away * to.x, away * to.y};
}

DirectionalLight dragged(DirectionalLight light, const Camera& camera, ScreenPoint by) {
    const ScreenPoint from = light_place(light, camera);
    const double x = from.x + by.x, y = from.y + by.y, away = std::hypot(x, y);
    const double angle = std::numbers::pi * std::min(away / kLightRim, 1.0);
    const double per = away > 0 ? std::sin(angle) / away : 0;
    light.towards = {per * x, per * y, std::cos(angle)};
    if (light.of_camera) return light;
    VolumeLook look;
    look.lights = {{light.towards, true, light.strength}};
    return lights_in_view(look, frame_of(camera, 1, 1)).lights.front();
}

}  // namespace vog::viewer
