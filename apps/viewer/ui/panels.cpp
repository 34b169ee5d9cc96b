// panels.cpp: the panel on the right and the status line.
#include "ui/panels.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "ui/palette.h"
#include "vog/text.h"

namespace vog::viewer {

namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus;

/// Selector of the renderers that support the open data.
void choose_renderer(Session& session, Gui& gui, const char* label, WindowRenderer& renderer) {
    if (ImGui::BeginCombo(label, name_of(renderer))) {
        for (const WindowRenderer r : renderers()) {
            if (r == WindowRenderer::voxels && !session.scene.voxels) continue;
            if (ImGui::Selectable(name_of(r), r == renderer)) renderer = r;
        }
        ImGui::EndCombo();
    }
    mark(gui, label);
}

std::string level_text(const Level& level, const std::string& unit) {
    std::string text = count_text(level.size()) + " Gaussians";
    if (level.share > 0) text += fmt::format(", {:.3g} % of the {}", 100 * level.share, unit);
    return text;
}

void draw_level(Session& session, Gui& gui) {
    const std::vector<Level>& levels = session.scene.levels;
    if (levels.empty()) return;
    const int last = static_cast<int>(levels.size()) - 1;
    Settings& s = session.settings;
    int level = s.level < 0 ? last : std::min(s.level, last);
    const Level& now = levels[static_cast<std::size_t>(level)];
    if (last > 0) {
        std::string format = now.name;  // used as a format string: its % is doubled
        if (const std::size_t at = format.find('%'); at != std::string::npos)
            format.insert(at, 1, '%');
        if (ImGui::SliderInt("level", &level, 0, last, format.c_str(),
                             ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
            s.level = level == last ? -1 : level;
        mark(gui, "level");
    } else {
        ImGui::TextWrapped("%s %s", now.name.c_str(), now.made_by.c_str());
    }
    ImGui::TextUnformatted(level_text(now, session.scene.unit).c_str());
    if (std::isinf(now.psnr_db))
        ImGui::Text("V equals that of the %s in 8 bits", session.scene.unit.c_str());
    else if (!std::isnan(now.psnr_db))
        ImGui::Text("PSNR of V %.1f dB against the %s", now.psnr_db, session.scene.unit.c_str());
    else if (levels.size() > 1)
        ImGui::TextDisabled("not measured yet");
}

void draw_picture_section(Session& session, Gui& gui) {
    Settings& s = session.settings;
    choose_renderer(session, gui, "renderer", s.renderer);
    ImGui::Checkbox("split", &s.split_on);
    mark(gui, "split");
    ImGui::SameLine();
    ImGui::Checkbox("difference", &s.difference);
    mark(gui, "difference");
    ImGui::SameLine();
    ImGui::Checkbox("coarse moving", &s.coarse_moving);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Draw fewer, larger Gaussians while the camera moves and frames are slow");
    if (s.split_on || s.difference) choose_renderer(session, gui, "against", s.other);
    const Show show = session.quantity.show;
    if (s.difference)
        ImGui::SliderFloat("ends at", &s.difference_limit, 0.001f, 1,
                           show == Show::depth    ? "%.3f of V"
                           : show == Show::volume ? "%.3f of a colour"
                                                  : "%.3f of the scale",
                           ImGuiSliderFlags_Logarithmic);
    draw_level(session, gui);
    ImGui::SliderFloat("parts", &s.pixel_error, 0, 16, "%.2g pixels", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Level of detail: groups of Gaussians smaller than this on screen are drawn as one\n"
            "(OpenGL and CPU splat); 0: every Gaussian is drawn");
    mark(gui, "parts");
    ImGui::SetNextItemWidth(0.3f * ImGui::GetContentRegionAvail().x);
    ImGui::SliderInt("sub-frames", &s.subframes, 1, 256, "%d", ImGuiSliderFlags_Logarithmic);
    mark(gui, "sub-frames");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize("scale ").x);
    if (ImGui::BeginCombo("scale", fmt::format("{:g}", s.scale).c_str())) {
        for (const double scale : {0.25, 0.5, 1.0, 2.0})
            if (ImGui::Selectable(fmt::format("{:g}", scale).c_str(), s.scale == scale))
                s.scale = scale;
        ImGui::EndCombo();
    }
}

void draw_camera_section(Session& session, Gui& gui, float ui) {
    if (session.scene.levels.empty()) return;
    const auto button = [&](const char* label, const auto& action) {
        if (ImGui::Button(label)) attempt(session, action);
        mark(gui, label);
    };
    for (const char* view : {"paper", "+x", "-x", "+y", "-y", "+z", "-z"}) {
        if (view != std::string("paper")) ImGui::SameLine(0, 4 * ui);
        button(view, [&] { session.set_view(view); });
    }
    button("fit", [&] { session.fit(); });
    ImGui::SameLine(0, 4 * ui);
    button("reset", [&] { session.reset_view(); });
    ImGui::SameLine(0, 4 * ui);
    button("copy as request", [&] { session.copy_request(); });
    bool orthographic = session.camera.orthographic();
    if (ImGui::Checkbox("orthographic", &orthographic)) session.set_orthographic(orthographic);
    mark(gui, "orthographic");
    ImGui::SameLine(0, 12 * ui);
    bool z_up = session.up() == Vec3d{0, 0, 1};
    if (ImGui::Checkbox("z up", &z_up)) session.set_z_up(z_up);
    mark(gui, "z up");
    if (orthographic) {
        ImGui::Text("width %.4g", session.camera.orthographic_width);
    } else {
        auto fov = static_cast<float>(session.camera.fov_degrees);
        if (ImGui::SliderFloat("field of view", &fov, 1, 150, "%.1f degrees",
                               ImGuiSliderFlags_Logarithmic))
            session.camera.fov_degrees = static_cast<double>(fov);
    }
    ImGui::InputText("##camera", &gui.camera_path);
    ImGui::SameLine(0, 4 * ui);
    button("load##camera", [&] { session.camera = read_camera(gui.camera_path); });
    ImGui::SameLine(0, 4 * ui);
    button("save##camera", [&] {
        write_camera(gui.camera_path, session.camera);
        session.show_message("wrote " + gui.camera_path);
    });
}

void draw_file_section(Session& session, Gui& gui, float ui, Requests& requests) {
    if (ImGui::Button("screenshot")) requests.screenshot = true;
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("picture")) requests.picture = true;
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("as EXR")) requests.depth = true;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("T, or the numbers of the shown quantity");
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::SetNextItemWidth(0.34f * width);
    ImGui::InputText("##turntable", &gui.turntable_path);
    ImGui::SameLine(0, 4 * ui);
    ImGui::SetNextItemWidth(0.28f * width);
    ImGui::SliderInt("##pictures", &gui.turntable_frames, 2, 720, "%d pictures",
                     ImGuiSliderFlags_Logarithmic);
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button(session.turning() ? "turning" : "turntable") && !session.turning())
        attempt(session, [&] {
            session.start_turntable(gui.turntable_path, gui.turntable_frames,
                                    gui.turntable_in_time && session.step_count() > 0);
        });
    if (session.step_count() > 0) {
        ImGui::Checkbox("turn through time", &gui.turntable_in_time);
        mark(gui, "turn through time");
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("All steps, one after the other, during the turn");
        ImGui::SameLine(0, 8 * ui);
        if (ImGui::Button("save all steps") && !session.turning())
            attempt(session, [&] { session.start_time_export(gui.turntable_path); });
        mark(gui, "save all steps");
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("To a folder of PNG, or a film: NAME.mp4, NAME.webm (needs ffmpeg)");
    ImGui::Checkbox("light window", &session.settings.light_window);
    mark(gui, "light window");
    if (!gui.recent.sets().empty() && ImGui::BeginCombo("##recent", "recent files")) {
        // Names may be equal: paths tell them apart.
        for (const std::vector<std::string>& set : gui.recent.sets()) {
            ImGui::PushID(set.front().c_str());
            if (ImGui::Selectable(set_name(set).c_str())) {
                const std::vector<std::string> files = set;
                attempt(session, [&] { session.open(files); });
            }
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", set.front().c_str());
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    ImGui::InputTextWithHint("##open", "file to open, or drop one here", &gui.open_path);
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("open") && !gui.open_path.empty())
        attempt(session, [&] { session.open({gui.open_path}); });
}

void draw_status(const Session& session, const Layout& layout) {
    ImGui::SetNextWindowPos({layout.status.x, layout.status.y});
    ImGui::SetNextWindowSize({layout.status.width, layout.status.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8 * layout.ui, 4 * layout.ui});
    ImGui::Begin("status", nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
    ImGui::PopStyleVar();
    std::string right = session.scene.title;
    if (!session.scene.facts.empty()) right += ": " + session.scene.facts;
    const float right_width = ImGui::CalcTextSize(right.c_str()).x;
    const float room = layout.status.width - right_width - 32 * layout.ui;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::PushClipRect(at, {at.x + room, at.y + layout.status.height}, true);
    const Notices ink = notices(session.settings.light_window);
    if (session.failed) {
        ImGui::TextColored(ink.error, "%s", session.message.c_str());
    } else if (session.loading.busy) {
        ImGui::TextColored(ink.progress, "%s  %.0f %%", session.loading.doing.c_str(),
                           100 * session.loading.fraction);
    } else {
        ImGui::TextUnformatted(session.message.c_str());
    }
    ImGui::PopClipRect();
    ImGui::SameLine(layout.status.width - right_width - 8 * layout.ui);
    ImGui::TextUnformatted(right.c_str());
    ImGui::End();
}

}  // namespace

Layout layout_of(float width, float height, float ui, bool panels, bool steps) {
    if (!panels) return {{0, 0, width, height}, {}, {}, {}, ui};
    const float panel = std::min(350 * ui, 0.5f * width), status = 26 * ui;
    const float play = steps ? 34 * ui : 0, below = height - status;
    return {{0, 0, width - panel, below - play},
            {width - panel, 0, panel, below},
            {0, below, width, status},
            steps ? Rect{0, below - play, width - panel, play} : Rect{},
            ui};
}

void mark(Gui& gui, const std::string& name) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    gui.widgets[name] = {low.x, low.y, high.x - low.x, high.y - low.y};
}

void set_style(float ui, bool light) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = {};
    // Texts have 4.5 times the luminance of their grounds, or a 4.5th (WCAG 2.2 AA), where ImGui's own have less.
    if (light) {
        ImGui::StyleColorsLight(&style);
        style.Colors[ImGuiCol_TextDisabled] = {0.36f, 0.36f, 0.36f, 1};
    } else {
        ImGui::StyleColorsDark(&style);
        style.Colors[ImGuiCol_TextDisabled] = {0.64f, 0.64f, 0.64f, 1};
        const ImVec4 under_pointer{0.18f, 0.42f, 0.70f, 1}, pressed{0.13f, 0.37f, 0.66f, 1};
        for (const ImGuiCol n : {ImGuiCol_ButtonHovered, ImGuiCol_HeaderHovered,
                                 ImGuiCol_SliderGrabActive, ImGuiCol_SliderGrab})
            style.Colors[n] = under_pointer;
        for (const ImGuiCol n : {ImGuiCol_ButtonActive, ImGuiCol_HeaderActive})
            style.Colors[n] = pressed;
    }
    style.WindowBorderSize = 0;
    style.FrameRounding = style.GrabRounding = 3;
    style.WindowRounding = 4;
    style.ItemSpacing = {6, 4};
    style.ScaleAllSizes(ui);
}

void draw_panels(Session& session, Gui& gui, const Layout& layout, Requests& requests) {
    gui.widgets.clear();
    draw_overlays(session, gui, layout);
    draw_play_bar(session, gui, layout);
    if (layout.panel.width <= 0) return;
    ImGui::SetNextWindowPos({layout.panel.x, layout.panel.y});
    ImGui::SetNextWindowSize({layout.panel.width, layout.panel.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("panel", nullptr, kFixed);
    ImGui::PushItemWidth(0.62f * ImGui::GetContentRegionAvail().x);
    const auto section = [](const char* name) {
        return ImGui::CollapsingHeader(name, ImGuiTreeNodeFlags_DefaultOpen);
    };
    if (section("Picture")) draw_picture_section(session, gui);
    if (!session.scene.levels.empty() && section("Quantity")) draw_quantity(session, gui);
    if (section("Colour")) {
        if (session.shows_layers())
            draw_layers(session, gui);
        else if (session.quantity.show == Show::volume && session.values.now())
            draw_values(session, gui, layout.ui);
        else
            draw_look(session, gui, layout.ui);
    }
    if (section("Camera")) draw_camera_section(session, gui, layout.ui);
    if (section("Files")) draw_file_section(session, gui, layout.ui, requests);
    ImGui::PopItemWidth();
    ImGui::End();
    draw_status(session, layout);
    ImGui::PopStyleVar();
}

}  // namespace vog::viewer
