// camera_options.h: camera options of render, view and page.
#pragma once

#include <optional>
#include <string>

#include "options/parser/given_options.h"
#include "vog/camera.h"
#include "vog/picture.h"

namespace vog::cli {

struct ViewArguments {
    std::string view, camera_file, eye, look_at, up;
    double distance_radii = 0, fov_degrees = kPaperFovDegrees, roll_degrees = 0, width = 0;
    bool orthographic = false;
    std::string frame = "content";
    std::optional<Camera> stored{};  ///< of --request, or of a slice
    bool along_plane = false;        ///< stored is the view of a slice, which --up turns
};

/// Adds the options of cameras: --view, --eye, --up, --orthographic, --camera and theirs.
void add_view_options(CLI::App& command, ViewArguments& arguments);
/// Adds --up.
void add_up_option(CLI::App& command, ViewArguments& arguments);

/// Direction of --up, of any length above 0; without it as the subject stands.
Vec3d up_of(const ViewArguments& arguments, const Subject& subject);

/// Whether an option of the camera was given.
bool view_given(const GivenOptions& command);

/// Whether the camera is that of --request: no option places another. --set roll, --up of a slice, --orthographic and --width change it.
bool keeps_stored(const ViewArguments& arguments, const GivenOptions& command);

/// What a view of a subject frames by --frame: what the picture shows, or the box.
Subject framed(const ViewArguments& arguments, const Subject& subject,
               const PictureRequest& request);

/// The camera of the options. It looks at the subject unless they name a point.
/// aspect  width / height of the picture that a fitted box shall fill
/// throws  vog::Error for an unreadable --camera file, UsageError for options that
///         exclude each other or cannot be parsed
Camera camera_from(const ViewArguments& arguments, const GivenOptions& command,
                   const Subject& subject, const PictureRequest& request, double aspect);

}  // namespace vog::cli
