// play_bar.cpp: the bar of steps in time below the picture.
#include <fmt/core.h>
#include <imgui.h>

#include "ui/panels.h"

namespace vog::viewer {

void draw_play_bar(Session& session, Gui& gui, const Layout& layout) {
    if (layout.play.width <= 0) return;
    const float ui = layout.ui;
    ImGui::SetNextWindowPos({layout.play.x, layout.play.y});
    ImGui::SetNextWindowSize({layout.play.width, layout.play.height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8 * ui, 4 * ui});
    ImGui::Begin("time", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    const std::size_t count = session.step_count();
    const auto button = [&](const char* label, const char* name, const auto& action) {
        if (ImGui::Button(label)) attempt(session, action);
        mark(gui, name);
        ImGui::SameLine(0, 4 * ui);
    };
    button("<", "step back", [&] { session.set_step((session.step() + count - 1) % count); });
    button(session.playing() ? "pause" : "play", "play", [&] { session.play(!session.playing()); });
    button(">", "step on", [&] { session.set_step((session.step() + 1) % count); });
    int step = static_cast<int>(session.step()) + 1;
    const float rest = 300 * ui;
    ImGui::SetNextItemWidth(std::max(60 * ui, ImGui::GetContentRegionAvail().x - rest));
    const std::string text = fmt::format("{} of {}", step, count);
    if (ImGui::SliderInt("##step", &step, 1, static_cast<int>(count), text.c_str(),
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput))
        attempt(session, [&] { session.set_step(static_cast<std::size_t>(step - 1)); });
    mark(gui, "step");
    ImGui::SameLine(0, 8 * ui);
    auto speed = static_cast<float>(session.settings.steps_per_second);
    ImGui::SetNextItemWidth(130 * ui);
    if (ImGui::SliderFloat("##speed", &speed, 0.25f, 60, "%.3g steps/s",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        session.settings.steps_per_second = double{speed};
    mark(gui, "speed");
    ImGui::SameLine(0, 8 * ui);
    ImGui::Checkbox("loop", &session.settings.loop);
    mark(gui, "loop");
    ImGui::SameLine(0, 8 * ui);
    ImGui::TextDisabled("%d ahead", static_cast<int>(session.steps_ahead()));
    ImGui::End();
}

}  // namespace vog::viewer
