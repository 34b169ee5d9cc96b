// session_quantity.cpp: the quantity shown, its field, scale and transfer function of values.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "quantity/probe.h"
#include "render/by_value/value_histogram.h"
#include "render/picture/request/request_effects.h"
#include "session/session.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/text.h"

namespace vog::viewer {

namespace {

constexpr std::size_t kValueBins = 128;

}  // namespace

const Fields& Session::fields() const {
    static const Fields kNone;
    const Level* level = shown_level();
    return level ? level->model->fields : kNone;
}

FieldUnit Session::field_unit() const { return unit_of(fields(), quantity.field.field); }

void Session::set_quantity(Show show, const std::string& field) {
    Quantity next = quantity;
    next.show = show;
    const bool changed = show != quantity.show || !field.empty();
    if (scene.levels.empty()) {
        wanted_field_ = field;
    } else if (of_field(show)) {
        std::string text = field;
        // The present field stays where it can.
        const auto all = field_choices(fields(), show);
        const auto same = [&](const FieldChoice& choice) {
            return choice.field == quantity.field.field && choice.part == quantity.field.part;
        };
        if (text.empty() && std::ranges::any_of(all, same))
            next.field = quantity.field;
        else
            next.field = field_for(fields(), show, text);
    }
    // A map that nobody has chosen is the quantity's.
    if (show != quantity.show && look.map == default_map(quantity.show)) {
        load_map(look, default_map(show));
        look_changed();
    }
    quantity = next;
    if (has_scale(show) && changed) {
        scale = {ColorScale::Kind::linear, 0, 1};
        scale_open_ = true;
        inspected_revision_ = -1;
    }
}

/// Resolves what was asked for before anything was open, and what other files lack.
void Session::update_quantity() {
    if (!of_field(quantity.show)) return;
    const auto all = field_choices(fields(), quantity.show);
    const auto same = [&](const FieldChoice& choice) {
        return choice.field == quantity.field.field && choice.part == quantity.field.part;
    };
    if (std::ranges::none_of(all, same)) {
        const std::string wanted = std::exchange(wanted_field_, {});
        try {
            quantity.field = field_for(fields(), quantity.show, wanted);
        } catch (const Error& error) {
            quantity.show = Show::depth;
            quantity.field = {};
            show_error(error.what());
            return;
        }
    }
    begin_values();
}

void Session::begin_values() {
    const std::string& name = quantity.field.field;
    if (quantity.show != Show::volume || values_of_ == name) return;
    const Gaussians& model = *shown_level()->model;
    const ScalarField& field = *fields().find_scalar(name);
    ValueTransfer transfer;
    if (choose_transfer) {
        transfer = choose_transfer(model, name, std::exchange(values_first_, false));
    } else {
        TransferRequest request;
        request.points = transfer_points(map_function(look));
        transfer = vog::choose_transfer(request, value_data(model, field)).transfer;
    }
    values.begin(std::move(transfer));
    values_of_ = name;
    value_histogram =
        by_value::value_histogram(model, field, by_value::value_bins(field, kValueBins));
    steepest = steepest_gradient(
        scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)), name);
}

void Session::set_scale(const ColorScale& wanted) {
    scale_position(wanted, wanted.low);  // checks it
    scale = wanted;
    scale_open_ = false;
}

void Session::set_shadows(bool on) {
    VolumeLook& light = quantity.look;
    light.shadows = on, light.studio = false;
    if (on && !light.light && light.lights.empty()) light.lights = {{studio_light(camera)}};
}

void Session::automatic_scale() {
    if (quantity.show == Show::volume) {
        values_of_.clear();
    } else if (has_scale(quantity.show)) {
        const bool log = scale.kind == ColorScale::Kind::log;
        scale = fitted_scale_of(inspected_, quantity.show, log ? ScaleFit::log : ScaleFit::linear);
    }
}

void Session::set_values(ValueTransfer transfer) {
    validate(transfer);
    values.change(std::move(transfer));
}

void Session::set_map(const std::string& name_or_file) {
    if (quantity.show != Show::volume || !values.now()) {
        PictureRequest stated;
        stated.show = quantity.show;
        stated.transfer.points = transfer_points(name_or_file);
        const std::optional<ColorScale> own = stated_scale(stated);
        load_map(look, name_or_file);
        if (own && has_scale(quantity.show)) set_scale(*own);
        look_changed();
        return;
    }
    const TransferPoints points = transfer_points(name_or_file);
    const ScalarField& field = *fields().find_scalar(quantity.field.field);
    const ValueData data = value_data(*shown_level()->model, field);
    if (!points.at_values && points.points.opacity.empty()) {
        const auto [lower, upper] = range_of(*values.now());
        const ColorScale usual = value_scale(data);
        const bool log =
            usual.kind == ColorScale::Kind::log && lower == usual.low && upper == usual.high;
        return set_values(with_map(*values.now(), load_transfer_function(name_or_file), log));
    }
    TransferRequest request;
    request.points = points;
    request.unit_distance = values.now()->unit_distance;
    if (points.points.gradient.empty()) request.gradient = values.now()->gradient;
    set_values(vog::choose_transfer(request, data).transfer);
}

void Session::set_clip(const std::optional<Box>& box) {
    Clipping clip = quantity.look.clip;
    clip.box = box;
    validate(clip);
    quantity.look.clip = clip;
}

ShadeView Session::shade_view() const {
    ShadeView view;
    view.show = shaded_as(quantity);
    view.scale = scale;
    view.unit = field_unit();
    view.least_column = static_cast<float>(kLeastColumn) * most_column_;
    return view;
}

Probed Session::probe(double x, double y) const {
    if (inspected_.width == 0 || !left_.has_sums() || moving_) return {};
    if (x < 0 || y < 0 || x >= 1 || y >= 1) return {};
    const int column = static_cast<int>(x * inspected_.width);
    const int row = static_cast<int>(y * inspected_.height);
    const auto pixel = static_cast<std::size_t>(row * inspected_.width + column);
    if (quantity.show == Show::volume) return {probe_volume(column, row)};
    if (!same_kind(left_.picture(), inspected_picture_)) return {};
    return {probe_text(quantity, fields(), inspected_, pixel, most_column_, look.extinction)};
}

std::string Session::probe_volume(int column, int row) const {
    const Level* level = shown_level();
    if (!level || !values.now() || shows_layers()) return {};
    if (probed_.column == column && probed_.row == row && probed_.revision == inspected_revision_)
        return probed_.text;
    const CameraFrame frame = frame_of(camera, inspected_.width, inspected_.height);
    const std::optional<OpaqueValue> found = first_opaque_value(
        *level->model, *fields().find_scalar(quantity.field.field), *values.now(),
        quantity.look.clip, frame.origin(column, row), frame.direction(column, row));
    probed_ = {column, row, inspected_revision_, opaque_text(quantity, fields(), found)};
    return probed_.text;
}

void Session::set_layers(LayeredData data) {
    PictureRequest request;
    request.show = Show::volume;
    request.layers = data.layers;
    for (Layer& layer : request.layers) layer.visible = true;  // hidden ones keep their functions
    layered_as_ = resolve(std::move(request), *data.scene);
    for (std::size_t n = 0; n < data.layers.size(); ++n)
        layered_as_.request.layers[n].visible = data.layers[n].visible;
    data.layers = layered_as_.request.layers;
    layered_ = std::move(data);
    ++layer_changes_;
}

ResolvedPicture Session::layered_picture(const PictureRequest& request) const {
    ResolvedPicture picture = layered_as_;
    picture.request = request;
    picture.request.field.clear();  // layers have their own
    picture.request.transfer = {}, picture.request.fit = ScaleFit::automatic;
    picture.request.layers = layered_.layers;
    for (ResolvedPicture& layer : picture.layers) {
        layer.request.look = request.look, layer.request.slabs = request.slabs;
        layer.request.options.clip = request.options.clip;
    }
    return picture;
}

std::string Session::layer_name(std::size_t n) const {
    const Layer& layer = layered_.layers[n];
    const std::string name =
        std::filesystem::path(layered_.inputs[layer.input]).filename().string();
    const std::string& field = layered_as_.layers[n].field.field;
    return fmt::format("{}{}{}", name, field.empty() ? "" : " ", printable(field));
}

void Session::set_layer_visible(std::size_t n, bool visible) {
    layered_.layers[n].visible = visible;
    ++layer_changes_;
}

void Session::edit_layer(std::size_t n, const std::function<void(Layer&)>& change) {
    LayeredData data = layered_;
    change(data.layers[n]);
    set_layers(std::move(data));
}

}  // namespace vog::viewer
