// quantity_panel.cpp: selection of the quantity, its field, scale, light and clip box.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels.h"

namespace vog::viewer {

namespace {

void choose_quantity(Session& session, Gui& gui) {
    const Quantity& quantity = session.quantity;
    if (ImGui::BeginCombo("show", name_of(quantity.show))) {
        for (const char* word : show_words()) {
            const Show show = show_named(word);
            if (of_field(show) && field_choices(session.fields(), show).empty()) continue;
            if (ImGui::Selectable(name_of(show), show == quantity.show))
                attempt(session, [&] { session.set_quantity(show); });
        }
        ImGui::EndCombo();
    }
    mark(gui, "show");
    if (!of_field(quantity.show)) return;
    if (ImGui::BeginCombo("field", field_label(quantity.field).c_str())) {
        for (const FieldChoice& choice : field_choices(session.fields(), quantity.show)) {
            const std::string name = field_label(choice);
            const bool selected = name == field_label(quantity.field);
            if (ImGui::Selectable(name.c_str(), selected))
                attempt(session, [&] { session.set_quantity(quantity.show, text_of(choice)); });
        }
        ImGui::EndCombo();
    }
    mark(gui, "field");
}

/// Ends of the scale, in the quantity's unit.
void edit_scale(Session& session, Gui& gui) {
    ColorScale scale = session.scale;
    bool log = scale.kind == ColorScale::Kind::log;
    const double step = 0.005 * (scale.high - scale.low);
    double ends[2] = {scale.low, scale.high};
    const bool moved = ImGui::DragScalarN("range", ImGuiDataType_Double, ends, 2,
                                          static_cast<float>(step), nullptr, nullptr, "%.4g");
    mark(gui, "range");
    bool changed = moved && ends[0] < ends[1] && !(log && ends[0] <= 0);
    if (changed) scale.low = ends[0], scale.high = ends[1];
    if (ImGui::Checkbox("log", &log)) {
        scale.kind = log ? ColorScale::Kind::log : ColorScale::Kind::linear;
        if (log && scale.low <= 0) scale.low = 1e-4 * scale.high;
        changed = !log || scale.high > 0;
        if (!changed) session.show_error("a logarithmic scale needs values above 0");
    }
    mark(gui, "log");
    ImGui::SameLine();
    if (ImGui::Button("fit range")) session.automatic_scale();
    mark(gui, "fit range");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("The range of the values in this view");
    if (changed) attempt(session, [&] { session.set_scale(scale); });
}

/// Directions and strengths of the lights.
void edit_lights(VolumeLook& look) {
    std::vector<DirectionalLight> lights = lights_of(look);
    bool changed = false;
    std::optional<std::size_t> removed;
    for (std::size_t n = 0; n < lights.size(); ++n) {
        auto& [to, of_camera, strength] = lights[n];
        ImGui::PushID(static_cast<int>(n));
        bool at_eye = to == Vec3d{};
        if (ImGui::Checkbox("from the eye", &at_eye)) {
            to = at_eye ? Vec3d{} : Vec3d{0.5, 1, 0.5};
            changed = true;
        }
        if (!at_eye) {
            const Vec3f shown = vec_cast<float>(to);
            float towards[3] = {shown.x, shown.y, shown.z};
            if (ImGui::SliderFloat3("towards", towards, -1, 1, "%.2f")) {
                to = {double{towards[0]}, double{towards[1]}, double{towards[2]}};
                changed = true;
            }
            changed |= ImGui::Checkbox("turns with the view", &of_camera);
        }
        auto factor = static_cast<float>(strength);
        if (ImGui::SliderFloat("strength", &factor, 0, 2, "%.2f")) {
            strength = std::max(0.0, double{factor});
            changed = true;
        }
        if (lights.size() > 1 && ImGui::SmallButton("remove this light")) removed = n;
        ImGui::PopID();
    }
    if (removed) lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(*removed));
    bool more = false;
    if (lights.size() < kMostDirectionalLights && ImGui::SmallButton("one more light")) more = true;
    if (more) lights.push_back({{-1, 1, 1}, true, 0.5});
    if (changed || more || removed) look.lights = std::move(lights);
}

void edit_light(Session& session, Gui& gui) {
    VolumeLook& look = session.quantity.look;
    ImGui::Checkbox("light", &look.light);
    mark(gui, "light");
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Shading by the gradient of the values, from the eye");
    bool shadows = look.shadows;
    if (ImGui::Checkbox("shadows", &shadows)) session.set_shadows(shadows);
    mark(gui, "shadows");
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Light is absorbed on its way; first from the upper left of this view");
    ImGui::Checkbox("ambient occlusion", &look.occlusion);
    mark(gui, "ambient occlusion");
    if (look.shadows) {
        ImGui::SliderInt("scattering", &look.octaves, 1, kMostOctaves / 2);
        auto asymmetry = static_cast<float>(look.asymmetry);
        if (ImGui::SliderFloat("asymmetry", &asymmetry, -0.9f, 0.9f, "%.2f"))
            look.asymmetry = double{asymmetry};
    }
    if ((look.shadows || look.occlusion) && !look.clip.empty())
        ImGui::Checkbox("clips cut shadows", &look.clip_lights);
    if (!look.light && !look.shadows && !look.occlusion) return;
    const auto weight = [&](const char* name, double& value, double most) {
        auto shown = static_cast<float>(value);
        if (ImGui::SliderFloat(name, &shown, 0, static_cast<float>(most), "%.2f"))
            value = std::max(0.0, double{shown});
    };
    weight("ambient", look.ambient, 1);
    weight("diffuse", look.diffuse, 1);
    if (look.light) weight("specular", look.specular, 1);
    if (!look.light && !look.shadows) return;
    edit_lights(look);
}

void edit_clip(Session& session, Gui& gui) {
    const std::optional<Box> box = session.quantity.look.clip.box;
    bool on = box.has_value();
    if (ImGui::Checkbox("clip box", &on))
        attempt(session, [&] {
            session.set_clip(on ? std::optional(session.scene.subject.box) : std::nullopt);
        });
    mark(gui, "clip box");
    if (!on || !box) return;
    const Box& data = session.scene.subject.box;
    Box next = *box;
    for (int axis = 0; axis < 3; ++axis) {
        // Shares of the data's box: floats hold them anywhere in the world.
        const double low = data.lower[axis], width = data.upper[axis] - low;
        if (!(width > 0)) continue;
        float ends[2] = {static_cast<float>((next.lower[axis] - low) / width),
                         static_cast<float>((next.upper[axis] - low) / width)};
        const char* const names[] = {"x", "y", "z"};
        if (ImGui::DragFloatRange2(names[axis], &ends[0], &ends[1], 0.003f, 0, 1, "%.3f", "%.3f",
                                   ImGuiSliderFlags_AlwaysClamp)) {
            next.lower[axis] = low + double{ends[0]} * width;
            next.upper[axis] = low + double{ends[1]} * width;
        }
        mark(gui, std::string("clip ") + names[axis]);
    }
    if (!(next == *box)) attempt(session, [&] { session.set_clip(next); });
}

}  // namespace

void draw_quantity(Session& session, Gui& gui) {
    choose_quantity(session, gui);
    if (has_scale(session.quantity.show)) edit_scale(session, gui);
    if (session.quantity.show == Show::volume) edit_light(session, gui);
    edit_clip(session, gui);
}

}  // namespace vog::viewer
