// clip_box.h: the clip box over the picture, whose faces can be dragged.
#pragma once

#include <optional>

#include "ui/panels.h"

namespace vog::viewer {

/// Face of a box: its axis, 0 to 2, and whether it is the upper one.
struct Face {
    int axis = 0;
    bool upper = false;
};
/// Draws the edges of the clip box, and a handle in the middle of each face.
void draw_clip_box(const Session& session, const Layout& layout);
/// Face whose handle is at a point, in ImGui's coordinates; nothing: none is.
std::optional<Face> clip_face_at(const Session& session, const Rect& picture, float ui, float x,
                                 float y);
/// Moves a face of the clip box by a drag in the picture, within the data's box and before the face opposite.
/// dx, dy  of the pointer, in ImGui's coordinates
void drag_clip_face(Session& session, const Rect& picture, Face face, float dx, float dy);

}  // namespace vog::viewer
