// page_fields.cpp: ranges, histograms and bytes of fields.
#include "web/page_fields.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "render/by_value/value_histogram.h"
#include "vog/field_maps.h"
#include "vog/maximum_picture.h"
#include "vog/quantity.h"
#include "web/web_fields.h"

namespace vog::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBins = 96;
constexpr int kViewSize = 256;

/// Range of a map in the first view, as `vog render` chooses it; a number that is no range: null.
Json range_of(const FieldMaps& maps, const std::vector<float>& shown) {
    const std::vector<float> values = values_for_scale(maps, shown);
    if (values.empty()) return nullptr;
    const ColorScale scale = fitted_scale(values, ScaleFit::linear);
    return {scale.low, scale.high};
}

Json maps_json(const Gaussians& model, const FieldChoice& choice, const Camera& view) {
    const FieldMaps maps = render_field_splat(model, choice, view, kViewSize, kViewSize);
    return {{"mean", range_of(maps, maps.mean)}, {"deviation", range_of(maps, maps.deviation)}};
}

/// Range of the maximum in the first view, likewise.
Json maximum_range(const Gaussians& model, const std::string& field, const Camera& view) {
    const ValueMap map = render_maximum_splat(model, field, view, kViewSize, kViewSize);
    if (std::ranges::all_of(map.value, [](float value) { return std::isnan(value); }))
        return nullptr;
    const ColorScale scale = fitted_scale(map.value, ScaleFit::linear);
    return {scale.low, scale.high};
}

/// Measure by value, the largest bin 1000.
Json histogram(const Gaussians& model, const ScalarField& field, bool logarithmic) {
    const std::vector<double> edges = by_value::value_bins(field, kBins, logarithmic);
    Json out = Json::array();
    for (const float share : by_value::value_histogram(model, field, edges))
        out.push_back(std::lround(1000 * share));
    return out;
}

Json value_json(const WebField& field) {
    Json values = Json::array();
    for (const WebField::Value& value : field.value) values.push_back({value.low, value.step});
    return {{"value", values}, {"change", field.change}, {"deviation", field.deviation}};
}

template <class Field>
Json named(const Field& field, bool is_vector) {
    const WebUnit unit = web_unit(field);
    return {{"name", field.name},   {"unit", field.unit},     {"vector", is_vector},
            {"lower", field.lower}, {"upper", field.upper},   {"reference", unit.reference},
            {"scale", unit.unit},   {"levels", Json::array()}};
}

}  // namespace

Json fields_json(
    std::span<const Gaussians> levels, std::span<const WebShapes> shapes, const WebFrame& frame,
    const Camera& view,
    const std::function<void(std::size_t, std::size_t, const std::string&)>& add_data) {
    const Gaussians& finest = levels.front();
    Json all = Json::array();
    const auto add_levels = [&](Json& entry, const auto& field_of) {
        for (std::size_t n = 0; n < levels.size(); ++n) {
            const WebField field = web_field(shapes[n], frame, field_of(levels[n].fields));
            entry["levels"].push_back(value_json(field));
            add_data(all.size(), n, deflated(field.bytes));
        }
        all.push_back(std::move(entry));
    };
    for (const ScalarField& field : finest.fields.scalar) {
        Json entry = named(field, false);
        entry["isMeasure"] = field.is_measure;
        entry["histogram"] = histogram(finest, field, false);
        if (field.lower > 0) entry["logHistogram"] = histogram(finest, field, true);
        entry["ranges"] = {{"", maps_json(finest, {field.name, FieldPart::value}, view)}};
        entry["ranges"][""]["maximum"] = maximum_range(finest, field.name, view);
        add_levels(entry, [&](const Fields& fields) -> const ScalarField& {
            return *fields.find_scalar(field.name);
        });
    }
    for (const VectorField& field : finest.fields.vector) {
        Json entry = named(field, true);
        for (const auto& [name, part] : {std::pair{"view", FieldPart::view},
                                         {"x", FieldPart::x},
                                         {"y", FieldPart::y},
                                         {"z", FieldPart::z},
                                         {"magnitude", FieldPart::magnitude}})
            entry["ranges"][name] = maps_json(finest, {field.name, part}, view);
        add_levels(entry, [&](const Fields& fields) -> const VectorField& {
            return *fields.find_vector(field.name);
        });
    }
    return all;
}

}  // namespace vog::web
