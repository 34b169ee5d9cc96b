// overlay.cpp: figures, colour bar, split labels and help over the picture.
#include <fmt/core.h>
#include <imgui.h>

#include <cmath>

#include "ui/panels.h"
#include "vog/text.h"

namespace vog::viewer {

namespace {

constexpr ImGuiWindowFlags kGlass =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_AlwaysAutoResize |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;

void draw_figures(Session& session, const Gui& gui, const Layout& layout) {
    ImGui::SetNextWindowPos({layout.picture.x + 10 * layout.ui, layout.picture.y + 10 * layout.ui});
    ImGui::SetNextWindowBgAlpha(0.65f);
    // Minimum width: the window follows its text a frame late.
    ImGui::SetNextWindowSizeConstraints({390 * layout.ui, 0}, {390 * layout.ui, 200 * layout.ui});
    ImGui::Begin("figures", nullptr, kGlass);
    const Measured& m = session.measured;
    ImGui::Text("%.1f frames/s, %.1f ms", gui.fps, m.frame_ms);
    ImGui::Text("render %.2f ms, shade %.2f ms, window %.2f ms", session.left().ms(), m.shade_ms,
                m.gui_ms);
    const Settings& s = session.settings;
    if (const Level* level = session.shown_level()) {
        const std::size_t all = level->model->size(), drawn = session.left().drawn();
        ImGui::Text("%s%s Gaussians, %s",
                    drawn > 0 && drawn != all ? (count_text(drawn) + " for ").c_str() : "",
                    count_text(all).c_str(), level->name.c_str());
        const PixelSize size = session.left().size();
        ImGui::Text("%d x %d, %s, sub-frame %d of %d", size.width, size.height, name_of(s.renderer),
                    session.left().subframes(),
                    session.left().complete() ? session.left().subframes() : s.subframes);
    } else {
        ImGui::TextUnformatted(session.loading.busy ? "opening"
                                                    : "nothing is open: drop a file here");
    }
    ImGui::End();
}

/// Draws text that is legible on any colour.
void draw_text(ImVec2 at, const std::string& text) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float pad = 0.25f * size.y;
    list.AddRectFilled({at.x - pad, at.y - 0.5f * pad},
                       {at.x + size.x + pad, at.y + size.y + 0.5f * pad}, IM_COL32(0, 0, 0, 150),
                       pad);
    list.AddText(at, IM_COL32(240, 240, 240, 255), text.c_str());
}

void draw_color_bar(const Session& session, const Layout& layout) {
    const float ui = layout.ui, line = ImGui::GetFontSize();
    const float width = std::min(260 * ui, layout.picture.width - 40 * ui), height = 14 * ui;
    if (width < 60 * ui || layout.picture.height < 120 * ui) return;
    const float x = layout.picture.x + 16 * ui;
    const float y = layout.picture.y + layout.picture.height - height - 2 * line - 14 * ui;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const float pad = 8 * ui;
    list.AddRectFilled({x - pad, y - line - 1.2f * pad}, {x + width + pad, y + height + line + pad},
                       IM_COL32(0, 0, 0, 165), 4 * ui);
    const bool difference = session.settings.difference;
    const TransferFunction tf = difference ? TransferFunction{"",
                                                              {{0, 0.231f, 0.298f, 0.753f},
                                                               {0.5f, 0.8667f, 0.8667f, 0.8667f},
                                                               {1, 0.706f, 0.016f, 0.149f}},
                                                              {}}
                                           : transfer_function(session.look);
    constexpr int kPieces = 128;
    for (int n = 0; n < kPieces; ++n) {
        const Rgba c = color_at(tf, (static_cast<float>(n) + 0.5f) / kPieces);
        list.AddRectFilled({x + width * static_cast<float>(n) / kPieces, y},
                           {x + width * static_cast<float>(n + 1) / kPieces, y + height},
                           ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}));
    }
    const ImU32 ink = IM_COL32(240, 240, 240, 255);
    const std::string title =
        difference ? fmt::format("V of {} - V of {}", name_of(session.settings.renderer),
                                 name_of(session.settings.other))
                   : std::string("V = 1 - exp(-T)");
    list.AddText({x, y - line - 3 * ui}, ink, title.c_str());
    for (int n = 0; n <= 4; ++n) {
        const float share = static_cast<float>(n) / 4;
        const float value =
            difference ? (2 * share - 1) * session.settings.difference_limit : share;
        const std::string text = fmt::format("{:.3g}", value);
        const float w = ImGui::CalcTextSize(text.c_str()).x;
        const float at = x + share * width;
        list.AddLine({at, y + height}, {at, y + height + 3 * ui}, ink);
        list.AddText({std::clamp(at - 0.5f * w, x, x + width - w), y + height + 3 * ui}, ink,
                     text.c_str());
    }
}

void draw_split(Session& session, const Layout& layout) {
    const Settings& s = session.settings;
    if (!s.split_on || s.difference) return;
    const float ui = layout.ui, x = layout.picture.x + s.split * layout.picture.width;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddLine({x, layout.picture.y}, {x, layout.picture.y + layout.picture.height},
                 IM_COL32(255, 255, 255, 200), 2 * ui);
    const float middle = layout.picture.y + 0.5f * layout.picture.height;
    list.AddCircleFilled({x, middle}, 7 * ui, IM_COL32(255, 255, 255, 230));
    // Below the figures at the top left.
    const float y = layout.picture.y + layout.picture.height - 1.6f * ImGui::GetFontSize();
    const std::string left = name_of(s.renderer), right = name_of(s.other);
    const float w = ImGui::CalcTextSize(left.c_str()).x;
    const float right_w = ImGui::CalcTextSize(right.c_str()).x;
    const float gap = 10 * ui;
    if (x - w - gap > layout.picture.x + (s.color_bar ? 300 * ui : 0))
        draw_text({x - w - gap, y}, left);
    if (x + gap + right_w < layout.picture.x + layout.picture.width) draw_text({x + gap, y}, right);
}

void draw_help(Session& session, const Layout& layout) {
    ImGui::SetNextWindowPos({layout.picture.x + 0.5f * layout.picture.width,
                             layout.picture.y + 0.5f * layout.picture.height},
                            ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowBgAlpha(0.93f);
    ImGui::SetNextWindowFocus();
    ImGui::Begin("Help", &session.settings.help,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) {
        for (const KeyHelp& help : key_help()) {
            ImGui::TableNextColumn();
            ImGui::TextColored({1, 0.85f, 0.5f, 1}, "%s  ", help.keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(help.effect);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace

void draw_overlays(Session& session, Gui& gui, const Layout& layout) {
    draw_split(session, layout);
    if (session.settings.color_bar) draw_color_bar(session, layout);
    if (session.settings.overlay) draw_figures(session, gui, layout);
    if (session.settings.help) draw_help(session, layout);
}

}  // namespace vog::viewer
