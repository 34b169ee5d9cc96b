// camera_options.cpp: help, checks and evaluation of the camera options.
#include "options/camera_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "files/inputs.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "vog/error.h"
#include "vog/picture_record.h"

namespace vog::cli {

namespace {

constexpr const char* kViewGroup = "View";

/// CLI11 check that a text is x,y,z: the error message, or empty.
std::string vector_error(const std::string& text) {
    try {
        parse_vector("", text);
        return {};
    } catch (const UsageError&) {
        return text + ": expected x,y,z";
    }
}

/// Direction of --up: an axis by name, or x,y,z.
Vec3d parse_up(const std::string& text) {
    const std::string name = text.size() == 1 ? "+" + text : text;
    if (name.size() == 2 && (name[0] == '+' || name[0] == '-') && name[1] >= 'x' &&
        name[1] <= 'z') {
        Vec3d up;
        up[name[1] - 'x'] = name[0] == '+' ? 1 : -1;
        return up;
    }
    const Vec3d up = parse_vector("--up", text);
    if (!(length(up) > 0))
        throw UsageError(fmt::format("--up {}: expected a direction, not 0,0,0", text));
    return up;
}
std::string up_error(const std::string& text) {
    try {
        parse_up(text);
        return {};
    } catch (const UsageError&) {
        return text + ": expected x, y, z, -x, -y, -z or a direction x,y,z";
    }
}

/// CLI11 check that a text is a named view, or azimuth and elevation in degrees.
std::string view_error(const std::string& text) {
    const std::vector<double> angles = parse_numbers(text);
    if (std::ranges::count(view_names(), text)) return {};
    if (angles.size() == 2 && std::abs(angles[1]) <= 90) return {};
    return fmt::format(
        "{}: expected one of {}, or AZIMUTH,ELEVATION with an elevation from -90 to 90", text,
        fmt::join(view_names(), ", "));
}

/// Camera of a JSON file or of a picture's record.
Camera read_any_camera(const std::string& file) {
    const std::string extension = extension_of(file);
    if (extension != ".png" && extension != ".exr") return read_camera(file);
    const PictureRequest request = read_record(file).request;
    if (!request.camera) throw Error(file + ": its record holds no camera");
    return *request.camera;
}

/// Turns the camera clockwise about its view direction.
Camera rolled(const Camera& camera, double degrees) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    const double angle = degrees * (std::numbers::pi / 180);
    Camera result = camera;
    result.up = std::cos(angle) * frame.up + std::sin(angle) * frame.right;
    return result;
}

/// The camera of a file or a request, orthographic if the options say so.
Camera camera_of_file(const ViewArguments& arguments, const Subject& subject, double aspect) {
    Camera camera =
        arguments.camera_file.empty() ? *arguments.stored : read_any_camera(arguments.camera_file);
    if (arguments.width > 0 && !arguments.orthographic && !camera.orthographic())
        throw UsageError(
            "--width: " + (arguments.camera_file.empty() ? "the request" : arguments.camera_file) +
            " holds a pinhole camera, expected --orthographic");
    if (arguments.orthographic && !camera.orthographic())
        camera.orthographic_width = fitted_width(camera, subject, aspect);
    if (!arguments.up.empty()) {
        const Vec3d up = parse_up(arguments.up), forward = normalized(camera.look_at - camera.eye);
        if (!(length(cross(normalized(up), forward)) > 1e-6))
            throw UsageError(fmt::format(
                "--up {}: is along the view of the slice, expected a direction in its plane",
                arguments.up));
        Subject box = subject;
        box.content.hull = Subject(outline_of(subject)).content.hull;
        const double before = fitted_width(camera, box, aspect);
        camera.up = up;
        camera.orthographic_width *= fitted_width(camera, box, aspect) / before;
    }
    if (arguments.width > 0) camera.orthographic_width = arguments.width;
    if (!arguments.look_at.empty()) {  // of a slice, whose view moves along its plane
        const Vec3d forward = normalized(camera.look_at - camera.eye),
                    away = parse_vector("--look-at", arguments.look_at) - camera.look_at,
                    along = away - dot(away, forward) * forward;
        camera.eye = camera.eye + along, camera.look_at = camera.look_at + along;
    }
    return arguments.roll_degrees != 0 ? rolled(camera, arguments.roll_degrees) : camera;
}

}  // namespace

void add_up_option(CLI::App& command, ViewArguments& arguments) {
    command
        .add_option(
            "--up", arguments.up,
            "Direction that points up in pictures and exported splats: x, y, z, -x, -y, -z or "
            "x,y,z. The angles of --view refer to it. Default: what the file states or implies (z "
            "for scans in RAS, FITS, mesh levels, and grids from Blender and Mantaflow), else y")
        ->check(up_error);
}

void add_view_options(CLI::App& command, ViewArguments& arguments) {
    const OptionGroup grouped(command, kViewGroup);
    command
        .add_option(
            "--view", arguments.view,
            fmt::format(
                "Direction to look from: AZIMUTH,ELEVATION in degrees, or one of {}. +x looks from "
                "the positive x axis at the centre of the input's bounding box. Azimuth turns "
                "about the up axis (y up: from x towards z; z up: from x towards -y); elevation is "
                "above the plane perpendicular to it. paper is {:.2f},{:.2f} at distance {}, the "
                "view of all tables. Default: the direction of paper, fitted",
                fmt::join(view_names(), ", "), kPaperAzimuthDegrees, kPaperElevationDegrees,
                kPaperDistanceRadii))
        ->check(view_error);
    add_value(command, "--distance", arguments.distance_radii, "(0, inf)",
              "Distance of the eye from the centre of the input's bounding box, in bounding radii "
              "(half the box's diagonal). Default: the visible data fill 95 % of the picture's "
              "width or height (--frame)");
    add_value(command, "--fov", arguments.fov_degrees, "[0.001, 179.999]",
              "Full vertical field of view, degrees");
    command.add_flag("--orthographic", arguments.orthographic,
                     "Parallel rays instead of perspective: lengths are to scale");
    add_value(command, "--width", arguments.width, "(0, inf)",
              "Width of an orthographic picture, world units. Default: the visible data fill 95 % "
              "of the picture's width or height (--frame)");
    add_value(command, "--frame", arguments.frame, "content data",
              "What a fitted picture contains: 99.9 % of the visible data (content), or the whole "
              "box of the data (data)");
    command
        .add_option("--eye", arguments.eye,
                    "Position x,y,z of the eye in world units, instead of angles")
        ->check(vector_error);
    command
        .add_option("--look-at", arguments.look_at,
                    "Point x,y,z to look at, world units, from as far as shows all, or --distance; "
                    "default: the middle of what the data show")
        ->check(vector_error);
    add_up_option(command, arguments);
    add_value(command, setting("roll"), arguments.roll_degrees, "",
              "Turn the camera clockwise about its view direction, degrees");
    command.add_option("--camera", arguments.camera_file,
                       "Camera file: a picture written by vog, or JSON with eye, look_at, up and "
                       "fov_degrees or orthographic_width");
}

Vec3d up_of(const ViewArguments& arguments, const Subject& subject) {
    return arguments.up.empty() ? up_of(Orbit{}, subject) : parse_up(arguments.up);
}

bool view_given(const GivenOptions& command) { return !command.names(kViewGroup).empty(); }

bool keeps_stored(const ViewArguments& arguments, const GivenOptions& command) {
    return arguments.stored &&
           !command.has_any({"--view", "--distance", "--fov", "--eye", "--camera"}) &&
           (arguments.along_plane || !command.has_any({"--frame", "--up", "--look-at"}));
}

Subject framed(const ViewArguments& arguments, const Subject& subject,
               const PictureRequest& request) {
    Subject shown = shown_by(request, subject);
    if (!request.marks.axes && (arguments.frame == "data" || arguments.view == "paper"))
        shown.content.hull = Subject(subject.box).content.hull;
    return shown;
}

Camera camera_from(const ViewArguments& arguments, const GivenOptions& command,
                   const Subject& subject, const PictureRequest& request, double aspect) {
    const Subject shown = framed(arguments, subject, request);
    const auto given = [&](const char* option) { return command.has(option); };
    const bool stored = keeps_stored(arguments, command);
    if (given("--width") && !given("--orthographic") && !given("--camera") && !stored)
        throw UsageError("--width needs --orthographic");
    if (given("--camera") || stored) return camera_of_file(arguments, shown, aspect);

    Orbit orbit = given("--up") ? Orbit{} : first_orbit(subject);
    if (given("--up")) orbit.up = parse_up(arguments.up);
    orbit.fov_degrees = arguments.fov_degrees;
    orbit.roll_degrees = arguments.roll_degrees;
    orbit.orthographic = arguments.orthographic;
    orbit.width = arguments.width;
    if (const std::vector<double> angles = parse_numbers(arguments.view); !angles.empty())
        orbit.azimuth_degrees = angles[0], orbit.elevation_degrees = angles[1];
    else if (given("--view"))
        set_view(orbit, arguments.view);
    if (given("--distance")) orbit.distance_radii = arguments.distance_radii;
    Camera camera = orbit_view(shown, orbit, aspect);
    if (!given("--eye") && !given("--look-at")) return camera;

    const Vec3d target =
        given("--look-at") ? parse_vector("--look-at", arguments.look_at) : camera.look_at;
    // An orbit about another point keeps its angles, and a distance that is stated.
    if (!given("--eye")) {
        camera.eye = camera.eye + (target - camera.look_at);
        camera.look_at = target;
        if (orbit.distance_radii == 0 && !orbit.orthographic)
            camera.eye = fitted(camera, shown, aspect, false).eye;
    } else {
        camera.look_at = target;
        camera.eye = parse_vector("--eye", arguments.eye);
        camera.up = orbit.up;
        if (orbit.roll_degrees != 0) camera = rolled(camera, orbit.roll_degrees);
    }
    if (orbit.orthographic && orbit.width == 0)
        camera.orthographic_width = fitted_width(camera, shown, aspect);
    return camera;
}

}  // namespace vog::cli
