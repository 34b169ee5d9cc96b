// vog/camera.h: pinhole cameras, views around a box, camera files.
// Azimuth and elevation are in radians, fields of view in degrees.
#pragma once

#include <filesystem>

#include "vog/linear.h"

namespace vog {

/// Pinhole camera. Rays pass through pixel centres; columns run along forward x up, rows from the
/// top down.
struct Camera {
    Vec3d eye{0, 0, 1};          ///< centre of projection, world units
    Vec3d look_at{0, 0, 0};      ///< point in the middle of the image, world units; not `eye`
    Vec3d up{0, 1, 0};           ///< direction of the image's upper edge, any length above 0
    double fov_degrees = 38.58;  ///< full vertical field of view, degrees, (0, 180)
};

/// Rays of a camera for one image size. The ray through the centre of pixel (column, row) starts at
/// `eye` and has the unnormalised direction corner + column * step_x + row * step_y, which advances
/// one world unit along `forward`.
struct CameraFrame {
    /// Centre of projection, world units, and the camera's unit axes, right x up = -forward.
    Vec3d eye, right, up, forward;
    /// Direction through pixel (0, 0), and its change from one column and from one row to the next,
    /// world units per world unit along `forward`.
    Vec3d corner, step_x, step_y;
    /// Pixels on the image for a slope of 1 against `forward`: a length L at depth z covers
    /// L / z * pixels_per_unit pixels. > 0
    double pixels_per_unit = 1;
    int width = 0, height = 0;  ///< image size, pixels

    /// Unnormalised direction of the ray through (column, row); pixel centres are integers.
    Vec3d direction(double column, double row) const {
        return corner + column * step_x + row * step_y;
    }
};

/// Computes the rays of a camera for one image size.
/// width, height  pixels, >= 1, at most 2^28 in all
/// throws         vog::Error if eye equals look_at, up is zero or parallel to the view, the angle
///                or size is out of range, or a component is not finite
CameraFrame frame_of(const Camera& camera, int width, int height);

/// Camera on a sphere around the centre of a box, looking at the centre, y up (x up for views along
/// y):  eye = centre + distance * (cos el * cos az, sin el, cos el * sin az).
/// box              world units; an empty one counts as the origin with bounding radius 1
/// azimuth_rad      az, any angle
/// elevation_rad    el, in [-pi/2, pi/2]
/// distance_radii   distance in bounding radii of the box (Box::radius), > 0
/// fov_degrees      full vertical field of view, (0, 180)
Camera orbit_view(const Box& box, double azimuth_rad, double elevation_rad, double distance_radii,
                  double fov_degrees);

inline constexpr double kPaperAzimuthRad = 0.6;               ///< azimuth of the `paper` view
inline constexpr double kPaperElevationRad = 0.35;            ///< elevation of the `paper` view
inline constexpr double kPaperDistanceRadii = 3.0;            ///< its distance, bounding radii
inline constexpr double kPaperFovDegrees = 38.5800924383775;  ///< its field of view, 2 atan(0.35)

/// The `paper` view of a box: orbit_view with the four constants above. All tables use it.
Camera paper_view(const Box& box);

/// Reads a camera from JSON:
///   {"eye": [x, y, z], "look_at": [x, y, z], "up": [x, y, z], "fov_degrees": a}
/// Without "up" or "fov_degrees" the defaults of Camera hold.
/// throws  vog::Error for a missing file or key, an unknown key, a wrong type, or numbers that
///         frame_of refuses
Camera read_camera(const std::filesystem::path& file);
/// Writes a camera as read_camera reads it, beside the file, renamed when whole.
/// throws  vog::Error if the file cannot be written
void write_camera(const std::filesystem::path& file, const Camera& camera);

}  // namespace vog
