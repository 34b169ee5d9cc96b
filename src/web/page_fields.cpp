// page_fields.cpp: ranges and histograms of fields.
#include "web/page_fields.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "render/by_value/value_histogram.h"
#include "render/splat/fields/field_splat.h"
#include "render/splat/splat.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/field_maps.h"
#include "vog/picture.h"
#include "vog/quantity.h"

namespace vog::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBins = 96;
constexpr int kViewSize = 256;

/// Scales of values in the first view, as `vog render` fits them: {linear, log, isLog}; without a number null.
Json ranges_of(const std::vector<float>& values) {
    if (std::ranges::all_of(values, [](float value) { return std::isnan(value); })) return nullptr;
    const auto ends = [&](ScaleFit fit) {
        const ColorScale scale = fitted_scale(values, fit);
        return Json{scale.low, scale.high};
    };
    Json out{{"linear", ends(ScaleFit::linear)}};
    if (std::ranges::any_of(values, [](float value) { return value > 0; }))
        out["log"] = ends(ScaleFit::log);
    out["isLog"] = fitted_scale(values, ScaleFit::automatic).kind == ColorScale::Kind::log;
    return out;
}

Json maps_json(const Gaussians& model, const FieldChoice& choice, const Camera& view) {
    const FieldMaps maps = render_field_splat(model, choice, view, kViewSize, kViewSize);
    return {{"mean", ranges_of(values_for_scale(maps, maps.mean))},
            {"deviation", ranges_of(values_for_scale(maps, maps.deviation))}};
}

/// Measure by value, the largest bin 1000.
Json histogram(const Gaussians& model, const ScalarField& field, bool logarithmic) {
    const std::vector<double> edges = by_value::value_bins(field, kBins, logarithmic);
    Json out = Json::array();
    for (const float share : by_value::value_histogram(model, field, edges))
        out.push_back(std::lround(1000 * share));
    return out;
}

template <class Field>
Json named(const Field& field, bool is_vector) {
    const PageUnit unit = page_unit(field);
    return {{"name", field.name},   {"unit", field.unit},   {"vector", is_vector},
            {"lower", field.lower}, {"upper", field.upper}, {"reference", unit.reference},
            {"scale", unit.unit}};
}

}  // namespace

PageUnit page_unit(const ScalarField& field) {
    const double half = 0.5 * (field.upper - field.lower);
    if (half > 0) return {field.lower + half, half};
    // Data of one value: as by_value::value_range().
    return {field.lower, std::max(std::abs(field.lower), 1e-300) * 1e-3};
}
PageUnit page_unit(const VectorField& field) { return {0, field.upper > 0 ? field.upper : 1}; }

Json fields_json(const Gaussians& model, const Camera& view) {
    Json all = Json::array();
    for (const ScalarField& field : model.fields.scalar) {
        Json entry = named(field, false);
        entry["isMeasure"] = field.is_measure;
        entry["background"] = field.background;
        const ValueData data = value_data(model, field);
        const ColorScale scale = value_scale(data);  // under a colour map
        entry["values"] = {scale.low, scale.high};
        entry["log"] = scale.kind == ColorScale::Kind::log;
        const MapUnit unit = map_unit(data);
        entry["unitDistance"] = map_unit_distance(data, scale);
        // Those of other ranges, and of stated opacities.
        entry["unitOf"] = {unit.middle, std::isfinite(unit.thickness) ? unit.thickness : 0,
                           rough_unit_distance(data)};
        entry["steepest"] = steepest_gradient(
            scene_of(std::shared_ptr<const Gaussians>(std::shared_ptr<void>(), &model)),
            field.name);
        entry["histogram"] = histogram(model, field, false);
        if (field.lower > 0) entry["logHistogram"] = histogram(model, field, true);
        entry["ranges"] = {{"", maps_json(model, {field.name, FieldPart::value}, view)}};
        entry["ranges"][""]["maximum"] =
            ranges_of(render_maximum_splat(model, field.name, view, kViewSize, kViewSize).value);
        all.push_back(std::move(entry));
    }
    for (const VectorField& field : model.fields.vector) {
        Json entry = named(field, true);
        for (const auto& [name, part] : {std::pair{"view", FieldPart::view},
                                         {"x", FieldPart::x},
                                         {"y", FieldPart::y},
                                         {"z", FieldPart::z},
                                         {"magnitude", FieldPart::magnitude}})
            entry["ranges"][name] = maps_json(model, {field.name, part}, view);
        all.push_back(std::move(entry));
    }
    return all;
}

}  // namespace vog::web
