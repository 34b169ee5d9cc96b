// trackball.h: how a hand moves a camera. Every motion is a function of a camera: no state, no
// window.
#pragma once

#include <string>

#include "vog/camera.h"

namespace vog::viewer {

/// A place in the picture: right and up of its middle, in half heights.
struct ScreenPoint {
    double x = 0, y = 0;
};

/// Turns around look_at as if a ball there were dragged from one place to another: Bell's
/// trackball, a sphere that runs out into a hyperbola, so that no place is off the ball.
Camera rotated(const Camera& camera, ScreenPoint from, ScreenPoint to);
/// Turns around look_at: rightwards about the camera's up, then upwards about its right; radians.
Camera orbited(const Camera& camera, double right_rad, double up_rad);
/// Turns the eye's view in place.
Camera looked_around(const Camera& camera, double right_rad, double up_rad);
/// Turns about the line of sight, clockwise as the picture is seen.
Camera rolled(const Camera& camera, double angle_rad);
/// Moves so that what lies at look_at's depth follows the pointer.
Camera panned(const Camera& camera, ScreenPoint from, ScreenPoint to);
/// Moves towards what is under the pointer at look_at's depth, which stays there: the distance
/// times `factor`. Never stops before the volume: closer than `least_distance`, look_at is pushed
/// ahead.
Camera zoomed(const Camera& camera, ScreenPoint at, double factor, double least_distance);
/// Moves eye and look_at along the camera's axes, world units.
Camera flown(const Camera& camera, double right, double up, double forward);

/// The same direction, from where the whole box is seen: its bounding sphere fits the picture.
/// aspect  width / height
Camera fitted(const Camera& camera, const Box& box, double aspect);
/// "paper", "+x", "-x", "+y", ...: fitted, from that side of the box; y up, or x for "+y" and "-y".
/// throws vog::Error listing the names if there is none such
Camera named_view(const std::string& name, const Box& box, double aspect, double fov_degrees);

/// `--eye ... --look-at ... --up ... --fov ...`, digit for digit.
std::string camera_flags(const Camera& camera);

}  // namespace vog::viewer
