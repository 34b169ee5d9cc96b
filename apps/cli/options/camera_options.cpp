// camera_options.cpp: cameras from options.
#include "options/camera_options.h"

#include "shared/inputs.h"

namespace vog::cli {

namespace {

/// CLI11's form of a check: empty where the text is x,y,z.
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
    command.add_option("--view", arguments.view, "A named view of the data's bounding box")
        ->check(CLI::IsMember({"paper"}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--azimuth", arguments.azimuth_rad,
                    "Angle about the up axis y, from x, radians")
        ->capture_default_str()
        ->group(group);
    command.add_option("--elevation", arguments.elevation_rad, "Angle above the xz plane, radians")
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--distance", arguments.distance_radii,
                    "From the centre of the data, in bounding radii (half the box's diagonal)")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->group(group);
    command.add_option("--fov", arguments.fov_degrees, "Full vertical angle of view, degrees")
        ->check(CLI::Range(0.001, 179.999))
        ->capture_default_str()
        ->group(group);
    command.add_option("--eye", arguments.eye, "Eye x,y,z in world units, instead of angles")
        ->check(vector_error)
        ->group(group);
    command
        .add_option("--look-at", arguments.look_at, "Point x,y,z to look at; default: the centre")
        ->check(vector_error)
        ->group(group);
    command.add_option("--up", arguments.up, "Direction x,y,z that is up in the image")
        ->capture_default_str()
        ->check(vector_error)
        ->group(group);
    command
        .add_option("--camera", arguments.camera_file,
                    "JSON file with eye, look_at, up and fov_degrees")
        ->group(group);
    command
        .add_option("--save-camera", arguments.save_camera, "Write the camera used to a JSON file")
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
