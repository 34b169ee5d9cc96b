// trackball.h: camera motions of mouse and keys, as functions from camera to camera without state.
#pragma once

#include <string>

#include "vog/camera.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

/// Point in the picture: right and up of its centre, in units of half its height.
struct ScreenPoint {
    double x = 0, y = 0;
};

/// Rotates about look_at by a virtual trackball dragged from one point to another: Bell's
/// trackball, a sphere that continues as a hyperbola, so that it covers the whole picture.
Camera rotated(const Camera& camera, ScreenPoint from, ScreenPoint to);
/// Rotates the eye about look_at: right about the camera's up axis, then up about its right axis.
Camera orbited(const Camera& camera, double right_rad, double up_rad);
/// Rotates the camera about an axis through look_at, right-handed.
/// axis  in world space, length > 0
Camera turned_about(const Camera& camera, Vec3d axis, double angle_rad);
/// Rotates the view direction about the eye.
Camera looked_around(const Camera& camera, double right_rad, double up_rad);
/// Rotates about the view direction; the picture turns clockwise.
Camera rolled(const Camera& camera, double angle_rad);
/// Translates so that points at look_at's depth follow the pointer.
/// aspect  width / height of the picture, here and below
Camera panned(const Camera& camera, ScreenPoint from, ScreenPoint to, double aspect);
/// Scales the distance to the point under the pointer, at look_at's depth, by `factor`; the point
/// stays under the pointer. Closer than `least_distance` (world units), look_at moves ahead, so
/// that the camera passes through the volume. An orthographic camera's width is scaled instead.
Camera zoomed(const Camera& camera, ScreenPoint at, double factor, double least_distance,
              double aspect);
/// Translates eye and look_at along the camera's axes, world units.
Camera flown(const Camera& camera, double right, double up, double forward);

/// View by name (set_view of vog/camera.h) with the camera's projection and angle, fitted.
/// up      vertical direction of the data
/// throws  vog::Error for other names, with the valid ones
Camera named_view(const Camera& camera, const std::string& name, const Subject& subject,
                  double aspect, Vec3d up);
/// The camera with parallel rays, or with a pinhole: look_at's plane keeps its size in the picture.
Camera with_projection(const Camera& camera, bool orthographic, double aspect);

/// Distance of the sphere of a light from behind from the middle of the picture.
inline constexpr double kLightRim = 0.9;
/// Place of the sphere that shows a light's direction: the middle for a light at the eye, kLightRim away for one from behind, and in
/// proportion to the angle between them.
ScreenPoint light_place(const DirectionalLight& light, const Camera& camera);
/// The light at another place, fixed as before; one at the eye becomes one of the world.
DirectionalLight dragged(DirectionalLight light, const Camera& camera, ScreenPoint by);

}  // namespace vog::viewer
