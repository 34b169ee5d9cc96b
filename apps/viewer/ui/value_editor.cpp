// value_editor.cpp: editor of the transfer function of values: opacity over the histogram of the measure.
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"

namespace vog::viewer {

namespace {

/// Axis of values and opacities on the screen.
class EditorAxes {
  public:
    EditorAxes(ValueRange range, bool log, ImVec2 at, ImVec2 size)
        : range_(range), log_(log), at_(at), size_(size) {}
    float x_of(double value) const {
        return at_.x + size_.x * static_cast<float>(std::clamp(share_of(value), -0.01, 1.01));
    }
    float y_of(double opacity) const { return at_.y + size_.y * static_cast<float>(1 - opacity); }
    double value_at(float x) const {
        const double share = std::clamp(double{(x - at_.x) / size_.x}, 0.0, 1.0);
        return log_ ? range_.lower * std::pow(range_.upper / range_.lower, share)
                    : std::lerp(range_.lower, range_.upper, share);
    }
    double opacity_at(float y) const {
        return std::clamp(1 - double{(y - at_.y) / size_.y}, 0.0, 1.0);
    }
    ImVec2 place(const ValueOpacity& p) const { return {x_of(p.value), y_of(p.opacity)}; }

  private:
    double share_of(double value) const {
        return log_ ? std::log(std::max(value, 1e-300) / range_.lower) /
                          std::log(range_.upper / range_.lower)
                    : (value - range_.lower) / range_.width();
    }
    ValueRange range_;
    bool log_;
    ImVec2 at_, size_;
};

/// Drag moves a point, with Shift all of its band; double-click adds, right-click removes, a right drag sets window and
/// level.
class ValueEditor {
  public:
    ValueEditor(Session& session, Gui& gui, const EditorAxes& axes, float ui)
        : session_(session), gui_(gui), axes_(axes), ui_(ui) {}

    void edit() {
        const ImGuiIO& io = ImGui::GetIO();
        const bool over = ImGui::IsItemHovered();
        const ValueTransfer& now = *session_.values.now();
        const int near = over ? nearest(io.MousePos) : -1;
        if (over && ImGui::IsMouseDoubleClicked(0) && near < 0) {
            std::size_t index = 0;
            return set(with_new_point(
                now, {axes_.value_at(io.MousePos.x), axes_.opacity_at(io.MousePos.y)}, index));
        }
        if (over && ImGui::IsMouseReleased(1) && near >= 0 && io.MouseDragMaxDistanceSqr[1] < 9)
            return set(without_point(now, static_cast<std::size_t>(near)));
        if (over && ImGui::IsMouseClicked(0) && near >= 0) {
            const auto n = static_cast<std::size_t>(near);
            gui_.dragged_point = near;
            gui_.dragged_band = io.KeyShift ? band_around(now, n) : PointRange{n, n};
            session_.values.begin_drag();
        }
        if (!ImGui::IsMouseDown(0)) {
            if (gui_.dragged_point >= 0) session_.values.end_drag();
            gui_.dragged_point = -1;
        }
        move(now, io);
    }

    void draw(ImVec2 at, ImVec2 size) const {
        ImDrawList& list = *ImGui::GetWindowDrawList();
        list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, IM_COL32(18, 18, 20, 255));
        const ScalarField* field = session_.fields().find_scalar(session_.quantity.field.field);
        const std::vector<float>& share = session_.value_histogram;
        for (std::size_t n = 0; field && n < share.size(); ++n) {
            const auto edge = [&](std::size_t bin) {
                const double part = static_cast<double>(bin) / static_cast<double>(share.size());
                return std::clamp(axes_.x_of(std::lerp(field->lower, field->upper, part)), at.x,
                                  at.x + size.x);
            };
            // Logarithmic scale from 1e-4 of the largest.
            const float height =
                std::clamp(1 + std::log10(std::max(share[n], 1e-30f)) / 4, 0.0f, 1.0f);
            list.AddRectFilled({edge(n), at.y + size.y * (1 - height)},
                               {edge(n + 1), at.y + size.y}, IM_COL32(90, 100, 120, 255));
        }
        const std::vector<ValueOpacity>& points = session_.values.now()->opacity;
        const ImU32 line = IM_COL32(255, 220, 120, 255);
        list.PushClipRect(at, {at.x + size.x, at.y + size.y}, true);
        list.AddLine({at.x, axes_.y_of(points.front().opacity)}, axes_.place(points.front()), line,
                     1.5f * ui_);
        for (std::size_t n = 1; n < points.size(); ++n)
            list.AddLine(axes_.place(points[n - 1]), axes_.place(points[n]), line, 1.5f * ui_);
        list.AddLine(axes_.place(points.back()), {at.x + size.x, axes_.y_of(points.back().opacity)},
                     line, 1.5f * ui_);
        for (const ValueOpacity& point : points)
            list.AddCircleFilled(axes_.place(point), 4 * ui_, IM_COL32(255, 255, 255, 255));
        list.PopClipRect();
    }

  private:
    void set(ValueTransfer next) {
        attempt(session_, [&] { session_.set_values(std::move(next)); });
    }
    void move(const ValueTransfer& now, const ImGuiIO& io) {
        const auto dragged = static_cast<std::size_t>(std::max(gui_.dragged_point, 0));
        if (gui_.dragged_point < 0 || dragged >= now.opacity.size()) return;
        const ValueOpacity to{axes_.value_at(io.MousePos.x), axes_.opacity_at(io.MousePos.y)};
        const PointRange band = gui_.dragged_band;
        if (band.first == band.last) return set(with_point(now, dragged, to));
        if (band.last >= now.opacity.size()) return;
        const ValueOpacity& from = now.opacity[dragged];
        set(with_band_moved(now, band.first, band.last, to.value - from.value,
                            from.opacity > 0 ? std::max(to.opacity, 0.01) / from.opacity : 1));
    }
    int nearest(ImVec2 mouse) const {
        int best = -1;
        float least = 9 * ui_;
        const std::vector<ValueOpacity>& points = session_.values.now()->opacity;
        for (std::size_t n = 0; n < points.size(); ++n) {
            const ImVec2 p = axes_.place(points[n]);
            const float distance = std::hypot(p.x - mouse.x, p.y - mouse.y);
            if (distance < least) best = static_cast<int>(n), least = distance;
        }
        return best;
    }

    Session& session_;
    Gui& gui_;
    const EditorAxes& axes_;
    float ui_;
};

/// The data's range, and all points.
ValueRange shown_range(const Session& session) {
    ValueRange range = range_of(*session.values.now());
    if (const ScalarField* field = session.fields().find_scalar(session.quantity.field.field))
        range = {std::min(range.lower, field->lower), std::max(range.upper, field->upper)};
    if (!(range.upper > range.lower)) range.upper = range.lower + 1;
    return range;
}

/// Window and level by a right drag: to the right wider, up higher values.
void drag_window(Session& session, const ImVec2& size) {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsMouseClicked(1)) session.values.begin_drag();
    if (ImGui::IsMouseReleased(1)) session.values.end_drag();
    if (!ImGui::IsMouseDragging(1, 3) || (io.MouseDelta.x == 0 && io.MouseDelta.y == 0)) return;
    window_by_drag(session, double{io.MouseDelta.x / size.x}, double{-io.MouseDelta.y / size.y});
}

void draw_presets(Session& session, Gui& gui, ValueRange range) {
    const ValueTransfer now = *session.values.now();
    const auto button = [&](const char* name, const auto& edit) {
        if (ImGui::Button(name)) attempt(session, [&] { session.set_values(edit()); });
        mark(gui, name);
        ImGui::SameLine();
    };
    button("ramp", [&] { return ramp(now, range); });
    button("peak", [&] { return peak(now, range); });
    button("step", [&] { return step(now, range); });
    button("invert", [&] { return inverted(now); });
    if (ImGui::Button("undo")) session.values.undo(session.quantity.look.lights);
    mark(gui, "undo");
    ImGui::SameLine();
    if (ImGui::Button("redo")) session.values.redo(session.quantity.look.lights);
    mark(gui, "redo");
}

/// Gradient opacity that rises from nothing at one magnitude to all at another.
void draw_gradient(Session& session, Gui& gui) {
    ValueTransfer next = *session.values.now();
    std::vector<GradientOpacity>& points = next.gradient;
    const double most = session.steepest;
    bool on = !points.empty();
    bool changed = ImGui::Checkbox("boundaries", &on);
    mark(gui, "boundaries");
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Gradient opacity: hide matter whose values hardly change from place to place");
    if (changed)
        points = on ? std::vector<GradientOpacity>{{0, 0}, {0.5 * most, 1}}
                    : std::vector<GradientOpacity>{};
    if (on && most > 0) {
        auto low = static_cast<float>(points.front().magnitude / most);
        auto high = static_cast<float>(points.back().magnitude / most);
        const std::string text = fmt::format("{:.3g}", points.front().magnitude);
        const std::string to = fmt::format("{:.3g}", points.back().magnitude);
        if (ImGui::DragFloatRange2("gradient", &low, &high, 0.003f, 0, 2, text.c_str(), to.c_str(),
                                   ImGuiSliderFlags_AlwaysClamp) &&
            low < high) {
            points = {{double{low} * most, 0}, {double{high} * most, 1}};
            changed = true;
        }
        mark(gui, "gradient");
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip(
                "Magnitudes of the gradient, unit of the field per world unit, from which\n"
                "matter begins to show and is shown whole; 99 %% of the data lie below %.3g",
                most);
    }
    if (changed) attempt(session, [&] { session.set_values(next); });
}

}  // namespace

void window_by_drag(Session& session, double right, double up) {
    if (session.quantity.show == Show::volume && session.values.now()) {
        const ValueRange range = range_of(*session.values.now());
        attempt(session, [&] {
            session.set_values(
                windowed(*session.values.now(), up * range.width(), std::exp(2 * right)));
        });
    } else if (has_scale(session.quantity.show)) {
        ColorScale scale = session.scale;
        if (scale.kind == ColorScale::Kind::log) {
            const double factor = std::pow(scale.high / scale.low, up);
            const double wider = std::pow(scale.high / scale.low, 0.5 * std::expm1(2 * right));
            scale.low *= factor / wider, scale.high *= factor * wider;
        } else {
            const double width = scale.high - scale.low, more = 0.5 * width * std::expm1(2 * right);
            scale.low += up * width - more, scale.high += up * width + more;
        }
        attempt(session, [&] { session.set_scale(scale); });
    }
}

void draw_values(Session& session, Gui& gui, float ui) {
    if (const std::string map = choose_map(session.values.now()->name, gui); !map.empty())
        attempt(session, [&] { session.set_map(map); });
    const ValueRange range = shown_range(session);
    const bool can_log = range.lower > 0 || range.upper > 0;
    const bool log = gui.log_values && can_log;
    const ValueRange axis{log ? std::max(range.lower, 1e-4 * range.upper) : range.lower,
                          range.upper};
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 110 * ui};
    ImGui::InvisibleButton("values", size,
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    mark(gui, "values");
    const EditorAxes axes(axis, log, at, size);
    ValueEditor editor(session, gui, axes, ui);
    editor.edit();
    if (ImGui::IsItemActive()) drag_window(session, size);
    editor.draw(at, size);
    if (ImGui::IsItemHovered() && gui.dragged_point < 0 && !ImGui::IsMouseDown(1))
        ImGui::SetTooltip(
            "Opacity over the values, with the histogram of the measure (log scale)\n"
            "double-click: add a point; drag: move, with Shift a whole band; right-click: remove\n"
            "right drag, here or in the picture: window and level");
    const ImVec2 strip = ImGui::GetCursorScreenPos();
    ImGui::Dummy({size.x, 12 * ui});
    draw_strip(strip.x, strip.y, size.x, 12 * ui, [&](float share) {
        const ValueLight light =
            light_of(*session.values.now(), axes.value_at(strip.x + share * size.x));
        return Rgba{static_cast<float>(light.r), static_cast<float>(light.g),
                    static_cast<float>(light.b), 1};
    });
    ImGui::Text("%.4g", axis.lower);
    const std::string upper = fmt::format("{:.4g}", axis.upper);
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(upper.c_str()).x);
    ImGui::TextUnformatted(upper.c_str());
    draw_presets(session, gui, range);

    ValueTransfer next = *session.values.now();
    double unit = next.unit_distance;
    const double least = 1e-9 * session.radius(), most = 1e6 * session.radius();
    if (ImGui::DragScalar("unit distance", ImGuiDataType_Double, &unit,
                          static_cast<float>(0.01 * unit), &least, &most, "%.4g",
                          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
        next.unit_distance = unit;
        attempt(session, [&] { session.set_values(next); });
    }
    mark(gui, "unit distance");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("World length that an opacity refers to");
    draw_gradient(session, gui);
    ImGui::BeginDisabled(!can_log);
    ImGui::Checkbox("log values", &gui.log_values);
    ImGui::EndDisabled();
    mark(gui, "log values");
    ImGui::SameLine();
    if (ImGui::Button("automatic")) session.automatic_scale();
    mark(gui, "automatic");
    if (edit_background(session.look)) session.look_changed();
    ImGui::InputText("##look", &gui.look_path);
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("load##look")) attempt(session, [&] { session.set_map(gui.look_path); });
    ImGui::SameLine(0, 4 * ui);
    if (ImGui::Button("save##look")) attempt(session, [&] { session.save_look(gui.look_path); });
}

}  // namespace vog::viewer
