// camera_options.h: camera options of render, view and export.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "vog/camera.h"

namespace vog::cli {

struct ViewArguments {
    std::string view, camera_file, eye, look_at, up = "y", save_camera;
    double azimuth_degrees = kPaperAzimuthDegrees, elevation_degrees = kPaperElevationDegrees;
    double distance_radii = 0, fov_degrees = kPaperFovDegrees, roll_degrees = 0, width = 0;
    bool orthographic = false;
};

/// Adds the options of cameras: --view, angles, --eye, --up, --orthographic, --camera and theirs.
void add_view_options(CLI::App& command, ViewArguments& arguments);

/// Direction of --up, of any length above 0.
Vec3d up_of(const ViewArguments& arguments);

/// Whether an option of the camera was given, --save-camera included.
bool view_given(const CLI::App& command);

/// The camera of the options. It looks at the centre of `box` unless they name a point.
/// aspect  width / height of the picture that a fitted box shall fill
/// throws  vog::Error for an unreadable --camera file, CLI::ValidationError for options that
///         exclude each other or cannot be parsed
Camera camera_from(const ViewArguments& arguments, const CLI::App& command, const Box& box,
                   double aspect);

}  // namespace vog::cli
