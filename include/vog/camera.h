// vog/camera.h: perspective and orthographic cameras, views around a box, camera files.
// Angles are in degrees.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "vog/linear.h"
#include "vog/subject.h"

namespace vog {

/// Pinhole camera, or an orthographic one, whose rays are parallel. Rays pass through pixel centres;
/// columns run along forward x up, rows from the top down.
struct Camera {
    /// Centre of projection, world units. Orthographic: a point of the plane, perpendicular to the
    /// view, that all rays start from.
    Vec3d eye{0, 0, 1};
    Vec3d look_at{0, 0, 0};      ///< point in the middle of the image, world units; not `eye`
    Vec3d up{0, 1, 0};           ///< direction of the image's upper edge, any length above 0
    double fov_degrees = 38.58;  ///< full vertical field of view of a pinhole camera, (0, 180)
    /// Width of an orthographic image, world units, > 0; 0: a pinhole camera.
    double orthographic_width = 0;

    bool orthographic() const { return orthographic_width > 0; }
    friend bool operator==(const Camera&, const Camera&) = default;
};

/// Rays of a camera for one image size: origin(column, row) + t direction(column, row), t >= 0. The
/// directions are not normalised: they advance one world unit along `forward`.
struct CameraFrame {
    /// Camera::eye, and the camera's unit axes, right x up = -forward, world units.
    Vec3d eye, right, up, forward;
    /// Direction through pixel (0, 0), and its change from one column and from one row to the next;
    /// no change for an orthographic camera.
    Vec3d corner, step_x, step_y;
    /// Origin of the ray of pixel (0, 0), world units, and its change from one column and from one
    /// row to the next; no change for a pinhole camera.
    Vec3d first_origin, shift_x, shift_y;
    /// Pixels on the image, > 0. Pinhole: for a slope of 1 against `forward`. Orthographic: for a
    /// world unit.
    double pixels_per_unit = 1;
    int width = 0, height = 0;  ///< image size, pixels
    bool orthographic = false;  ///< whether rays are parallel

    /// Origin of the ray through (column, row), world units; pixel centres are integers.
    Vec3d origin(double column, double row) const {
        return first_origin + column * shift_x + row * shift_y;
    }
    /// Unnormalised direction of the ray through (column, row).
    Vec3d direction(double column, double row) const {
        return corner + column * step_x + row * step_y;
    }
    /// Pixels that a world unit across the view covers at a depth along `forward`.
    /// depth  world units, > 0 for a pinhole camera
    double pixels_at(double depth) const {
        return orthographic ? pixels_per_unit : pixels_per_unit / depth;
    }
};

/// Computes the rays of a camera for one image size.
/// width, height  pixels, >= 1, at most 2^28 in all
/// throws         vog::Error if eye equals look_at, up is zero or parallel to the view, the angle,
///                width or size is out of range, or a component is not finite
CameraFrame frame_of(const Camera& camera, int width, int height);
/// The same rays in coordinates relative to a point, such as Gaussians::origin. Renderers of models
/// draw through these: the eye becomes float, if at all, after the subtraction.
CameraFrame relative_to(CameraFrame frame, Vec3d origin);

inline constexpr double kPaperAzimuthDegrees = 34.37746770784939;    ///< 0.6 rad
inline constexpr double kPaperElevationDegrees = 20.05352282957881;  ///< 0.35 rad
inline constexpr double kPaperDistanceRadii = 3.0;                   ///< distance, bounding radii
inline constexpr double kPaperFovDegrees = 38.5800924383775;         ///< 2 atan(0.35)

/// Place and kind of a camera. The default has the direction of the `paper` view, and the distance at which a subject's hull
/// fills the image, in whose middle it lies.
///
/// Azimuth and elevation are those of the eye as seen from the centre, in a frame that `up` turns:
///   eye = centre + distance * (cos el cos az A + sin el U + cos el sin az B)
/// U is the unit vector along `up`; A and B are the x and z axes, turned by the shortest rotation
/// from the y axis to U (by half a turn about x for -y). y up: A = x, B = z. z up: A = x, B = -y.
struct Orbit {
    double azimuth_degrees = kPaperAzimuthDegrees;      ///< az, any angle
    double elevation_degrees = kPaperElevationDegrees;  ///< el, [-90, 90]
    /// Distance of the eye from the centre, bounding radii of the box (Box::radius), > 0. 0: for a
    /// pinhole camera the distance at which the hull fits the image (kFitShare), else 3.
    double distance_radii = 0;
    double fov_degrees = kPaperFovDegrees;  ///< full vertical field of view, (0, 180)
    /// Vertical direction of the data, of any length; the image's upper edge, too. Views along it have as upper edge the limit
    /// of views from the same azimuth. 0: as the subject stands, y where that is not known; set_view takes 0 for y.
    Vec3d up{0, 0, 0};
    /// Angle that the camera is turned clockwise about its view direction; the picture then appears
    /// turned counter-clockwise.
    double roll_degrees = 0;
    bool orthographic = false;  ///< parallel rays, in place of a pinhole
    /// Width of an orthographic image, world units, > 0. 0: the width at which the hull fits.
    double width = 0;
};
/// Share of the image's width or height that a fitted hull covers, whichever limits.
inline constexpr double kFitShare = 0.95;

/// Vertical direction of an orbit about a subject.
Vec3d up_of(const Orbit& orbit, const Subject& subject);
/// View of a subject that nothing is said of: from its front, where that is known.
Orbit first_orbit(const Subject& subject);

/// View of a subject.
/// subject  one without a box counts as the origin with bounding radius 1, a single point as a box of radius 1
/// aspect   width / height of the image that a fitted subject shall fill, > 0
/// throws   vog::Error for a value out of the ranges of Orbit
Camera orbit_view(const Subject& subject, const Orbit& orbit = {}, double aspect = 1);

/// Least width of an orthographic image at which a subject fits (kFitShare), world units.
/// camera  direction, up and look_at, the image's middle; it may be a pinhole camera
double fitted_width(const Camera& camera, const Subject& subject, double aspect = 1);
/// The same direction, from the distance, or with the orthographic width, at which a subject fits the image.
/// aspect    width / height of the image, > 0
/// centered  whether the subject moves into the middle of the image; else look_at stays
Camera fitted(const Camera& camera, const Subject& subject, double aspect = 1,
              bool centered = true);

/// The `paper` view of a box: orbit_view with the four constants above. All tables use it.
Camera paper_view(const Box& box);

/// Names of views: "paper", "+x", "-x", "+y", "-y", "+z", "-z".
std::span<const char* const> view_names();
/// Sets azimuth and elevation of a named view: "+x" looks from the positive x axis at the centre,
/// whatever `up`; "paper" also sets the paper's distance. A view along `up` has the azimuth 90
/// degrees: z up, "+z" shows x to the right and y upwards.
/// throws  vog::Error for another name
void set_view(Orbit& orbit, const std::string& name);

/// Reads a camera from JSON:
///   {"eye": [x, y, z], "look_at": [x, y, z], "up": [x, y, z], "fov_degrees": a}
/// with "orthographic_width": w in place of "fov_degrees" for an orthographic camera. Without "up"
/// or "fov_degrees" the defaults of Camera hold.
/// throws  vog::Error for a missing file or key, an unknown key, a wrong type, or numbers that
///         frame_of refuses
Camera read_camera(const std::filesystem::path& file);
/// Writes a camera as read_camera reads it, beside the file, renamed when whole.
/// throws  vog::Error if the file cannot be written
void write_camera(const std::filesystem::path& file, const Camera& camera);

}  // namespace vog
