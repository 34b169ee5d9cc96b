// look_panel.cpp: transfer function editor; its changes are shaded, not rendered again.
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "ui/handles.h"
#include "ui/panels.h"

namespace vog::viewer {

namespace {

/// Editor of opacity points over the histogram of V: drag moves, double-click adds, right-click
/// removes.
class OpacityEditor {
  public:
    OpacityEditor(Session& session, Gui& gui, ImVec2 at, ImVec2 size, float ui)
        : session_(session), gui_(gui), at_(at), size_(size), ui_(ui) {}

    bool edit() {
        std::vector<OpacityPoint>& points = session_.look.opacity;
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const bool over = ImGui::IsItemHovered();
        const int near = over ? nearest(mouse) : -1;
        if (over && ImGui::IsMouseDoubleClicked(0) && near < 0) return add(mouse);
        if (over && ImGui::IsMouseClicked(0)) gui_.dragged_point = near;
        if (!ImGui::IsMouseDown(0)) gui_.dragged_point = -1;
        if (over && ImGui::IsMouseClicked(1) && near >= 0) {
            points.erase(points.begin() + near);
            if (points.size() < 2) points.clear();  // fewer than two points: opaque
            return true;
        }
        const int dragged = gui_.dragged_point;
        if (dragged < 0 || dragged >= static_cast<int>(points.size())) return false;
        const auto n = static_cast<std::size_t>(dragged);
        const OpacityPoint before = points[n];
        const float low = n > 0 ? points[n - 1].v : 0.0f;
        const float high = n + 1 < points.size() ? points[n + 1].v : 1.0f;
        points[n] = {std::clamp(v_of(mouse.x), low, high), opacity_of(mouse.y)};
        return before.v != points[n].v || before.opacity != points[n].opacity;
    }

    void draw() const {
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled(at_, {at_.x + size_.x, at_.y + size_.y}, IM_COL32(18, 18, 20, 255));
        const std::vector<float>& share = session_.histogram;
        const auto bins = static_cast<float>(share.size());
        for (std::size_t n = 0; n < share.size(); ++n) {
            // Logarithmic scale from 1e-5 of the pixels to all.
            const float height =
                std::clamp(1 + std::log10(std::max(share[n], 1e-30f)) / 5, 0.0f, 1.0f);
            const float x0 = at_.x + size_.x * static_cast<float>(n) / bins;
            const float x1 = at_.x + size_.x * static_cast<float>(n + 1) / bins;
            list.AddRectFilled({x0, at_.y + size_.y * (1 - height)}, {x1, at_.y + size_.y},
                               IM_COL32(90, 100, 120, 255));
        }
        const std::vector<OpacityPoint>& points = session_.look.opacity;
        const ImU32 line = IM_COL32(255, 220, 120, 255);
        if (points.empty()) {
            list.AddLine(place({0, 1}), place({1, 1}), line, 1.5f * ui_);
            return;
        }
        list.AddLine(place({0, points.front().opacity}), place(points.front()), line, 1.5f * ui_);
        for (std::size_t n = 1; n < points.size(); ++n)
            list.AddLine(place(points[n - 1]), place(points[n]), line, 1.5f * ui_);
        list.AddLine(place(points.back()), place({1, points.back().opacity}), line, 1.5f * ui_);
        for (const OpacityPoint& point : points)
            list.AddCircleFilled(place(point), 4 * ui_, IM_COL32(255, 255, 255, 255));
    }

  private:
    float v_of(float x) const { return std::clamp((x - at_.x) / size_.x, 0.0f, 1.0f); }
    float opacity_of(float y) const { return std::clamp(1 - (y - at_.y) / size_.y, 0.0f, 1.0f); }
    ImVec2 place(const OpacityPoint& p) const {
        return {at_.x + size_.x * p.v, at_.y + size_.y * (1 - p.opacity)};
    }
    int nearest(ImVec2 mouse) const {
        int best = -1;
        float least = 9 * ui_;
        for (std::size_t n = 0; n < session_.look.opacity.size(); ++n) {
            const ImVec2 p = place(session_.look.opacity[n]);
            const float distance = std::hypot(p.x - mouse.x, p.y - mouse.y);
            if (distance < least) best = static_cast<int>(n), least = distance;
        }
        return best;
    }
    bool add(ImVec2 mouse) {
        std::vector<OpacityPoint>& points = session_.look.opacity;
        if (points.empty()) points = {{0, 1}, {1, 1}};
        const OpacityPoint point{v_of(mouse.x), opacity_of(mouse.y)};
        const auto after = std::upper_bound(points.begin(), points.end(), point,
                                            [](const auto& a, const auto& b) { return a.v < b.v; });
        points.insert(after, point);
        return true;
    }

    Session& session_;
    Gui& gui_;
    ImVec2 at_, size_;
    float ui_;
};

bool edit_opacity(Session& session, Gui& gui, float ui) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 90 * ui};
    ImGui::InvisibleButton("opacity", size);
    mark(gui, "opacity");
    OpacityEditor editor(session, gui, at, size, ui);
    const bool changed = editor.edit();
    editor.draw();
    if (ImGui::IsItemHovered() && gui.dragged_point < 0)
        ImGui::SetTooltip(
            "Opacity over V = 1 - exp(-T), with the histogram of V (log scale)\n"
            "double-click: add a point; drag: move; right-click: remove");
    const ImVec2 strip = ImGui::GetCursorScreenPos();
    ImGui::Dummy({size.x, 12 * ui});
    const TransferFunction tf = transfer_function(session.look);
    draw_strip(strip.x, strip.y, size.x, 12 * ui, [&](float v) { return color_at(tf, v); });
    return changed;
}

bool edit_exposure(Session& session, Gui& gui) {
    bool changed = false;
    // In stops (powers of 2) from the automatic value, as densities come in any unit.
    Look& look = session.look;
    auto stops = static_cast<float>(std::log2(look.extinction / session.automatic_extinction));
    const std::string text = fmt::format("extinction {:.4g}", look.extinction);
    if (ImGui::SliderFloat("exposure", &stops, -6, 6, text.c_str(), ImGuiSliderFlags_NoInput)) {
        look.extinction = session.automatic_extinction * std::exp2(static_cast<double>(stops));
        changed = true;
    }
    mark(gui, "exposure");
    if (ImGui::Button("auto")) session.auto_exposure();
    mark(gui, "auto");
    ImGui::SameLine();
    ImGui::Checkbox("follow", &session.settings.follow_exposure);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Set the extinction automatically for every view");
    ImGui::SameLine();
    return changed;
}

}  // namespace

bool edit_background(Look& look) {
    ShadeOptions& shading = look.shading;
    float rgb[3] = {shading.background.r, shading.background.g, shading.background.b};
    bool changed = ImGui::ColorEdit3("background", rgb,
                                     ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
    bool clear = shading.background.a == 0;
    ImGui::SameLine();
    changed |= ImGui::Checkbox("clear", &clear);
    if (changed) {
        const auto unit = [](float c) { return std::clamp(c, 0.0f, 1.0f); };
        shading.background = {unit(rgb[0]), unit(rgb[1]), unit(rgb[2]), clear ? 0.0f : 1.0f};
    }
    return changed;
}

void draw_strip(float x, float y, float width, float height,
                const std::function<Rgba(float share)>& color) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    constexpr int kPieces = 64;
    const auto color_u32 = [&](int n) {
        const Rgba c = color(static_cast<float>(n) / float(kPieces));
        return ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1});
    };
    for (int n = 0; n < kPieces; ++n) {
        const float x0 = x + width * static_cast<float>(n) / kPieces;
        const float x1 = x + width * static_cast<float>(n + 1) / kPieces;
        const ImU32 left = color_u32(n), right = color_u32(n + 1);
        list.AddRectFilledMultiColor({x0, y}, {x1, y + height}, left, right, right, left);
    }
}

std::string choose_map(const std::string& shown, Gui& gui) {
    std::string chosen;
    if (ImGui::BeginCombo("map", shown.c_str(), ImGuiComboFlags_HeightLarge)) {
        for (const std::string& name : transfer_function_names()) {
            const ImVec2 at = ImGui::GetCursorScreenPos();
            const float height = ImGui::GetTextLineHeight();
            if (ImGui::Selectable(("      " + name).c_str(), name == shown)) chosen = name;
            const TransferFunction& map = named_transfer_function(name);
            draw_strip(at.x, at.y, 1.6f * height, height,
                       [&](float v) { return color_at(map, v); });
        }
        ImGui::EndCombo();
    }
    mark(gui, "map");
    return chosen;
}

namespace {

/// Two values of a layer in ascending order.
/// step  of a pixel's drag
bool drag_values(const char* name, double& first, double& second, double step) {
    double ends[2] = {first, second};
    const bool moved = ImGui::DragScalarN(name, ImGuiDataType_Double, ends, 2,
                                          static_cast<float>(step), nullptr, nullptr, "%.4g");
    if (!moved || !(ends[0] < ends[1])) return false;
    first = ends[0], second = ends[1];
    return true;
}

bool edit_opacity(const char* name, double& opacity, double least) {
    auto shown = static_cast<float>(opacity);
    if (!ImGui::SliderFloat(name, &shown, static_cast<float>(least), 1, "%.2f")) return false;
    opacity = std::clamp(double{shown}, least, 1.0);
    return true;
}

/// Bands, window or range of a layer, by which of them it has.
bool edit_transfer(TransferRequest& transfer, Gui& gui, const std::string& layer) {
    bool changed = false;
    for (std::size_t n = 0; n < transfer.bands.size(); ++n) {
        ValueBand& band = transfer.bands[n];
        ImGui::PushID(static_cast<int>(n));
        if (std::isfinite(band.upper))
            changed |=
                drag_values("band", band.lower, band.upper, 0.005 * (band.upper - band.lower));
        mark(gui, layer + "-band-" + std::to_string(n + 1));
        float rgb[3] = {band.r, band.g, band.b};
        if (ImGui::ColorEdit3("##color", rgb,
                              ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs))
            band.r = rgb[0], band.g = rgb[1], band.b = rgb[2], changed = true;
        ImGui::SameLine();
        changed |= edit_opacity("opacity", band.opacity, 0);
        mark(gui, layer + "-opacity-" + std::to_string(n + 1));
        ImGui::PopID();
    }
    if (auto& window = transfer.window) {
        double ends[2] = {window->first - 0.5 * window->second,
                          window->first + 0.5 * window->second};
        if (drag_values("window", ends[0], ends[1], 0.005 * window->second))
            window.emplace(0.5 * (ends[0] + ends[1]), ends[1] - ends[0]), changed = true;
        mark(gui, layer + "-window");
    } else if (transfer.bands.empty() && !transfer.points.at_values && transfer.range) {
        auto& [low, high] = *transfer.range;
        double ends[2] = {low, high};
        bool log = transfer.log.value_or(false);
        if (drag_values("range", ends[0], ends[1], 0.005 * (high - low)) && !(log && ends[0] <= 0))
            low = ends[0], high = ends[1], changed = true;
        mark(gui, layer + "-range");
        if (ImGui::Checkbox("log", &log) && (low > 0 || !log)) transfer.log = log, changed = true;
        mark(gui, layer + "-log");
    }
    return changed;
}

/// What a layer has beside its eye.
void draw_layer(Session& session, Gui& gui, std::size_t n, const std::string& name) {
    Layer layer = session.layers()[n];
    TransferRequest& transfer = layer.transfer;
    bool changed = false;
    if (!session.is_surface(n)) {
        const std::string map = choose_map(transfer.points.points.name, gui);
        if (!map.empty()) {
            transfer.points = transfer_points(map);
            transfer.window.reset(), transfer.bands.clear();
            changed = true;
        }
        changed |= edit_transfer(transfer, gui, name);
        if (changed && transfer.log) layer.fit = *transfer.log ? ScaleFit::log : ScaleFit::linear;
    }
    if (layer.plane) {
        const auto [low, high] = slice_range(session, n);
        const double least = low, most = high;
        if (ImGui::SliderScalar("plane", ImGuiDataType_Double, &*layer.plane->offset, &least, &most,
                                "%.4g"))
            changed = true;
        mark(gui, name + "-plane");
    }
    if (layer.plane || session.is_surface(n)) {
        double opacity = layer.opacity.value_or(1);
        if (edit_opacity("opacity", opacity, 0.01)) layer.opacity = opacity, changed = true;
        mark(gui, name + "-opacity");
    }
    if (layer.color) {
        auto& rgb = *layer.color;
        changed |= ImGui::ColorEdit3("color", rgb.data(),
                                     ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
    }
    if (changed) attempt(session, [&] { session.edit_layer(n, [&](Layer& to) { to = layer; }); });
}

}  // namespace

void draw_layers(Session& session, Gui& gui) {
    for (std::size_t n = 0; n < session.layers().size(); ++n) {
        ImGui::PushID(static_cast<int>(n));
        const std::string number = std::to_string(n + 1);
        bool visible = session.layers()[n].visible;
        if (ImGui::Checkbox(session.layer_name(n).c_str(), &visible))
            session.set_layer_visible(n, visible);
        mark(gui, "layer " + number);
        if (visible) draw_layer(session, gui, n, "layer-" + number);
        ImGui::PopID();
    }
}

void draw_look(Session& session, Gui& gui, float ui) {
    Look& look = session.look;
    bool changed = false;
    if (const std::string map = choose_map(look.base.name, gui); !map.empty())
        attempt(session, [&] { session.set_map(map); });
    const bool visibility = session.quantity.show == Show::depth;
    if (visibility) changed |= edit_opacity(session, gui, ui);
    if (visibility && ImGui::DragFloatRange2("range", &look.low, &look.high, 0.002f, 0, 1, "%.3f",
                                             "%.3f", ImGuiSliderFlags_AlwaysClamp)) {
        look.low = std::min(look.low, 0.999f);
        look.high = std::max(look.high, look.low + 0.001f);
        changed = true;
    }
    changed |= ImGui::SliderFloat("gamma", &look.gamma, 0.2f, 5, "%.2f",
                                  ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    mark(gui, "gamma");
    if (visibility) changed |= edit_exposure(session, gui);
    changed |= ImGui::Checkbox("invert", &look.invert);
    mark(gui, "invert");
    if (visibility) {
        ImGui::SameLine();
        changed |= ImGui::Checkbox("blend", &look.shading.blend);
        mark(gui, "blend");
    }
    changed |= edit_background(session.look);
    if (visibility) {
        ImGui::SameLine();
        if (ImGui::Button("ramp")) look.opacity = {{0, 0}, {1, 1}}, changed = true;
        ImGui::SameLine();
        if (ImGui::Button("opaque")) look.opacity.clear(), changed = true;
    }
    ImGui::InputText("##look", &gui.look_path);
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("load##look")) attempt(session, [&] { session.set_map(gui.look_path); });
    mark(gui, "load look");
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("save##look")) attempt(session, [&] { session.save_look(gui.look_path); });
    if (changed) session.look_changed();
}

}  // namespace vog::viewer
