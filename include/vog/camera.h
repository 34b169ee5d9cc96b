// vog/camera.h: a pinhole camera, and where the named views stand.
#pragma once

#include <filesystem>

#include "vog/linear.h"

namespace vog {

/// Pinhole camera. Rays pass through pixel centres; image x runs along forward x up, rows from the
/// top. World units.
struct Camera {
    Vec3d eye{0, 0, 1};
    Vec3d look_at{0, 0, 0};
    Vec3d up{0, 1, 0};
    double fov_degrees = 38.58;  ///< full vertical angle, (0, 180)
};

/// The camera's orthonormal axes and pixel steps for one image size. The ray through the centre of
/// pixel (column, row) has the unnormalised direction corner + column * step_x + row * step_y,
/// which advances one world unit along `forward`.
struct CameraFrame {
    Vec3d eye, right, up, forward;
    Vec3d corner, step_x, step_y;
    double pixels_per_unit = 1;  ///< image-plane pixels per unit of right/forward slope
    int width = 0, height = 0;

    Vec3d direction(double column, double row) const {
        return corner + column * step_x + row * step_y;
    }
};

/// throws vog::Error if eye equals look_at, up is parallel to the view, the angle or size is out of
/// range, or anything is not finite
CameraFrame frame_of(const Camera& camera, int width, int height);

/// A camera on the sphere around the centre of `box`. Angles in radians; the eye lies at
/// centre + distance (cos el cos az, sin el, cos el sin az), y up.
/// distance  in bounding radii (half the diagonal of the box)
Camera orbit_view(const Box& box, double azimuth_rad, double elevation_rad, double distance_radii,
                  double fov_degrees);

inline constexpr double kPaperAzimuthRad = 0.6;
inline constexpr double kPaperElevationRad = 0.35;
inline constexpr double kPaperDistanceRadii = 3.0;
inline constexpr double kPaperFovDegrees = 38.5800924383775;  ///< 2 atan(0.35)

/// The view every table is made from: azimuth 0.6, elevation 0.35, 3 radii, half angle atan(0.35).
Camera paper_view(const Box& box);

/// JSON: {"eye": [x,y,z], "look_at": [x,y,z], "up": [x,y,z], "fov_degrees": a}; up and fov
/// optional. throws vog::Error on a missing or unknown key, a wrong type, a missing file
Camera read_camera(const std::filesystem::path& file);
void write_camera(const std::filesystem::path& file, const Camera& camera);

}  // namespace vog
