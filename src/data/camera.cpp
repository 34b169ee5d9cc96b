// camera.cpp: image frames of cameras, and views around a box.
#include "vog/camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "vog/error.h"

namespace vog {

namespace {

bool finite(Vec3d v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(Vec3d v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

constexpr int kMaxImagePixels = 1 << 28;  // 16384 x 16384: a gigabyte of T

double radians(double degrees) { return degrees * (std::numbers::pi / 180); }
double degrees(double radians) { return radians * (180 / std::numbers::pi); }

/// Image axes of a camera.
struct ViewAxes {
    Vec3d right, up, forward;
};

/// Axes that azimuth and elevation are measured in: Orbit's A, U and B.
struct OrbitAxes {
    Vec3d a, u, b;
};
OrbitAxes orbit_axes(Vec3d up) {
    const Vec3d u = normalized(up);
    // The shortest rotation from y to u turns v to v + k x v + k x (k x v) / (1 + cos), with
    // k = y x u. At -y its axis is undefined: half a turn about x.
    const double cosine = u.y;
    constexpr double kOpposite = 1e-9;
    if (1 + cosine < kOpposite) return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    const Vec3d k = cross({0, 1, 0}, u);
    const auto turned = [&](Vec3d v) {
        const Vec3d once = cross(k, v);
        return v + once + (1 / (1 + cosine)) * cross(k, once);
    };
    return {turned({1, 0, 0}), u, turned({0, 0, 1})};
}

/// A box without extent (one point), or none, is viewed as a cube of bounding radius 1.
Box shown_box(const Box& box) {
    if (!box.empty() && box.radius() > 0) return box;
    constexpr double kHalf = 0.5773502691896258;  // 1 / sqrt(3)
    const Vec3d center = box.empty() ? Vec3d{} : box.center(), half{kHalf, kHalf, kHalf};
    return {center - half, center + half};
}

/// Calls take(right, up, along) for the components of each corner of a box, relative to a point.
template <class Take>
void for_each_corner(const Box& box, Vec3d from, const ViewAxes& axes, const Take& take) {
    for (int n = 0; n < 8; ++n) {
        const Vec3d corner{n & 1 ? box.upper.x : box.lower.x, n & 2 ? box.upper.y : box.lower.y,
                           n & 4 ? box.upper.z : box.lower.z};
        const Vec3d at = corner - from;
        take(dot(at, axes.right), dot(at, axes.up), dot(at, axes.forward));
    }
}

/// Least distance of a pinhole camera from the box's centre at which the projected corners lie within
/// kFitShare of the image: |across| / depth <= kFitShare * slope of the image's edge.
double fitted_distance(const Box& box, const ViewAxes& axes, double fov_degrees, double aspect) {
    const double slope_y = kFitShare * std::tan(radians(0.5 * fov_degrees));
    const double slope_x = slope_y * aspect;
    constexpr double kOutside = 1.05;  // a needle along the view lies in front of the eye, too
    double distance = 0;
    for_each_corner(box, box.center(), axes, [&](double right, double up, double along) {
        distance = std::max({distance, -kOutside * along, std::abs(right) / slope_x - along,
                             std::abs(up) / slope_y - along});
    });
    return distance;
}

/// Least width of an orthographic image about `center` that holds the projected corners within
/// kFitShare.
double width_about(Vec3d center, const Box& box, const ViewAxes& axes, double aspect) {
    double half = 0;
    for_each_corner(box, center, axes, [&](double right, double up, double) {
        half = std::max({half, std::abs(right), std::abs(up) * aspect});
    });
    return 2 * half / kFitShare;
}

ViewAxes axes_of(const Camera& camera) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    return {frame.right, frame.up, frame.forward};
}

void check(const Orbit& orbit, double aspect) {
    const auto refuse = [](const std::string& what) { throw Error("camera: " + what); };
    if (!std::isfinite(orbit.azimuth_degrees) || !std::isfinite(orbit.roll_degrees))
        refuse("azimuth or roll is not finite");
    if (!(std::abs(orbit.elevation_degrees) <= 90))
        refuse(fmt::format("elevation {} degrees, expected in [-90, 90]", orbit.elevation_degrees));
    if (!(orbit.distance_radii >= 0 && std::isfinite(orbit.distance_radii)))
        refuse(fmt::format("distance {} bounding radii, expected a positive number, 0: fitted",
                           orbit.distance_radii));
    if (!(orbit.fov_degrees > 0 && orbit.fov_degrees < 180))
        refuse(fmt::format("field of view {} degrees, expected in (0, 180)", orbit.fov_degrees));
    if (!finite(orbit.up) || length(orbit.up) == 0)
        refuse(fmt::format("up {}, expected a direction", text(orbit.up)));
    if (!(orbit.width >= 0 && std::isfinite(orbit.width)))
        refuse(fmt::format("width {} world units, expected a positive number, 0: fitted",
                           orbit.width));
    if (!(aspect > 0 && std::isfinite(aspect)))
        refuse(fmt::format("aspect {}, expected width / height of the image", aspect));
}

constexpr std::array kViewNames{"paper", "+x", "-x", "+y", "-y", "+z", "-z"};

}  // namespace

CameraFrame frame_of(const Camera& camera, int width, int height) {
    if (width < 1 || height < 1 || std::int64_t{width} * height > kMaxImagePixels)
        throw Error(fmt::format("image size {}x{}: expected at least 1x1 and at most {} pixels",
                                width, height, kMaxImagePixels));
    if (!finite(camera.eye) || !finite(camera.look_at) || !finite(camera.up))
        throw Error("camera: eye, look_at or up is not finite");
    if (!(camera.orthographic_width >= 0 && std::isfinite(camera.orthographic_width)))
        throw Error(fmt::format(
            "camera: orthographic width {} world units, expected a positive number, 0: a pinhole",
            camera.orthographic_width));
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
    frame.orthographic = camera.orthographic();
    frame.pixels_per_unit = frame.orthographic
                                ? width / camera.orthographic_width
                                : 0.5 * height / std::tan(radians(0.5 * camera.fov_degrees));
    const double pixel = 1 / frame.pixels_per_unit;
    const Vec3d step_x = pixel * frame.right, step_y = -pixel * frame.up;
    const Vec3d to_corner = -0.5 * (width - 1) * step_x - 0.5 * (height - 1) * step_y;
    frame.corner = forward;
    frame.first_origin = camera.eye;
    if (frame.orthographic) {
        frame.first_origin = camera.eye + to_corner;
        frame.shift_x = step_x;
        frame.shift_y = step_y;
    } else {
        frame.corner = forward + to_corner;
        frame.step_x = step_x;
        frame.step_y = step_y;
    }
    return frame;
}

CameraFrame relative_to(CameraFrame frame, Vec3d origin) {
    frame.eye = frame.eye - origin;
    frame.first_origin = frame.first_origin - origin;
    return frame;
}

Camera orbit_view(const Box& box, const Orbit& orbit, double aspect) {
    check(orbit, aspect);
    Camera camera;
    const Box shown = shown_box(box);
    camera.look_at = shown.center();

    // Direction to the eye, and its derivative by the elevation, which is the image's upper edge.
    const OrbitAxes axes = orbit_axes(orbit.up);
    const double az = radians(orbit.azimuth_degrees), el = radians(orbit.elevation_degrees);
    const Vec3d level = std::cos(az) * axes.a + std::sin(az) * axes.b;
    const Vec3d to_eye = std::cos(el) * level + std::sin(el) * axes.u;
    const Vec3d edge = std::cos(el) * axes.u - std::sin(el) * level;
    const double roll = radians(orbit.roll_degrees);
    const Vec3d side = cross(-1.0 * to_eye, edge);
    const Vec3d up = std::cos(roll) * edge + std::sin(roll) * side;
    const ViewAxes view{cross(-1.0 * to_eye, up), up, -1.0 * to_eye};

    constexpr double kStraightAlong = 1e-6;  // cosine of the elevation
    camera.up = orbit.roll_degrees == 0 && std::cos(el) > kStraightAlong ? axes.u : up;
    camera.fov_degrees = orbit.fov_degrees;
    if (orbit.orthographic)
        camera.orthographic_width =
            orbit.width > 0 ? orbit.width : width_about(camera.look_at, shown, view, aspect);
    const double distance = orbit.distance_radii > 0 ? orbit.distance_radii * shown.radius()
                            : orbit.orthographic
                                ? kPaperDistanceRadii * shown.radius()
                                : fitted_distance(shown, view, orbit.fov_degrees, aspect);
    camera.eye = camera.look_at + distance * to_eye;
    return camera;
}

double fitted_width(const Camera& camera, const Box& box, double aspect) {
    return width_about(camera.look_at, shown_box(box), axes_of(camera), aspect);
}

Camera fitted(const Camera& camera, const Box& box, double aspect) {
    const Box shown = shown_box(box);
    const ViewAxes axes = axes_of(camera);
    Camera result = camera;
    result.look_at = shown.center();
    result.up = axes.up;
    double distance = kPaperDistanceRadii * shown.radius();
    if (camera.orthographic())
        result.orthographic_width = width_about(result.look_at, shown, axes, aspect);
    else
        distance = fitted_distance(shown, axes, camera.fov_degrees, aspect);
    result.eye = result.look_at - distance * axes.forward;
    return result;
}

Camera paper_view(const Box& box) {
    Orbit orbit;
    orbit.distance_radii = kPaperDistanceRadii;
    return orbit_view(box, orbit);
}

std::span<const char* const> view_names() { return kViewNames; }

void set_view(Orbit& orbit, const std::string& name) {
    if (std::ranges::find(kViewNames, name) == kViewNames.end())
        throw Error(fmt::format("camera: view '{}', expected one of {}", name,
                                fmt::join(kViewNames, ", ")));
    if (name == "paper") {
        orbit.azimuth_degrees = kPaperAzimuthDegrees;
        orbit.elevation_degrees = kPaperElevationDegrees;
        orbit.distance_radii = kPaperDistanceRadii;
        return;
    }
    Vec3d to_eye;
    to_eye[name[1] - 'x'] = name[0] == '+' ? 1 : -1;
    const OrbitAxes axes = orbit_axes(orbit.up);
    const double along_a = dot(to_eye, axes.a), along_b = dot(to_eye, axes.b);
    const double along_u = dot(to_eye, axes.u), across = std::hypot(along_a, along_b);
    constexpr double kAlong = 1e-9;  // sine of the angle between the view and `up`
    orbit.elevation_degrees = degrees(std::atan2(along_u, across));
    orbit.azimuth_degrees = across > kAlong ? degrees(std::atan2(along_b, along_a)) : 90;
}

}  // namespace vog
