// camera_options.cpp: help, checks and evaluation of the camera options.
#include "options/camera_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "shared/inputs.h"
#include "shared/validators.h"

namespace vog::cli {

namespace {

constexpr const char* kViewGroup = "View";

/// CLI11 check that a text is x,y,z: the error message, or empty.
std::string vector_error(const std::string& text) {
    try {
        parse_vector("", text);
        return {};
    } catch (const CLI::ValidationError&) {
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
        throw CLI::ValidationError(fmt::format("--up {}: expected a direction, not 0,0,0", text));
    return up;
}
std::string up_error(const std::string& text) {
    try {
        parse_up(text);
        return {};
    } catch (const CLI::ValidationError&) {
        return text + ": expected x, y, z, -x, -y, -z or a direction x,y,z";
    }
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
        arguments.camera_file.empty() ? *arguments.stored : read_camera(arguments.camera_file);
    if (arguments.width > 0 && !arguments.orthographic && !camera.orthographic())
        throw CLI::ValidationError(
            "--width: " + (arguments.camera_file.empty() ? "the request" : arguments.camera_file) +
            " holds a pinhole camera, expected --orthographic");
    if (arguments.orthographic && !camera.orthographic())
        camera.orthographic_width = fitted_width(camera, framed(arguments, subject), aspect);
    if (arguments.width > 0) camera.orthographic_width = arguments.width;
    return arguments.roll_degrees != 0 ? rolled(camera, arguments.roll_degrees) : camera;
}

}  // namespace

void add_view_options(CLI::App& command, ViewArguments& arguments) {
    const OptionGroup grouped(command, kViewGroup);
    std::vector<std::string> names(view_names().begin(), view_names().end());
    command
        .add_option(
            "--view", arguments.view,
            "Named view: +x looks from the positive x axis at the centre of the input's "
            "bounding box; paper is azimuth 34.38, elevation 20.05 and distance 3, the view "
            "of all tables. Default: the direction of paper, fitted")
        ->check(CLI::IsMember(names));
    command
        .add_option(
            "--azimuth", arguments.azimuth_degrees,
            "Angle of the eye about the up axis, degrees; y up: from x towards z; z up: from "
            "x towards -y")
        ->capture_default_str();
    command
        .add_option("--elevation", arguments.elevation_degrees,
                    "Angle of the eye above the plane across the up axis, degrees")
        ->check(CLI::Range(-90.0, 90.0))
        ->capture_default_str();
    command
        .add_option(
            "--distance", arguments.distance_radii,
            "Distance of the eye from the centre of the input's bounding box, in bounding radii "
            "(half the box's diagonal). Default: the distance at which what the data show fills 95 "
            "% of the "
            "picture's width or height (--frame)")
        ->check(positive_number());
    command.add_option("--fov", arguments.fov_degrees, "Full vertical field of view, degrees")
        ->check(CLI::Range(0.001, 179.999))
        ->capture_default_str();
    command.add_flag("--orthographic", arguments.orthographic,
                     "Parallel rays in place of a pinhole: no perspective, lengths to scale");
    command
        .add_option(
            "--width", arguments.width,
            "Width of an orthographic picture, world units. Default: what the data show fills "
            "95 % of the picture's width or height (--frame)")
        ->check(positive_number());
    command
        .add_option("--frame", arguments.frame,
                    "What a fitted picture holds: content, 99.9 % of what the data show, or data, "
                    "their whole box")
        ->check(CLI::IsMember({"content", "data"}))
        ->capture_default_str();
    command
        .add_option("--eye", arguments.eye,
                    "Position x,y,z of the eye in world units, in place of the angles")
        ->check(vector_error);
    command
        .add_option("--look-at", arguments.look_at,
                    "Point x,y,z to look at, world units; default: the centre of the bounding box")
        ->check(vector_error);
    command
        .add_option(
            "--up", arguments.up,
            "Direction that is upright in the data: x, y, z, -x, -y, -z or x,y,z. It points "
            "up in the picture, and in viewers of exported splats; azimuth and elevation are "
            "measured about it. Default: as the file says or implies (z for scans in RAS, FITS, "
            "levels of meshes, Blender's and Mantaflow's grids), else y")
        ->check(up_error);
    command
        .add_option("--roll", arguments.roll_degrees,
                    "Turn the camera clockwise about its view direction, degrees")
        ->capture_default_str();
    command.add_option("--camera", arguments.camera_file,
                       "Read the camera from a JSON file with eye, look_at, up and fov_degrees or "
                       "orthographic_width");
    command.add_option("--save-camera", arguments.save_camera,
                       "Write the camera of the picture to a JSON file");
}

Vec3d up_of(const ViewArguments& arguments, const Subject& subject) {
    return arguments.up.empty() ? up_of(Orbit{}, subject) : parse_up(arguments.up);
}

bool view_given(const CLI::App& command) {
    return std::ranges::any_of(command.get_options(), [](const CLI::Option* option) {
        return option->get_group() == kViewGroup && option->count() > 0;
    });
}

bool keeps_stored(const ViewArguments& arguments, const CLI::App& command) {
    if (!arguments.stored) return false;
    constexpr const char* kPlacing[] = {"--view", "--azimuth", "--elevation", "--distance",
                                        "--fov",  "--frame",   "--eye",       "--look-at",
                                        "--up",   "--camera"};
    return std::ranges::none_of(kPlacing,
                                [&](const char* option) { return command.count(option) > 0; });
}

Subject framed(const ViewArguments& arguments, const Subject& subject) {
    Subject shown = subject;
    if (arguments.frame == "data" || arguments.view == "paper")
        shown.content.hull = Subject(subject.box).content.hull;
    return shown;
}

Camera camera_from(const ViewArguments& arguments, const CLI::App& command, const Subject& subject,
                   double aspect) {
    const auto given = [&](const char* option) { return command.count(option) > 0; };
    const bool stored = keeps_stored(arguments, command);
    if (given("--width") && !given("--orthographic") && !given("--camera") && !stored)
        throw CLI::ValidationError("--width needs --orthographic");
    if (given("--camera") || stored) return camera_of_file(arguments, subject, aspect);

    Orbit orbit = given("--up") ? Orbit{} : first_orbit(subject);
    if (given("--up")) orbit.up = parse_up(arguments.up);
    if (given("--azimuth")) orbit.azimuth_degrees = arguments.azimuth_degrees;
    if (given("--elevation")) orbit.elevation_degrees = arguments.elevation_degrees;
    orbit.fov_degrees = arguments.fov_degrees;
    orbit.roll_degrees = arguments.roll_degrees;
    orbit.orthographic = arguments.orthographic;
    orbit.width = arguments.width;
    if (given("--view")) set_view(orbit, arguments.view);
    if (given("--distance")) orbit.distance_radii = arguments.distance_radii;
    Camera camera = orbit_view(framed(arguments, subject), orbit, aspect);
    if (!given("--eye") && !given("--look-at")) return camera;

    const Vec3d target =
        given("--look-at") ? parse_vector("--look-at", arguments.look_at) : camera.look_at;
    // An orbit about another point keeps its angles and distance.
    if (!given("--eye")) {
        camera.eye = camera.eye + (target - camera.look_at);
        camera.look_at = target;
    } else {
        camera.look_at = target;
        camera.eye = parse_vector("--eye", arguments.eye);
        camera.up = orbit.up;
        if (orbit.roll_degrees != 0) camera = rolled(camera, orbit.roll_degrees);
    }
    if (orbit.orthographic && orbit.width == 0)
        camera.orthographic_width = fitted_width(camera, framed(arguments, subject), aspect);
    return camera;
}

}  // namespace vog::cli
