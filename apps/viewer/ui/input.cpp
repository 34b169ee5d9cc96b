// input.cpp: camera motions and settings by mouse and keyboard.
#include "ui/input.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "screen/screen_keys.h"
#include "ui/handles.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

constexpr KeyHelp kHelp[] = {
    {"left drag", "turn around the centre"},
    {"middle or Shift + left drag", "pan"},
    {"wheel", "zoom towards the pointer, also through the volume"},
    {"right drag", "zoom; of fields and volumes window and level, with Shift zoom"},
    {"Ctrl + left drag", "look around from the eye's position"},
    {"Alt + left drag", "roll"},
    {"drag the split line", "compare two renderers"},
    {"drag a circle of the clip box, of a slice", "move that face, that slice"},
    {"drag the sphere, or Ctrl + right drag", "turn the light"},
    {"W S A D, PageUp PageDown", "move forward, back, left, right, up, down"},
    {"Q E", "roll"},
    {"arrows", "turn by 5 degrees"},
    {"1 2 3, with Shift", "view from +x +y +z, from -x -y -z"},
    {"P  Home  F", "paper view, initial view, fit to the window"},
    {"[ ]", "coarser, finer level of detail"},
    {"- =  0", "extinction down, up, automatic"},
    {"G  Shift + G  J", "next, previous quantity, next field"},
    {"R  Y  K", "range of this view, light, clip box"},
    {"Ctrl + Z  Ctrl + Y", "undo, redo the transfer function of values, and drags of the light"},
    {"Space  ,  .", "play steps in time, step back, step on"},
    {"5  U", "parallel rays, z or y up"},
    {"M  Shift + M", "next, previous colour map"},
    {"I  B", "invert the map, blend"},
    {"N", "next renderer"},
    {"V  X", "split line, difference of two renderers"},
    {"C", "copy the view as command-line options"},
    {"F2  F3  F4", "save screenshot, picture (PNG), optical depth T (EXR)"},
    {"Tab  O  L  T", "show or hide panels, figures, colour bar, axes and probe"},
    {"F1 or H  F11", "this help, full screen"},
    {"Ctrl + Q", "quit"},
};

ScreenPoint place(const Rect& picture, ImVec2 at) {
    const double half = 0.5 * picture.height;
    return {(at.x - picture.x - 0.5 * picture.width) / half,
            (picture.y + 0.5 * picture.height - at.y) / half};
}

Drag::Grip grip_of(const Session& session, const Rect& picture, const ImGuiIO& io, float ui) {
    const float line = picture.x + session.settings.split * picture.width;
    if (io.MouseDown[0]) {
        if (session.settings.split_on && !session.settings.difference &&
            std::abs(io.MousePos.x - line) < 6 * ui)
            return Drag::Grip::split;
        return io.KeyShift  ? Drag::Grip::pan
               : io.KeyCtrl ? Drag::Grip::look
               : io.KeyAlt  ? Drag::Grip::roll
                            : Drag::Grip::rotate;
    }
    if (!io.MouseDown[1]) return Drag::Grip::pan;
    if (io.KeyCtrl && has_light(session)) return Drag::Grip::light;
    return session.quantity.show == Show::depth || io.KeyShift ? Drag::Grip::zoom
                                                               : Drag::Grip::window;
}

void continue_drag(Session& session, Drag& state, const Rect& picture, ScreenPoint at,
                   float mouse_x) {
    const ScreenPoint from = state.last;
    state.last = at;
    const double dx = at.x - from.x, dy = at.y - from.y;
    if (dx == 0 && dy == 0) return;
    Camera& camera = session.camera;
    const double half_fov = camera.fov_degrees * std::numbers::pi / 360;
    switch (state.grip) {
        case Drag::Grip::rotate:
            camera = rotated(camera, from, at);
            break;
        case Drag::Grip::pan:
            camera = panned(camera, from, at, session.aspect());
            break;
        case Drag::Grip::zoom:
            camera =
                zoomed(camera, {}, std::exp(-2 * dy), session.least_distance(), session.aspect());
            break;
        case Drag::Grip::window:  // dx and dy are in units of half the height
            window_by_drag(session, 0.5 * dx / session.aspect(), 0.5 * dy);
            break;
        case Drag::Grip::clip: {
            const float half = 0.5f * picture.height;
            drag_clip_face(session, picture, state.face, static_cast<float>(dx) * half,
                           -static_cast<float>(dy) * half);
            break;
        }
        case Drag::Grip::light:
            drag_light(session, dx, dy);
            break;
        case Drag::Grip::look:  // the point under the pointer follows it
            camera = looked_around(camera, -dx * half_fov, -dy * half_fov);
            break;
        case Drag::Grip::roll:
            camera = rolled(
                camera, std::atan2(from.y * at.x - from.x * at.y, from.x * at.x + from.y * at.y));
            break;
        case Drag::Grip::split:
            session.settings.split = std::clamp((mouse_x - picture.x) / picture.width, 0.0f, 1.0f);
            break;
        default:
            break;
    }
}

void apply_mouse(Session& session, Drag& state, const Rect& picture) {
    const ImGuiIO& io = ImGui::GetIO();
    const float ui = ImGui::GetFontSize() / 15;
    const ScreenPoint at = place(picture, io.MousePos);
    const bool down = io.MouseDown[0] || io.MouseDown[1] || io.MouseDown[2];
    const bool over = !io.WantCaptureMouse && picture.holds(io.MousePos.x, io.MousePos.y);
    const bool pressed =
        ImGui::IsMouseClicked(0) || ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2);
    const auto face = over && state.grip == Drag::Grip::none
                          ? clip_face_at(session, picture, ui, io.MousePos.x, io.MousePos.y)
                          : std::nullopt;
    const bool on_light = over && is_light_at(session, picture, ui, io.MousePos.x, io.MousePos.y);
    if (!down) {
        if (state.grip == Drag::Grip::window || state.grip == Drag::Grip::light)
            session.values.end_drag();
        state.grip = Drag::Grip::none;
    } else if (pressed && over && state.grip == Drag::Grip::none) {
        state.grip = grip_of(session, picture, io, ui);
        if (face && io.MouseDown[0]) {
            state.grip = Drag::Grip::clip;
            state.face = *face;
        }
        if (on_light && io.MouseDown[0]) state.grip = Drag::Grip::light;
        if (state.grip == Drag::Grip::window || state.grip == Drag::Grip::light)
            session.values.begin_drag();
        state.last = at;
    } else if (state.grip != Drag::Grip::none) {
        continue_drag(session, state, picture, at, io.MousePos.x);
    }
    const bool on_line =
        session.settings.split_on &&
        std::abs(io.MousePos.x - picture.x - session.settings.split * picture.width) < 6 * ui;
    if ((over && on_line) || state.grip == Drag::Grip::split)
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (face || on_light || state.grip == Drag::Grip::clip || state.grip == Drag::Grip::light)
        ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (over && io.MouseWheel != 0)
        session.camera =
            zoomed(session.camera, at, std::pow(0.85, static_cast<double>(io.MouseWheel)),
                   session.least_distance(), session.aspect());
}

/// Keys that move the camera while they are held.
void fly(Session& session) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.KeyCtrl || session.scene.levels.empty()) return;
    const auto held = [&](int key) { return io.KeysDown[key] ? 1.0 : 0.0; };
    const double seconds = std::min(0.05, static_cast<double>(io.DeltaTime));
    const double step = 0.6 * seconds * session.radius();  // 0.6 radii per second
    const double right = held(GLFW_KEY_D) - held(GLFW_KEY_A);
    const double up = held(GLFW_KEY_PAGE_UP) - held(GLFW_KEY_PAGE_DOWN);
    const double forward = held(GLFW_KEY_W) - held(GLFW_KEY_S);
    if (right != 0 || up != 0 || forward != 0)
        session.camera = flown(session.camera, step * right, step * up, step * forward);
    const double roll = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
    if (roll != 0) session.camera = rolled(session.camera, roll * seconds);
}

void change_map(Session& session, int step) {
    const std::vector<std::string> names = transfer_function_names();
    const int count = static_cast<int>(names.size());
    const bool by_value = session.quantity.show == Show::volume && session.values.now();
    const std::string shown = by_value ? session.values.now()->name : session.look.map;
    const auto found = std::find(names.begin(), names.end(), shown);
    const int now = found == names.end() ? 0 : static_cast<int>(found - names.begin());
    attempt(session, [&] {
        session.set_map(names[static_cast<std::size_t>((now + step + count) % count)]);
    });
}

void change_quantity(Session& session, int step) {
    constexpr int kCount = 6;
    for (int n = 1; n <= kCount; ++n) {
        const auto show = static_cast<Show>(
            (static_cast<int>(session.quantity.show) + kCount + n * step) % kCount);
        if (of_field(show) && field_choices(session.fields(), show).empty()) continue;
        return attempt(session, [&] { session.set_quantity(show); });
    }
}

void next_field(Session& session) {
    const auto all = field_choices(session.fields(), session.quantity.show);
    if (!of_field(session.quantity.show) || all.empty()) return;
    const std::string now = text_of(session.quantity.field);
    const auto found = std::ranges::find(all, now, text_of);
    const FieldChoice& next = found == all.end() || found + 1 == all.end() ? all.front() : found[1];
    attempt(session, [&] { session.set_quantity(session.quantity.show, text_of(next)); });
}

void toggle_clip(Session& session) {
    const bool on = session.quantity.look.clip.box.has_value();
    attempt(session, [&] {
        session.set_clip(on ? std::nullopt : std::optional(session.scene.subject.box));
    });
}

void apply_quantity_keys(Session& session) {
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, true); };
    if (pressed(GLFW_KEY_G)) change_quantity(session, ImGui::GetIO().KeyShift ? -1 : 1);
    if (pressed(GLFW_KEY_J)) next_field(session);
    if (pressed(GLFW_KEY_K)) toggle_clip(session);
    if (pressed(GLFW_KEY_Y)) session.quantity.look.light = !session.quantity.look.light;
    if (pressed(GLFW_KEY_U)) session.set_z_up(!(session.up() == Vec3d{0, 0, 1}));
    if (pressed(GLFW_KEY_R)) session.automatic_scale();
}

void apply_time_keys(Session& session) {
    const std::size_t count = session.step_count();
    if (count == 0) return;
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, true); };
    if (pressed(GLFW_KEY_SPACE)) session.play(!session.playing());
    if (pressed(GLFW_KEY_COMMA)) session.set_step((session.step() + count - 1) % count);
    if (pressed(GLFW_KEY_PERIOD)) session.set_step((session.step() + 1) % count);
}

void change_level(Session& session, int step) {
    const int last = static_cast<int>(session.scene.levels.size()) - 1;
    if (last < 0) return;
    const int now = session.settings.level < 0 ? last : session.settings.level;
    const int next = std::clamp(now + step, 0, last);
    session.settings.level = next == last ? -1 : next;
}

void next_renderer(Session& session) {
    std::vector<WindowRenderer> all = renderers();
    if (!session.scene.voxels) std::erase(all, WindowRenderer::voxels);
    const auto now = std::find(all.begin(), all.end(), session.settings.renderer);
    session.settings.renderer = now == all.end() || now + 1 == all.end() ? all.front() : now[1];
}

void apply_view_keys(Session& session) {
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, true); };
    const bool other_side = ImGui::GetIO().KeyShift;
    if (pressed(GLFW_KEY_1)) session.set_view(other_side ? "-x" : "+x");
    if (pressed(GLFW_KEY_2)) session.set_view(other_side ? "-y" : "+y");
    if (pressed(GLFW_KEY_3)) session.set_view(other_side ? "-z" : "+z");
    if (pressed(GLFW_KEY_P)) session.set_view("paper");
    if (pressed(GLFW_KEY_HOME)) session.reset_view();
    if (pressed(GLFW_KEY_F)) session.fit();
    if (pressed(GLFW_KEY_5)) session.set_orthographic(!session.camera.orthographic());
    constexpr double kTurn = 5 * std::numbers::pi / 180;
    if (pressed(GLFW_KEY_LEFT)) session.camera = orbited(session.camera, -kTurn, 0);
    if (pressed(GLFW_KEY_RIGHT)) session.camera = orbited(session.camera, kTurn, 0);
    if (pressed(GLFW_KEY_UP)) session.camera = orbited(session.camera, 0, kTurn);
    if (pressed(GLFW_KEY_DOWN)) session.camera = orbited(session.camera, 0, -kTurn);
}

void apply_setting_keys(Session& session, Requests& requests) {
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, true); };
    const auto toggle = [&](int key, bool& setting) {
        if (pressed(key)) setting = !setting;
    };
    Settings& s = session.settings;
    toggle(GLFW_KEY_TAB, s.panels);
    toggle(GLFW_KEY_O, s.overlay);
    toggle(GLFW_KEY_L, s.color_bar);
    toggle(GLFW_KEY_T, s.axes);
    toggle(GLFW_KEY_F1, s.help);
    toggle(GLFW_KEY_H, s.help);
    toggle(GLFW_KEY_V, s.split_on);
    toggle(GLFW_KEY_X, s.difference);
    if (pressed(GLFW_KEY_ESCAPE)) s.help = false;
    if (pressed(GLFW_KEY_LEFT_BRACKET)) change_level(session, -1);
    if (pressed(GLFW_KEY_RIGHT_BRACKET)) change_level(session, 1);
    if (pressed(GLFW_KEY_N)) next_renderer(session);
    if (pressed(GLFW_KEY_C)) session.copy_request();
    requests.full_screen |= pressed(GLFW_KEY_F11);
    requests.screenshot |= pressed(GLFW_KEY_F2);
    requests.picture |= pressed(GLFW_KEY_F3);
    requests.depth |= pressed(GLFW_KEY_F4);

    const double extinction = session.look.extinction;
    if (pressed(GLFW_KEY_MINUS)) session.look.extinction /= 1.1;
    if (pressed(GLFW_KEY_EQUAL)) session.look.extinction *= 1.1;
    const bool invert = session.look.invert, blend = session.look.shading.blend;
    toggle(GLFW_KEY_I, session.look.invert);
    toggle(GLFW_KEY_B, session.look.shading.blend);
    if (extinction != session.look.extinction || invert != session.look.invert ||
        blend != session.look.shading.blend)
        session.look_changed();
    if (pressed(GLFW_KEY_0)) session.auto_exposure();
    if (pressed(GLFW_KEY_M)) change_map(session, ImGui::GetIO().KeyShift ? -1 : 1);
}

}  // namespace

std::span<const KeyHelp> key_help() { return kHelp; }

int key_number(const std::string& name) {
    constexpr std::pair<const char*, int> kNamed[] = {
        {"space", GLFW_KEY_SPACE},
        {"tab", GLFW_KEY_TAB},
        {"escape", GLFW_KEY_ESCAPE},
        {"enter", GLFW_KEY_ENTER},
        {"home", GLFW_KEY_HOME},
        {"left", GLFW_KEY_LEFT},
        {"right", GLFW_KEY_RIGHT},
        {"up", GLFW_KEY_UP},
        {"down", GLFW_KEY_DOWN},
        {"pageup", GLFW_KEY_PAGE_UP},
        {"pagedown", GLFW_KEY_PAGE_DOWN},
        {"-", GLFW_KEY_MINUS},
        {"=", GLFW_KEY_EQUAL},
        {",", GLFW_KEY_COMMA},
        {".", GLFW_KEY_PERIOD},
        {"[", GLFW_KEY_LEFT_BRACKET},
        {"]", GLFW_KEY_RIGHT_BRACKET},
    };
    for (const auto& [known, key] : kNamed)
        if (name == known) return key;
    if (name.size() == 1 && name[0] >= 'a' && name[0] <= 'z') return GLFW_KEY_A + name[0] - 'a';
    if (name.size() == 1 && name[0] >= '0' && name[0] <= '9') return GLFW_KEY_0 + name[0] - '0';
    for (int n = 1; n <= 12; ++n)
        if (name == fmt::format("f{}", n)) return GLFW_KEY_F1 + n - 1;
    throw Error(fmt::format(
        "no key '{}', expected a letter, a digit, f1 to f12, space, tab, escape, enter, home, "
        "left, right, up, down, pageup, pagedown, -, =, \",\", \".\", [ or ]",
        name));
}

void apply_input(Session& session, Drag& state, const Rect& picture, Requests& requests) {
    apply_mouse(session, state, picture);
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return;
    if (io.KeyCtrl) {
        requests.quit |= ImGui::IsKeyPressed(GLFW_KEY_Q, false);
        const bool undo = ImGui::IsKeyPressed(GLFW_KEY_Z, true);
        if (undo && !io.KeyShift) session.values.undo(session.quantity.look.lights);
        if ((undo && io.KeyShift) || ImGui::IsKeyPressed(GLFW_KEY_Y, true))
            session.values.redo(session.quantity.look.lights);
        return;
    }
    fly(session);
    apply_setting_keys(session, requests);
    if (session.scene.levels.empty()) return;
    apply_view_keys(session);
    apply_quantity_keys(session);
    apply_time_keys(session);
}

}  // namespace vog::viewer
