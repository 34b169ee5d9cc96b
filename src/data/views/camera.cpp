// camera.cpp: image frames of cameras, and views around a box.
#include "vog/camera.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "vog/error.h"

namespace vog {

namespace {

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
    const Vec3d u = up == Vec3d{} ? Vec3d{0, 1, 0} : normalized(up);
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

/// A subject without extent (one point), or none, is viewed as a cube of bounding radius 1.
Subject shown_subject(const Subject& subject) {
    const Box& box = subject.box;
    if (!box.empty() && box.radius() > 0) return subject;
    constexpr double kHalf = 0.5773502691896258;  // 1 / sqrt(3)
    const Vec3d center = box.empty() ? Vec3d{} : box.center(), half{kHalf, kHalf, kHalf};
    return Box{center - half, center + half};
}

/// Middle of the hull along axes.
Vec3d middle_of(const Subject& subject, const ViewAxes& axes) {
    Box along;
    for (const Vec3d& at : subject.content.hull)
        along.include(Vec3d{dot(at, axes.right), dot(at, axes.up), dot(at, axes.forward)});
    const Vec3d middle = along.center();
    return middle.x * axes.right + middle.y * axes.up + middle.z * axes.forward;
}

/// Point in the middle of an image that the hull fits, and distance of the eye from it or width of the image.
struct Fit {
    Vec3d target;
    double distance = 0, width = 0;  ///< of a pinhole camera; of an orthographic one
};
/// A point `at` of the hull, relative to the target, lies within the image if
///   |right - r| <= slope (along + distance),  r: place of the view's axis,
/// and likewise upwards: both sides give the least distance and the r at which it is reached.
/// about  target; none: the one that centres the hull, of a box alone its centre
Fit fit(const Subject& subject, const ViewAxes& axes, const Camera& lens, double aspect,
        std::optional<Vec3d> about = {}) {
    if (!about && subject.content.hull == Subject(subject.box).content.hull)
        about = subject.box.center();
    const double slope_y = kFitShare * std::tan(radians(0.5 * lens.fov_degrees));
    constexpr double kOutside = 1.05;  // a needle along the view lies in front of the eye, too
    Fit fit{about.value_or(middle_of(subject, axes))};
    double shift[2] = {}, half[2] = {};
    for (const int n : {0, 1}) {
        const Vec3d across = n == 0 ? axes.right : axes.up;
        const double slope = n == 0 ? slope_y * aspect : slope_y;
        double low = -std::numeric_limits<double>::infinity(), high = low;
        for (const Vec3d& point : subject.content.hull) {
            const Vec3d at = point - fit.target;
            const double along = dot(at, axes.forward);
            high = std::max(high, dot(at, across) - slope * along);
            low = std::max(low, -dot(at, across) - slope * along);
            half[n] = std::max(half[n], std::abs(dot(at, across)));
            fit.distance = std::max(fit.distance, -kOutside * along);
        }
        if (!about) shift[n] = 0.5 * (high - low);
        fit.distance =
            std::max({fit.distance, (high - shift[n]) / slope, (low + shift[n]) / slope});
    }
    fit.width = 2 * std::max(half[0], half[1] * aspect) / kFitShare;
    if (lens.orthographic() || about) return fit;
    // From this distance the axis that does not limit is centred by steps, which shrink by the hull's depth.
    constexpr int kSteps = 24;
    for (int step = 0; step < kSteps; ++step) {
        const Vec3d target = fit.target + shift[0] * axes.right + shift[1] * axes.up;
        Box image;
        double nearest = fit.distance;
        for (const Vec3d& point : subject.content.hull) {
            const Vec3d at = point - target;
            const double depth = dot(at, axes.forward) + fit.distance;
            nearest = std::min(nearest, depth);
            image.include(Vec3d{dot(at, axes.right) / depth, dot(at, axes.up) / depth, 0});
        }
        const Vec3d middle = image.center();
        // As far as brings the nearest point there: no step goes beyond, however wide the view.
        shift[0] += middle.x * nearest, shift[1] += middle.y * nearest;
    }
    fit.target = fit.target + shift[0] * axes.right + shift[1] * axes.up;
    return fit;
}

ViewAxes axes_of(const Camera& camera) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    return {frame.right, frame.up, frame.forward};
}

/// Sets azimuth and elevation to those of a direction to the eye.
void look_from(Orbit& orbit, Vec3d to_eye) {
    const OrbitAxes axes = orbit_axes(orbit.up);
    const double along_a = dot(to_eye, axes.a), along_b = dot(to_eye, axes.b);
    const double along_u = dot(to_eye, axes.u), across = std::hypot(along_a, along_b);
    constexpr double kAlong = 1e-9;  // sine of the angle between the view and `up`
    orbit.elevation_degrees = degrees(std::atan2(along_u, across));
    orbit.azimuth_degrees = across > kAlong ? degrees(std::atan2(along_b, along_a)) : 90;
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
    if (!finite(orbit.up)) refuse(fmt::format("up {}, expected a direction", text(orbit.up)));
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

Subject::Subject(const Box& of) : box(of) {
    if (of.empty()) return;
    for (int n = 0; n < 8; ++n)
        content.hull.push_back({n & 1 ? of.upper.x : of.lower.x, n & 2 ? of.upper.y : of.lower.y,
                                n & 4 ? of.upper.z : of.lower.z});
}

void Subject::include(const Subject& other) {
    // Data without voxels have their box among those of the others.
    Box outline;
    for (const Subject* one : {static_cast<const Subject*>(this), &other})
        outline.include(one->content.voxels.empty() ? one->box : one->content.voxels);
    const bool have_voxels = !content.voxels.empty() || !other.content.voxels.empty();
    box.include(other.box);
    if (content.hull.empty())
        content = other.content;
    else if (!other.content.hull.empty())
        content.include(other.content);
    if (have_voxels) content.voxels = outline;
}

Vec3d up_of(const Orbit& orbit, const Subject& subject) {
    if (orbit.up != Vec3d{}) return orbit.up;
    return subject.content.standing.known() ? subject.content.standing.up : Vec3d{0, 1, 0};
}

Orbit first_orbit(const Subject& subject) {
    Orbit orbit;
    orbit.up = up_of(orbit, subject);
    if (subject.content.standing.front != Vec3d{}) look_from(orbit, subject.content.standing.front);
    return orbit;
}

Camera orbit_view(const Subject& subject, const Orbit& orbit, double aspect) {
    check(orbit, aspect);
    // Direction to the eye, and its derivative by the elevation, which is the image's upper edge.
    const OrbitAxes axes = orbit_axes(up_of(orbit, subject));
    const double az = radians(orbit.azimuth_degrees), el = radians(orbit.elevation_degrees);
    const Vec3d level = std::cos(az) * axes.a + std::sin(az) * axes.b;
    const Vec3d to_eye = std::cos(el) * level + std::sin(el) * axes.u;
    const Vec3d edge = std::cos(el) * axes.u - std::sin(el) * level;
    const double roll = radians(orbit.roll_degrees);
    const Vec3d side = cross(-1.0 * to_eye, edge);
    const Vec3d up = std::cos(roll) * edge + std::sin(roll) * side;
    const ViewAxes view{cross(-1.0 * to_eye, up), up, -1.0 * to_eye};

    constexpr double kStraightAlong = 1e-6;  // cosine of the elevation
    Camera camera;
    camera.up = orbit.roll_degrees == 0 && std::cos(el) > kStraightAlong ? axes.u : up;
    camera.fov_degrees = orbit.fov_degrees;
    if (orbit.orthographic) camera.orthographic_width = orbit.width > 0 ? orbit.width : 1;
    const Subject shown = shown_subject(subject);
    const double radius = shown.box.radius();
    const bool is_fitted = orbit.orthographic ? orbit.width == 0 : orbit.distance_radii == 0;
    Fit place{orbit.orthographic ? middle_of(shown, view)
                                 : middle_of(shown, ViewAxes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
              orbit.distance_radii * radius,
              orbit.width};  // from a stated distance turns share one middle
    if (is_fitted) place = fit(shown, view, camera, aspect);
    if (orbit.orthographic) {
        camera.orthographic_width = place.width;
        place.distance =
            (orbit.distance_radii > 0 ? orbit.distance_radii : kPaperDistanceRadii) * radius;
    }
    camera.look_at = place.target;
    camera.eye = camera.look_at + place.distance * to_eye;
    return camera;
}

double fitted_width(const Camera& camera, const Subject& subject, double aspect) {
    return fit(shown_subject(subject), axes_of(camera), camera, aspect, camera.look_at).width;
}

Camera fitted(const Camera& camera, const Subject& subject, double aspect, bool centered) {
    const Subject shown = shown_subject(subject);
    const ViewAxes axes = axes_of(camera);
    const Fit place =
        fit(shown, axes, camera, aspect, centered ? std::nullopt : std::optional(camera.look_at));
    Camera result = camera;
    result.look_at = place.target;
    result.up = axes.up;
    if (camera.orthographic()) result.orthographic_width = place.width;
    const double distance =
        camera.orthographic() ? kPaperDistanceRadii * shown.box.radius() : place.distance;
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
    look_from(orbit, to_eye);
}

}  // namespace vog
