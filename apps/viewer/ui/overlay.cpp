// overlay.cpp: figures, colour bar, split labels and help over the picture.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "ui/handles.h"
#include "ui/palette.h"
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
        const std::size_t all = level->size(), drawn = session.left().drawn();
        ImGui::Text("%s%s Gaussians, %s",
                    drawn > 0 && drawn != all ? (count_text(drawn) + " for ").c_str() : "",
                    count_text(all).c_str(), level->name.c_str());
        const PixelSize size = session.left().size();
        const std::string way = session.left().way();
        ImGui::Text("%d x %d, %s%s, sub-frame %d of %d", size.width, size.height,
                    name_of(s.renderer), way.empty() ? "" : (" (" + way + ")").c_str(),
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
                       {at.x + size.x + pad, at.y + size.y + 0.5f * pad}, kGround, pad);
    list.AddText(at, kInk, text.c_str());
}

/// Colours, ends and title of a colour bar.
struct Bar {
    std::string title;
    std::function<Rgba(float share)> color;
    std::function<double(double share)> value;  ///< at a share of the bar
};

Bar bar_of(const Session& session) {
    const Settings& settings = session.settings;
    const Quantity& quantity = session.quantity;
    if (settings.difference) {
        const std::string of = quantity.show == Show::depth    ? "V"
                               : quantity.show == Show::volume ? "colour"
                                                               : "share of the scale";
        const double limit = double{settings.difference_limit};
        static const TransferFunction kSigned{"",
                                              {{0, 0.231f, 0.298f, 0.753f},
                                               {0.5f, 0.8667f, 0.8667f, 0.8667f},
                                               {1, 0.706f, 0.016f, 0.149f}},
                                              {}};
        return {
            fmt::format("{} of {} - {}", of, name_of(settings.renderer), name_of(settings.other)),
            [](float share) { return color_at(kSigned, share); },
            [=](double share) { return (2 * share - 1) * limit; }};
    }
    const std::string title = label_of(quantity, session.fields());
    if (quantity.show == Show::volume && session.values.now()) {
        const auto transfer = session.values.now();
        const ValueRange range = range_of(*transfer);
        const auto value = [=](double share) { return std::lerp(range.lower, range.upper, share); };
        return {title,
                [=](float share) {
                    const ValueLight light = light_of(*transfer, value(double{share}));
                    return Rgba{static_cast<float>(light.r), static_cast<float>(light.g),
                                static_cast<float>(light.b), 1};
                },
                value};
    }
    const bool scaled = has_scale(quantity.show);
    const TransferFunction tf =
        scaled ? map_function(session.look) : transfer_function(session.look);
    const ColorScale scale = session.scale;
    return {title, [=](float share) { return color_at(tf, share); },
            [=](double share) {
                if (!scaled) return share;
                return scale.kind == ColorScale::Kind::log
                           ? scale.low * std::pow(scale.high / scale.low, share)
                           : std::lerp(scale.low, scale.high, share);
            }};
}

void draw_color_bar(const Session& session, const Layout& layout) {
    const float ui = layout.ui, line = ImGui::GetFontSize();
    const float width = std::min(260 * ui, layout.picture.width - 40 * ui), height = 14 * ui;
    if (width < 60 * ui || layout.picture.height < 120 * ui) return;
    const float x = layout.picture.x + 16 * ui;
    const float y = layout.picture.y + layout.picture.height - height - 2 * line - 14 * ui;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const float pad = 8 * ui;
    const Bar bar = bar_of(session);
    const float title_width = ImGui::CalcTextSize(bar.title.c_str()).x;
    list.AddRectFilled({x - pad, y - line - 1.2f * pad},
                       {x + std::max(width, title_width) + pad, y + height + line + pad}, kGround,
                       4 * ui);
    constexpr int kPieces = 128;
    for (int n = 0; n < kPieces; ++n) {
        const Rgba c = bar.color((static_cast<float>(n) + 0.5f) / kPieces);
        list.AddRectFilled({x + width * static_cast<float>(n) / kPieces, y},
                           {x + width * static_cast<float>(n + 1) / kPieces, y + height},
                           ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}));
    }
    list.AddText({x, y - line - 3 * ui}, kInk, bar.title.c_str());
    // The ends first; numbers between them where there is room.
    float from = x, to = x + width;
    for (const int n : {0, 4, 1, 3, 2}) {
        const float share = static_cast<float>(n) / 4;
        const std::string text = fmt::format("{:.3g}", bar.value(double{share}));
        const float w = ImGui::CalcTextSize(text.c_str()).x;
        const float at = x + share * width;
        const float begin = std::clamp(at - 0.5f * w, x, x + width - w), gap = 5 * ui;
        list.AddLine({at, y + height}, {at, y + height + 3 * ui}, kInk);
        if (begin < from || begin + w > to) continue;
        list.AddText({begin, y + height + 3 * ui}, kInk, text.c_str());
        if (n < 2) from = std::max(from, begin + w + gap);
        if (n > 2) to = std::min(to, begin - gap);
    }
}

/// Number at the pointer, beside it.
void draw_probe(const Session& session, const Layout& layout) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse || ImGui::IsAnyMouseDown() ||
        !layout.picture.holds(io.MousePos.x, io.MousePos.y))
        return;
    const Probed probed =
        session.probe(double{(io.MousePos.x - layout.picture.x) / layout.picture.width},
                      double{(io.MousePos.y - layout.picture.y) / layout.picture.height});
    if (probed.text.empty()) return;
    const ImVec2 size = ImGui::CalcTextSize(probed.text.c_str());
    const float right = layout.picture.x + layout.picture.width - size.x - 8 * layout.ui;
    const float x = std::max(layout.picture.x, std::min(io.MousePos.x + 14 * layout.ui, right));
    const float below = layout.picture.y + layout.picture.height - size.y - 8 * layout.ui;
    draw_text({x, std::min(io.MousePos.y + 14 * layout.ui, below)}, probed.text);
}

/// World axes at the lower right.
void draw_axes(const Session& session, const Layout& layout) {
    const float ui = layout.ui, length = 28 * ui, letter = 37 * ui;
    const ImVec2 at{layout.picture.x + layout.picture.width - 52 * ui,
                    layout.picture.y + layout.picture.height - 52 * ui};
    if (layout.picture.width < 200 * ui || layout.picture.height < 160 * ui) return;
    const CameraFrame frame = frame_of(session.camera, 16, 16);
    struct Axis {
        Vec3d along;
        const char* name;
        ImU32 color;
    };
    Axis axes[] = {{{1, 0, 0}, "x", IM_COL32(255, 120, 110, 255)},
                   {{0, 1, 0}, "y", IM_COL32(130, 220, 120, 255)},
                   {{0, 0, 1}, "z", IM_COL32(120, 170, 255, 255)}};
    // Those that point away first.
    std::ranges::sort(axes, std::greater{},
                      [&](const Axis& axis) { return dot(axis.along, frame.forward); });
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddCircleFilled(at, 46 * ui, kGround);
    for (const Axis& axis : axes) {
        const auto place = [&](float reach) {
            return ImVec2{at.x + reach * static_cast<float>(dot(axis.along, frame.right)),
                          at.y - reach * static_cast<float>(dot(axis.along, frame.up))};
        };
        list.AddLine(at, place(length), axis.color, 2 * ui);
    }
    // Letters over all lines; that of an axis along the view has a ground of its own.
    for (const Axis& axis : axes) {
        const auto right = static_cast<float>(dot(axis.along, frame.right));
        const auto up = static_cast<float>(dot(axis.along, frame.up));
        const ImVec2 size = ImGui::CalcTextSize(axis.name);
        const ImVec2 middle{at.x + letter * right, at.y - letter * up};
        if (std::hypot(right, up) * letter < 0.5f * size.y + length)
            list.AddCircleFilled(middle, 0.5f * size.y, IM_COL32(0, 0, 0, 255));
        list.AddText({middle.x - 0.5f * size.x, middle.y - 0.5f * size.y}, kInk, axis.name);
    }
}

/// A length at the depth of the point looked at, 1, 2 or 5 times a power of ten.
void draw_scale_bar(const Session& session, const Layout& layout) {
    const float ui = layout.ui;
    if (layout.picture.width < 200 * ui || layout.picture.height < 160 * ui) return;
    const double most = std::min(160.0 * double{ui}, 0.3 * double{layout.picture.width});
    const CameraFrame frame = frame_of(session.camera, static_cast<int>(layout.picture.width),
                                       static_cast<int>(layout.picture.height));
    const double depth = dot(session.camera.look_at - session.camera.eye, frame.forward);
    const double per_unit = frame.pixels_at(depth);
    if (!(per_unit > 0) || most < 40) return;
    const double power = std::pow(10, std::floor(std::log10(most / per_unit)));
    double world = power;
    for (const double factor : {2.0, 5.0})
        if (factor * power * per_unit <= most) world = factor * power;
    const auto width = static_cast<float>(world * per_unit);
    const std::string text = fmt::format("{:.4g}", world);
    const float right = layout.picture.x + layout.picture.width - 110 * ui;
    const float y = layout.picture.y + layout.picture.height - 18 * ui;
    const float line = ImGui::GetFontSize(), pad = 6 * ui;
    const float text_width = ImGui::CalcTextSize(text.c_str()).x;
    // Room is left to the colour bar.
    if (right - width < layout.picture.x + 300 * ui) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const float left = right - std::max(width, text_width);
    list.AddRectFilled({left - pad, y - line - 2 * pad}, {right + pad, y + pad}, kGround, 4 * ui);
    list.AddRectFilled({right - width, y - 2 * ui}, {right, y + 2 * ui}, kInk);
    list.AddText({right - 0.5f * (width + text_width), y - line - 1.2f * pad}, kInk, text.c_str());
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
            ImGui::TextColored(notices(session.settings.light_window).key, "%s  ", help.keys);
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
    const Settings& s = session.settings;
    if (s.color_bar && !session.shows_layers()) draw_color_bar(session, layout);
    if (!session.scene.levels.empty()) {
        draw_clip_box(session, layout);
        draw_light(session, layout);
        if (s.overlay && s.axes) {
            draw_axes(session, layout);
            draw_scale_bar(session, layout);
            draw_probe(session, layout);
        }
    }
    if (session.settings.overlay) draw_figures(session, gui, layout);
    if (session.settings.help) draw_help(session, layout);
}

}  // namespace vog::viewer
