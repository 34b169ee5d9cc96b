// splat_frame.h: from the axes and units of data to those of a file of splats, and back. Files state it in one text:
//   scale S center X Y Z up X Y Z
// S and center are Splats::world_scale and world_center, up is the data's direction that the file's convention has upright.
#pragma once

#include <string>
#include <string_view>

#include "vog/exchange.h"

namespace vog::exchange {

/// Name under which a format keeps the text.
inline constexpr const char* kFrameKey = "vog_frame";

/// Upright direction of a format: y in .spz (right, up, back), glTF and OpenUSD's upAxis; -y in 3DGS's PLY, whose
/// cameras are COLMAP's (right, down, front).
enum class Upright { y, minus_y };

/// Rotation that takes `up` to a format's upright direction by the shortest arc; -y is y turned about x.
/// up      not 0
/// throws  vog::Error for another direction
Mat3 turn_of(Vec3d up, Upright upright);

/// Splats in the axes of a file.
Splats turned(const Splats& splats, const Mat3& turn);

std::string frame_text(const Splats& splats, Vec3d up);

/// Takes Gaussians from the frame of a file to that of the data. An empty text leaves them as the file has them.
/// throws  vog::Error for a malformed text
void restore_frame(Gaussians& model, std::string_view text, Upright upright);

/// Product of two rotations: b, then a.
Quat product_of(Quat a, Quat b);

}  // namespace vog::exchange
