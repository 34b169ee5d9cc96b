// handles.cpp: the clip box, slices and the light over the picture, and their motions.
#include "ui/handles.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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

/// Slices of layers that the picture shows.
std::vector<Face> slices_of(const Session& session) {
    std::vector<Face> slices;
    for (std::size_t n = 0; session.shows_layers() && n < session.layers().size(); ++n)
        if (session.layers()[n].visible && session.layers()[n].plane)
            slices.push_back({0, false, static_cast<int>(n)});
    return slices;
}

const SlicePlane& plane_of(const Session& session, Face slice) {
    return *session.layers()[static_cast<std::size_t>(slice.slice)].plane;
}

/// Point of a slice nearest to the middle of its data.
Vec3d middle_of(const Session& session, Face slice) {
    const SlicePlane& plane = plane_of(session, slice);
    const Vec3d at = session.layer_box(static_cast<std::size_t>(slice.slice)).center();
    const double length2 = dot(plane.normal, plane.normal);
    return at + (*plane.offset - dot(plane.normal, at)) / length2 * plane.normal;
}

/// All handles, with their places in the world.
std::vector<std::pair<Face, Vec3d>> handles_of(const Session& session) {
    std::vector<std::pair<Face, Vec3d>> handles;
    if (const std::optional<Box>& box = session.quantity.look.clip.box)
        for (const Face face : kFaces) handles.emplace_back(face, middle_of(*box, face));
    for (const Face slice : slices_of(session))
        handles.emplace_back(slice, middle_of(session, slice));
    return handles;
}

/// Steps along a line in the picture that a drag makes; nothing: the line points at the eye.
/// step  world
std::optional<double> steps_of(const Projection& projection, Vec3d at, Vec3d step, float dx,
                               float dy) {
    const auto from = projection.place(at), to = projection.place(at + step);
    if (!from || !to) return std::nullopt;
    const double ax = double{to->x - from->x}, ay = double{to->y - from->y};
    const double size2 = ax * ax + ay * ay;
    if (size2 < 1e-6) return std::nullopt;
    return (double{dx} * ax + double{dy} * ay) / size2;
}

void drag_slice(Session& session, const Projection& projection, Face slice, float dx, float dy) {
    const auto layer = static_cast<std::size_t>(slice.slice);
    const SlicePlane plane = plane_of(session, slice);
    const auto [low, high] = slice_range(session, layer);
    const double step = 0.01 * (high - low);
    const Vec3d along = step / dot(plane.normal, plane.normal) * plane.normal;
    const auto steps = steps_of(projection, middle_of(session, slice), along, dx, dy);
    if (!steps) return;
    const double offset = std::clamp(*plane.offset + *steps * step, low, high);
    attempt(session, [&] {
        session.edit_layer(layer, [&](Layer& moved) { moved.plane->offset = offset; });
    });
}

}  // namespace

std::pair<double, double> slice_range(const Session& session, std::size_t layer) {
    const Vec3d normal = session.layers()[layer].plane->normal;
    const Box box = session.layer_box(layer);
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis)
        reach += 0.5 * std::abs(normal[axis]) * (box.upper[axis] - box.lower[axis]);
    const double middle = dot(normal, box.center());
    return {middle - reach, middle + reach};
}

void draw_clip_box(const Session& session, const Layout& layout) {
    const std::optional<Box>& box = session.quantity.look.clip.box;
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
    for (int n = 0; n < 8 && box; ++n)
        for (int axis = 0; axis < 3; ++axis) {
            if (n >> axis & 1) continue;
            const auto from = corner(n), to = corner(n | 1 << axis);
            if (from && to) list.AddLine(*from, *to, IM_COL32(255, 255, 255, 110), layout.ui);
        }
    const float radius = 7 * layout.ui;
    for (const auto& [face, middle] : handles_of(session)) {
        const auto at = projection.place(middle);
        if (!at) continue;
        const std::string letter =
            face.slice < 0 ? kLetters[face.axis] : std::to_string(face.slice + 1);
        list.AddCircleFilled(*at, radius, IM_COL32(20, 20, 24, 220));
        list.AddCircle(*at, radius, IM_COL32(255, 255, 255, 230), 0, 1.5f * layout.ui);
        const ImVec2 size = ImGui::CalcTextSize(letter.c_str());
        list.AddText({at->x - 0.5f * size.x, at->y - 0.55f * size.y}, kInk, letter.c_str());
    }
    list.PopClipRect();
}

std::optional<Face> clip_face_at(const Session& session, const Rect& picture, float ui, float x,
                                 float y) {
    const Projection projection(session.camera, picture);
    std::optional<Face> best;
    float least = 9 * ui;
    for (const auto& [face, middle] : handles_of(session)) {
        const auto at = projection.place(middle);
        if (!at) continue;
        const float distance = std::hypot(at->x - x, at->y - y);
        if (distance < least) best = face, least = distance;
    }
    return best;
}

void drag_clip_face(Session& session, const Rect& picture, Face face, float dx, float dy) {
    const Projection projection(session.camera, picture);
    if (face.slice >= 0) return drag_slice(session, projection, face, dx, dy);
    const std::optional<Box> box = session.quantity.look.clip.box;
    if (!box) return;
    const Box& data = session.scene.subject.box;
    const double width = data.upper[face.axis] - data.lower[face.axis];
    if (!(width > 0)) return;
    Vec3d step;
    step[face.axis] = 0.01 * width;
    const auto steps = steps_of(projection, middle_of(*box, face), step, dx, dy);
    if (!steps) return;
    const double moved = *steps * step[face.axis];
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

namespace {

/// Place of the first light in the middle of the picture.
ImVec2 place_of_light(const Session& session, const Rect& picture) {
    const ScreenPoint at = light_place(lights_of(session.quantity.look).front(), session.camera);
    const double half = 0.5 * double{picture.height};
    return {picture.x + 0.5f * picture.width + static_cast<float>(half * at.x),
            picture.y + 0.5f * picture.height - static_cast<float>(half * at.y)};
}

}  // namespace

bool has_light(const Session& session) {
    const VolumeLook& look = session.quantity.look;
    return session.quantity.show == Show::volume && (look.light || look.shadows);
}

void draw_light(const Session& session, const Layout& layout) {
    if (!has_light(session)) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 at = place_of_light(session, layout.picture);
    const Rect& r = layout.picture;
    const bool behind = std::hypot(at.x - r.x - 0.5f * r.width, at.y - r.y - 0.5f * r.height) >
                        0.25f * static_cast<float>(kLightRim) * r.height;
    // A light behind the data is hollow.
    list.AddCircleFilled(at, 6 * layout.ui, behind ? kGround : IM_COL32(255, 214, 90, 255));
    list.AddCircle(at, 6 * layout.ui, IM_COL32(255, 214, 90, 255), 0, 2 * layout.ui);
    list.AddCircle(at, 8 * layout.ui, IM_COL32(20, 20, 24, 200), 0, layout.ui);
}

bool is_light_at(const Session& session, const Rect& picture, float ui, float x, float y) {
    if (!has_light(session)) return false;
    const ImVec2 at = place_of_light(session, picture);
    return std::hypot(at.x - x, at.y - y) < 10 * ui;
}

void drag_light(Session& session, double dx, double dy) {
    if (!has_light(session)) return;
    std::vector<DirectionalLight>& lights = session.quantity.look.lights;
    session.values.change_lights(lights);
    lights = lights_of(session.quantity.look);
    lights.front() = dragged(lights.front(), session.camera, {dx, dy});
}

}  // namespace vog::viewer
