// camera_options.h: camera options of render, view and export.
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

/// The camera of the options. It looks at the centre of `box` unless they name a point.
/// throws  vog::Error for an unreadable --camera file, CLI::ValidationError for options that
///         exclude each other or cannot be parsed
Camera camera_from(const ViewArguments& arguments, const CLI::App& command, const Box& box);

}  // namespace vog::cli
