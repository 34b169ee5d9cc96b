// camera_options.cpp: help, checks and evaluation of the camera options.
#include "options/camera_options.h"

#include "shared/inputs.h"

namespace vog::cli {

namespace {

/// CLI11 check that a text is x,y,z: the error message, or empty.
std::string vector_error(const std::string& text) {
    try {
        parse_vector("", text);
        return {};
    } catch (const CLI::ValidationError&) {
        return text + ": expected x,y,z";
    }
}

}  // namespace

void add_view_options(CLI::App& command, ViewArguments& arguments) {
    const auto group = "View";
    command
        .add_option(
            "--view", arguments.view,
            "Named view of the input's bounding box: paper is azimuth 0.6, elevation 0.35 and "
            "distance 3")
        ->check(CLI::IsMember({"paper"}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--azimuth", arguments.azimuth_rad,
                    "Angle of the eye about the y axis, measured from x towards z, radians")
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--elevation", arguments.elevation_rad,
                    "Angle of the eye above the xz plane, radians")
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--distance", arguments.distance_radii,
            "Distance of the eye from the centre of the input's bounding box, in bounding radii "
            "(half the box's diagonal)")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->group(group);
    command.add_option("--fov", arguments.fov_degrees, "Full vertical field of view, degrees")
        ->check(CLI::Range(0.001, 179.999))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--eye", arguments.eye,
                    "Position x,y,z of the eye in world units, in place of the angles")
        ->check(vector_error)
        ->group(group);
    command
        .add_option("--look-at", arguments.look_at,
                    "Point x,y,z to look at, world units; default: the centre of the bounding box")
        ->check(vector_error)
        ->group(group);
    command.add_option("--up", arguments.up, "Direction x,y,z that points up in the picture")
        ->capture_default_str()
        ->check(vector_error)
        ->group(group);
    command
        .add_option("--camera", arguments.camera_file,
                    "Read the camera from a JSON file with eye, look_at, up and fov_degrees")
        ->group(group);
    command
        .add_option("--save-camera", arguments.save_camera,
                    "Write the camera of the picture to a JSON file")
        ->group(group);
}

Camera camera_from(const ViewArguments& arguments, const CLI::App& command, const Box& box) {
    const auto given = [&](const char* option) { return command.count(option) > 0; };
    const auto exclude = [&](const char* one, std::initializer_list<const char*> others) {
        for (const char* other : others)
            if (given(one) && given(other))
                throw CLI::ValidationError(std::string(one) + " and " + other +
                                           " exclude each other");
    };
    exclude("--camera", {"--view", "--azimuth", "--elevation", "--distance", "--fov", "--eye",
                         "--look-at", "--up"});
    exclude("--eye", {"--view", "--azimuth", "--elevation", "--distance"});
    exclude("--view", {"--azimuth", "--elevation", "--distance"});

    if (given("--camera")) return read_camera(arguments.camera_file);
    Camera camera = orbit_view(box, arguments.azimuth_rad, arguments.elevation_rad,
                               arguments.distance_radii, arguments.fov_degrees);
    if (given("--look-at")) {
        // An orbit about another point keeps its angles and distance.
        const Vec3d target = parse_vector("--look-at", arguments.look_at);
        camera.eye = camera.eye + (target - camera.look_at);
        camera.look_at = target;
    }
    if (given("--eye")) camera.eye = parse_vector("--eye", arguments.eye);
    if (given("--up")) camera.up = parse_vector("--up", arguments.up);
    return camera;
}

}  // namespace vog::cli
