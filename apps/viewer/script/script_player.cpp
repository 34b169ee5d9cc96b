// script_player.cpp: effect of each action of a script.
#include "script/script_player.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <sstream>

#include "screen/screen_keys.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

bool on(const std::string& word) { return word == "on"; }

/// Coordinate of a text: "50%" of the picture's size, or pixels from its corner.
float place(const std::string& text, float origin, float size) {
    if (!text.ends_with('%')) return origin + static_cast<float>(number(text));
    return origin + size * static_cast<float>(number(text.substr(0, text.size() - 1))) / 100;
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Rgba background_from(const std::string& text) {
    if (text == "transparent") return {0, 0, 0, 0};
    std::istringstream in(text);
    std::string part;
    std::vector<float> c;
    bool valid = true;
    while (std::getline(in, part, ',')) {
        valid = valid && is_number(part) && number(part) >= 0 && number(part) <= 1;
        c.push_back(static_cast<float>(number(part)));
    }
    if (!valid || c.size() != 3)
        throw Error(fmt::format("background {}: expected R,G,B in [0, 1] or transparent", text));
    return {c[0], c[1], c[2], 1};
}

std::vector<OpacityPoint> opacity_from(const std::vector<std::string>& words) {
    std::vector<OpacityPoint> points;
    if (words.size() == 1 && words[0] == "off") return points;
    for (const std::string& word : words) {
        const std::size_t colon = word.find(':');
        double v = -1, opacity = -1;
        if (colon == std::string::npos || !is_number(word.substr(0, colon), &v) ||
            !is_number(word.substr(colon + 1), &opacity) || v < 0 || v > 1 || opacity < 0 ||
            opacity > 1)
            throw Error(fmt::format("opacity {}: expected V:OPACITY, both in [0, 1]", word));
        points.push_back({static_cast<float>(v), static_cast<float>(opacity)});
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const auto& a, const auto& b) { return a.v < b.v; });
    return points;
}

/// Edits of the transfer function of values.
void edit_values(const Action& action, Session& session) {
    if (session.quantity.show != Show::volume || !session.values.now())
        throw Error(fmt::format("{} needs `show volume` and `wait` before it", action.verb));
    ValueTransfer next = *session.values.now();
    const std::vector<std::string>& w = action.words;
    if (action.verb == "unit-distance") {
        next.unit_distance = number(w[0]);
    } else if (action.verb == "window") {
        next = window_transfer(number(w[0]), number(w[1]), next.unit_distance);
    } else {
        next.opacity.clear();
        for (const std::string& word : w) {
            const std::size_t colon = word.rfind(':');
            double value = 0, opacity = -1;
            if (colon == std::string::npos || !is_number(word.substr(0, colon), &value) ||
                !is_number(word.substr(colon + 1), &opacity) || opacity < 0 || opacity > 1)
                throw Error(
                    fmt::format("points {}: expected VALUE:OPACITY, opacity in [0, 1]", word));
            next.opacity.push_back({value, opacity});
        }
        std::ranges::stable_sort(next.opacity, {}, &ValueOpacity::value);
    }
    session.set_values(std::move(next));
}

}  // namespace

ScriptPlayer::ScriptPlayer(const std::filesystem::path& file)
    : name_(file.string()), actions_(read_script(file)) {}

void ScriptPlayer::feed(ImGuiIO& io) {
    const Input input = input_.empty() ? pointer_ : input_.front();
    if (!input_.empty()) {
        pointer_ = input;
        pointer_.wheel = 0, pointer_.button = pointer_.key = -1;
        pointer_.shift = pointer_.ctrl = pointer_.alt = false;
        input_.pop_front();
    }
    io.MousePos = {input.x, input.y};
    for (int n = 0; n < 3; ++n) io.MouseDown[n] = input.button == n;
    io.MouseWheel = input.wheel;
    std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
    if (input.key >= 0) io.KeysDown[input.key] = true;
    io.KeyShift = input.shift, io.KeyCtrl = input.ctrl, io.KeyAlt = input.alt;
}

void ScriptPlayer::play(Stage& stage) {
    while (next_ < actions_.size() && input_.empty() && screenshot_.empty()) {
        const Action& action = actions_[next_];
        try {
            if (!stage.session.loading.error.empty()) throw Error(stage.session.loading.error);
            // The files of the command line are opened before the first action.
            if (!started_ && stage.session.opening()) return;
            // A level is selected after all levels are known, as they define the numbers and names.
            if (!started_ && action.verb == "level" && !stage.session.loaded()) return;
            if (!started_) {
                started_ = true;
                started_s_ = steady_clock_s();
                frames_ = 0;
                start(action, stage);
            }
            ++frames_;
            if (waits(action, stage)) return;
        } catch (const Error& error) {
            throw Error(fmt::format("{}:{}: {}", name_, action.line, error.what()));
        }
        started_ = false;
        ++next_;
    }
}

bool ScriptPlayer::waits(const Action& action, Stage& stage) {
    Session& session = stage.session;
    if (action.verb == "wait") {
        if (!action.words.empty()) return steady_clock_s() - started_s_ < number(action.words[0]);
        return frames_ < 3 || !session.at_rest();
    }
    if (action.verb == "size") {
        const PixelSize requested{static_cast<int>(number(action.words[0])),
                                  static_cast<int>(number(action.words[1]))};
        if (frames_ < 3) return true;
        if (stage.screen.size() == requested) return false;
        if (steady_clock_s() - started_s_ < 5) return true;
        throw Error(fmt::format("the window has {}x{} pixels, expected {}x{}",
                                stage.screen.size().width, stage.screen.size().height,
                                requested.width, requested.height));
    }
    if (action.verb == "open") return session.opening();
    if (action.verb == "turntable" || action.verb == "steps") return session.turning();
    // A change reaches the layout a frame later, and the picture one frame after that.
    return frames_ < 3 && action.verb != "picture" && action.verb != "depth";
}

void ScriptPlayer::after_frame(const Stage& stage) {
    if (screenshot_.empty() || !input_.empty()) return;
    const PixelSize size = stage.screen.size();
    stage.screen.bind();
    Image image = read_picture(size.width, size.height);
    for (Rgba& pixel : image.pixel) pixel.a = 1;  // a window is opaque
    write_png(screenshot_, image);
    screenshot_.clear();
}

void ScriptPlayer::start(const Action& action, Stage& stage) {
    if (start_input(action, stage) || start_camera(action, stage) ||
        start_quantity(action, stage) || start_look(action, stage) || start_file(action, stage))
        return;
    Settings& s = stage.session.settings;
    const std::string& verb = action.verb;
    const std::string first = action.words.empty() ? "" : action.words[0];
    if (verb == "size") {
        stage.screen.resize(
            {static_cast<int>(number(first)), static_cast<int>(number(action.words[1]))});
    }
    if (verb == "scale") s.scale = number(first);
    if (verb == "panels") s.panels = on(first);
    if (verb == "overlay") s.overlay = on(first);
    if (verb == "window-light") s.light_window = on(first);
    if (verb == "speed") s.steps_per_second = number(first);
    if (verb == "loop") s.loop = on(first);
    if (verb == "play") stage.session.play(on(first));
    if (verb == "step") stage.session.set_step(static_cast<std::size_t>(number(first)) - 1);
    if (verb == "axes") s.axes = on(first);
    if (verb == "colorbar") s.color_bar = on(first);
    if (verb == "help") s.help = on(first);
    if (verb == "renderer") s.renderer = renderer_from(first);
    if (verb == "against") s.other = renderer_from(first);
    if (verb == "level") s.level = stage.session.level_index(joined(action.words));
    if (verb == "parts") s.pixel_error = static_cast<float>(number(first));
    if (verb == "subframes") s.subframes = static_cast<int>(number(first));
    const auto share_or_off = [&](bool& setting, float& value) {
        setting = first != "off";
        if (setting) value = static_cast<float>(number(first));
    };
    if (verb == "split") share_or_off(s.split_on, s.split);
    if (verb == "difference") share_or_off(s.difference, s.difference_limit);
}

/// Takes "ctrl+" and its kin off the front.
static std::string take_modifiers(std::string word, bool& shift, bool& ctrl, bool& alt) {
    for (bool found = true; found;) {
        found = false;
        for (const auto& [name, flag] :
             {std::pair<const char*, bool*>{"shift+", &shift}, {"ctrl+", &ctrl}, {"alt+", &alt}})
            if (word.starts_with(name))
                *flag = found = true, word = word.substr(std::string(name).size());
    }
    return word;
}

static int button_from(const std::string& name) {
    if (name == "left") return 0;
    if (name == "right") return 1;
    if (name == "middle") return 2;
    throw Error(fmt::format("no mouse button '{}', expected left, middle or right", name));
}

bool ScriptPlayer::start_input(const Action& action, Stage& stage) {
    const std::vector<std::string>& w = action.words;
    const Rect& p = stage.picture;
    Input input = pointer_;
    if (action.verb == "move") {
        input.x = place(w[0], p.x, p.width), input.y = place(w[1], p.y, p.height);
        input_.push_back(input);
    } else if (action.verb == "drag" || action.verb == "click") {
        const int button = button_from(take_modifiers(w[0], input.shift, input.ctrl, input.alt));
        input.x = place(w[1], p.x, p.width), input.y = place(w[2], p.y, p.height);
        const bool moves = action.verb == "drag";
        drag(button, input, moves ? place(w[3], p.x, p.width) : input.x,
             moves ? place(w[4], p.y, p.height) : input.y);
    } else if (action.verb == "wheel") {
        if (w.size() == 3)
            input.x = place(w[1], p.x, p.width), input.y = place(w[2], p.y, p.height);
        input_.push_back(input);
        input.wheel = static_cast<float>(number(w[0]));
        input_.push_back(input);
    } else if (action.verb == "key") {
        input.key = key_number(take_modifiers(w[0], input.shift, input.ctrl, input.alt));
        input_.push_back(input);
        input.key = -1;
        input_.push_back(input);
    } else if (action.verb == "press" || action.verb == "slide") {
        const bool slides = action.verb == "slide";
        const std::string name = slides ? w[0] : joined(w);
        const auto found = stage.gui.widgets.find(name);
        if (found == stage.gui.widgets.end()) {
            std::string names;
            for (const auto& [known, rect] : stage.gui.widgets)
                names += (names.empty() ? "" : ", ") + known;
            throw Error(fmt::format("no widget '{}' on screen (there are: {})", name, names));
        }
        const Rect& r = found->second;
        // A slider's handle stays half its width inside the frame.
        const auto share = slides ? static_cast<float>(number(w[1])) : 0.5f;
        input.x = r.x + 2 + share * (r.width - 4), input.y = r.y + 0.5f * r.height;
        drag(0, input, input.x, input.y);
    } else {
        return false;
    }
    return true;
}

void ScriptPlayer::drag(int button, Input at, float x1, float y1) {
    constexpr int kSteps = 8;
    const float x0 = at.x, y0 = at.y;
    input_.push_back(at);
    at.button = button;
    for (int n = 0; n <= kSteps; ++n) {
        const float share = static_cast<float>(n) / kSteps;
        at.x = std::lerp(x0, x1, share), at.y = std::lerp(y0, y1, share);
        input_.push_back(at);
    }
    at.button = -1;
    input_.push_back(at);
}

bool ScriptPlayer::start_camera(const Action& action, Stage& stage) {
    Session& session = stage.session;
    const std::vector<std::string>& w = action.words;
    const auto n = [&](std::size_t i) { return number(w[i]); };
    const double radius = session.radius();
    Camera& camera = session.camera;
    if (action.verb == "view") {
        if (w[0] == "fit")
            session.fit();
        else if (w[0] == "reset")
            session.reset_view();
        else
            session.set_view(w[0]);
    } else if (action.verb == "orbit") {
        camera = orbited(camera, radians(n(0)), radians(n(1)));
    } else if (action.verb == "look") {
        camera = looked_around(camera, radians(n(0)), radians(n(1)));
    } else if (action.verb == "roll") {
        camera = rolled(camera, radians(n(0)));
    } else if (action.verb == "pan") {
        camera = panned(camera, {}, {2 * n(0), 2 * n(1)}, session.aspect());
    } else if (action.verb == "zoom") {
        camera = zoomed(camera, {}, 1 / n(0), session.least_distance(), session.aspect());
    } else if (action.verb == "fly") {
        camera = flown(camera, n(0) * radius, n(1) * radius, n(2) * radius);
    } else if (action.verb == "fov") {
        camera.fov_degrees = n(0);
        frame_of(camera, 1, 1);
    } else if (action.verb == "orthographic") {
        session.set_orthographic(on(w[0]));
    } else if (action.verb == "camera") {
        camera = read_camera(w[0]);
    } else if (action.verb == "save-camera") {
        write_camera(w[0], camera);
    } else {
        return false;
    }
    return true;
}

bool ScriptPlayer::start_quantity(const Action& action, Stage& stage) {
    Session& session = stage.session;
    const std::vector<std::string>& w = action.words;
    if (action.verb == "show") {
        session.set_quantity(show_named(w[0]), w.size() > 1 ? w[1] : "");
    } else if (action.verb == "values") {
        if (w[0] == "auto") {
            session.automatic_scale();
        } else {
            if (w.size() < 2 || (w.size() > 2 && w[2] != "log"))
                throw Error(fmt::format("values {}: expected LOW HIGH [log]", joined(w)));
            if (!has_scale(session.quantity.show))
                throw Error(fmt::format("values: {} has no scale, expected `show` before",
                                        word_of(session.quantity.show)));
            const bool log = w.size() > 2;
            session.set_scale({log ? ColorScale::Kind::log : ColorScale::Kind::linear, number(w[0]),
                               number(w[1])});
        }
    } else if (action.verb == "clip") {
        const auto n = [&](std::size_t i) { return number(w[i]); };
        std::optional<Box> box;
        if (w[0] != "off" && w.size() != 6)
            throw Error(fmt::format("clip {}: expected X0 Y0 Z0 X1 Y1 Z1 or off", joined(w)));
        if (w[0] != "off") box = Box{{n(0), n(1), n(2)}, {n(3), n(4), n(5)}};
        session.set_clip(box);
    } else if (action.verb == "light") {
        session.quantity.look.light = on(w[0]);
    } else if (action.verb == "shadows") {
        session.set_shadows(on(w[0]));
    } else if (action.verb == "occlusion") {
        session.quantity.look.occlusion = on(w[0]);
    } else if (action.verb == "zup") {
        session.set_z_up(on(w[0]));
    } else if (action.verb == "unit-distance" || action.verb == "points" ||
               action.verb == "window") {
        edit_values(action, session);
    } else if (action.verb == "undo") {
        session.values.undo(session.quantity.look.lights);
    } else if (action.verb == "redo") {
        session.values.redo(session.quantity.look.lights);
    } else {
        return false;
    }
    return true;
}

bool ScriptPlayer::start_look(const Action& action, Stage& stage) {
    Session& session = stage.session;
    Look& look = session.look;
    const std::vector<std::string>& w = action.words;
    if (action.verb == "tf") {
        session.set_map(w[0]);
    } else if (action.verb == "save-tf") {
        session.save_look(w[0]);
    } else if (action.verb == "opacity") {
        look.opacity = opacity_from(w);
    } else if (action.verb == "range") {
        const double low = number(w[0]), high = number(w[1]);
        if (low >= high)
            throw Error(fmt::format("range {} {}: expected 0 <= LOW < HIGH <= 1", w[0], w[1]));
        look.low = static_cast<float>(low), look.high = static_cast<float>(high);
    } else if (action.verb == "gamma") {
        look.gamma = static_cast<float>(number(w[0]));
    } else if (action.verb == "invert") {
        look.invert = on(w[0]);
    } else if (action.verb == "blend") {
        look.shading.blend = on(w[0]);
    } else if (action.verb == "background") {
        look.shading.background = background_from(w[0]);
    } else if (action.verb == "exposure") {
        if (w[0] == "auto")
            session.auto_exposure();
        else
            look.extinction = number(w[0]);
    } else {
        return false;
    }
    session.look_changed();
    return true;
}

bool ScriptPlayer::start_file(const Action& action, Stage& stage) {
    if (action.verb == "open")
        stage.session.open(action.words);
    else if (action.verb == "screenshot")
        screenshot_ = action.words[0];
    else if (action.verb == "picture")
        stage.session.save_picture(action.words[0]);
    else if (action.verb == "depth")
        stage.session.save_depth(action.words[0]);
    else if (action.verb == "steps")
        stage.session.start_time_export(action.words[0]);
    else if (action.verb == "turntable") {
        const bool in_time = action.words.size() > 2;
        if (in_time && action.words[2] != "time")
            throw Error(fmt::format("turntable {}: expected FOLDER|FILM PICTURES [time]",
                                    joined(action.words)));
        stage.session.start_turntable(action.words[0], static_cast<int>(number(action.words[1])),
                                      in_time);
    } else
        return false;
    return true;
}

}  // namespace vog::viewer
