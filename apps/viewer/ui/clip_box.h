// clip_box.h: the clip box and slices over the picture, which can be dragged.
#pragma once

#include <optional>
#include <utility>

#include "ui/panels.h"

namespace vog::viewer {

/// Draws the edges of the clip box, a handle in the middle of each face, and one in the middle of each visible slice.
void draw_clip_box(const Session& session, const Layout& layout);
/// Face or slice whose handle is at a point, in ImGui's coordinates; nothing: none is.
std::optional<Face> clip_face_at(const Session& session, const Rect& picture, float ui, float x,
                                 float y);
/// Moves a face of the clip box by a drag in the picture, within the data's box and before the face opposite; or a slice, within
/// its data.
/// dx, dy  of the pointer, in ImGui's coordinates
void drag_clip_face(Session& session, const Rect& picture, Face face, float dx, float dy);
/// Offsets of planes that meet the data of a layer with a slice.
std::pair<double, double> slice_range(const Session& session, std::size_t layer);

}  // namespace vog::viewer
