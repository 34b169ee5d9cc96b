// camera_options.h: the camera options that render and its kin share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "vog/camera.h"

namespace vog::cli {

struct ViewArguments {
    std::string view = "paper", camera_file, eye, look_at, up = "0,1,0", save_camera;
    double azimuth_rad = kPaperAzimuthRad, elevation_rad = kPaperElevationRad;
    double distance_radii = kPaperDistanceRadii, fov_degrees = kPaperFovDegrees;
};

/// Adds --view, --azimuth, --elevation, --distance, --fov, --eye, --look-at, --up, --camera.
void add_view_options(CLI::App& command, ViewArguments& arguments);

/// The camera the options describe, looking at `box` where they name no point.
/// throws vog::Error on options that cannot be parsed, CLI::ValidationError on ones that clash
Camera camera_from(const ViewArguments& arguments, const CLI::App& command, const Box& box);

}  // namespace vog::cli
