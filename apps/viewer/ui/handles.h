// handles.h: Handles over the picture, to drag: faces of the clip box, slices, and the light.
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

/// Whether the picture has a light to drag: a volume's that shades surfaces or casts shadows.
bool has_light(const Session& session);
/// Draws the sphere of the first light, at light_place.
void draw_light(const Session& session, const Layout& layout);
/// Whether that sphere is at a point, in ImGui's coordinates.
bool is_light_at(const Session& session, const Rect& picture, float ui, float x, float y);
/// Turns the first light by a drag in the picture.
void drag_light(Session& session, double dx, double dy);

}  // namespace vog::viewer
