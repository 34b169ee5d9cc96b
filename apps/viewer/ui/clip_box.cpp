// clip_box.cpp: projection of the clip box, and the motion of its faces.
#include "ui/clip_box.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/palette.h"

namespace vog::viewer {

namespace {

constexpr Face kFaces[] = {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}};
constexpr const char* kLetters[] = {"x", "y", "z"};

/// Points of the world in the picture.
class Projection {
  public:
    Projection(const Camera& camera, const Rect& picture)
        : frame_(frame_of(camera, std::max(1, static_cast<int>(picture.width)),
                          std::max(1, static_cast<int>(picture.height)))),
          picture_(picture) {}
    /// Nothing: behind the eye.
    std::optional<ImVec2> place(Vec3d point) const {
        const Vec3d to = point - frame_.eye;
        const double depth = dot(to, frame_.forward);
        if (!frame_.orthographic && !(depth > 1e-6 * length(to))) return std::nullopt;
        const double scale = frame_.pixels_at(depth);
        return ImVec2{
            picture_.x + 0.5f * picture_.width + static_cast<float>(scale * dot(to, frame_.right)),
            picture_.y + 0.5f * picture_.height - static_cast<float>(scale * dot(to, frame_.up))};
    }

  private:
    CameraFrame frame_;
    Rect picture_;
};

Vec3d middle_of(const Box& box, Face face) {
    Vec3d at = box.center();
    at[face.axis] = face.upper ? box.upper[face.axis] : box.lower[face.axis];
    return at;
}

}  // namespace

void draw_clip_box(const Session& session, const Layout& layout) {
    const std::optional<Box>& box = session.quantity.look.clip.box;
    if (!box) return;
    const Projection projection(session.camera, layout.picture);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const Rect& r = layout.picture;
    list.PushClipRect({r.x, r.y}, {r.x + r.width, r.y + r.height}, true);
    const auto corner = [&](int n) {
        Vec3d at = box->lower;
        for (int axis = 0; axis < 3; ++axis)
            if (n >> axis & 1) at[axis] = box->upper[axis];
        return projection.place(at);
    };
    for (int n = 0; n < 8; ++n)
        for (int axis = 0; axis < 3; ++axis) {
            if (n >> axis & 1) continue;
            const auto from = corner(n), to = corner(n | 1 << axis);
            if (from && to) list.AddLine(*from, *to, IM_COL32(255, 255, 255, 110), layout.ui);
        }
    const float radius = 7 * layout.ui;
    for (const Face face : kFaces) {
        const auto at = projection.place(middle_of(*box, face));
        if (!at) continue;
        list.AddCircleFilled(*at, radius, IM_COL32(20, 20, 24, 220));
        list.AddCircle(*at, radius, IM_COL32(255, 255, 255, 230), 0, 1.5f * layout.ui);
        const ImVec2 size = ImGui::CalcTextSize(kLetters[face.axis]);
        list.AddText({at->x - 0.5f * size.x, at->y - 0.55f * size.y}, kInk, kLetters[face.axis]);
    }
    list.PopClipRect();
}

std::optional<Face> clip_face_at(const Session& session, const Rect& picture, float ui, float x,
                                 float y) {
    const std::optional<Box>& box = session.quantity.look.clip.box;
    if (!box) return std::nullopt;
    const Projection projection(session.camera, picture);
    std::optional<Face> best;
    float least = 9 * ui;
    for (const Face face : kFaces) {
        const auto at = projection.place(middle_of(*box, face));
        if (!at) continue;
        const float distance = std::hypot(at->x - x, at->y - y);
        if (distance < least) best = face, least = distance;
    }
    return best;
}

void drag_clip_face(Session& session, const Rect& picture, Face face, float dx, float dy) {
    const std::optional<Box> box = session.quantity.look.clip.box;
    if (!box) return;
    const Projection projection(session.camera, picture);
    const Box& data = session.scene.subject.box;
    const double width = data.upper[face.axis] - data.lower[face.axis];
    const double step = 0.01 * width;
    Vec3d at = middle_of(*box, face), beside = at;
    beside[face.axis] += step;
    const auto from = projection.place(at), to = projection.place(beside);
    if (!from || !to || !(width > 0)) return;
    // World units along the axis for a motion along its line in the picture.
    const double ax = double{to->x - from->x}, ay = double{to->y - from->y};
    const double size2 = ax * ax + ay * ay;
    if (size2 < 1e-6) return;  // the axis points at the eye
    const double moved = step * (double{dx} * ax + double{dy} * ay) / size2;
    Box next = *box;
    const double least = 1e-3 * width;
    if (face.upper)
        next.upper[face.axis] =
            std::max(std::min(next.upper[face.axis] + moved, data.upper[face.axis]),
                     next.lower[face.axis] + least);
    else
        next.lower[face.axis] =
            std::min(std::max(next.lower[face.axis] + moved, data.lower[face.axis]),
                     next.upper[face.axis] - least);
    attempt(session, [&] { session.set_clip(next); });
}

}  // namespace vog::viewer
