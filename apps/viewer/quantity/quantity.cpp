// quantity.cpp: names and choices of quantities, and maps from sums.
#include "quantity/quantity.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vog/error.h"
#include "vog/picture.h"
#include "web/page_fields.h"

namespace vog::viewer {

namespace {

constexpr const char* kNames[] = {"visibility",        "column density",   "mean on rays",
                                  "deviation on rays", "volume, by value", "maximum on rays"};

}  // namespace

const char* name_of(Show show) { return kNames[static_cast<std::size_t>(show)]; }
bool of_field(Show show) { return show >= Show::mean; }

Show shaded_as(const Quantity& quantity) {
    if (quantity.show == Show::maximum) return Show::mean;
    return quantity.show == Show::mean && quantity.field.part == FieldPart::magnitude
               ? Show::deviation
               : quantity.show;
}

std::vector<FieldChoice> field_choices(const Fields& fields, Show show) {
    std::vector<FieldChoice> all;
    for (const ScalarField& field : fields.scalar) all.push_back({field.name, FieldPart::value});
    if (is_by_value(show)) return all;
    for (const VectorField& field : fields.vector) {
        for (const FieldPart part : {FieldPart::view, FieldPart::x, FieldPart::y, FieldPart::z})
            all.push_back({field.name, part});
        if (show == Show::mean) all.push_back({field.name, FieldPart::magnitude});
    }
    return all;
}

FieldChoice field_for(const Fields& fields, Show show, const std::string& text) {
    const std::vector<FieldChoice> all = field_choices(fields, show);
    if (all.empty())
        throw Error(fmt::format("{} needs a {}field, which this model has not", name_of(show),
                                is_by_value(show) ? "scalar " : ""));
    if (text.empty()) {
        if (is_by_value(show)) return {scalar_to_begin_with(fields)->name, FieldPart::value};
        return all.front();
    }
    const FieldChoice choice = field_choice(text, fields);
    const auto same = [&](const FieldChoice& other) {
        return other.field == choice.field && other.part == choice.part;
    };
    if (std::ranges::none_of(all, same))
        throw Error(
            fmt::format("{} is not of {}, expected {}", name_of(show), field_label(choice),
                        is_by_value(show) ? "a scalar field" : "a scalar field or one component"));
    return choice;
}

std::string text_of(const FieldChoice& choice) {
    const char* const parts[] = {"", "", ".x", ".y", ".z", ".magnitude"};
    return choice.field + parts[static_cast<std::size_t>(choice.part)];
}

std::string label_of(const Quantity& quantity, const Fields& fields) {
    if (quantity.show == Show::depth) return "V = 1 - exp(-T)";
    const ScalarField* scalar = fields.find_scalar(quantity.field.field);
    const VectorField* vector = fields.find_vector(quantity.field.field);
    const std::string unit = scalar ? scalar->unit : vector ? vector->unit : "";
    return quantity_label(quantity.show, field_label(quantity.field),
                          quantity.show == Show::column ? "" : unit);
}

DepthImage depth_of(const SumImage& sums) {
    DepthImage depth(sums.width, sums.height);
    const auto channels = static_cast<std::size_t>(sums.channels);
    for (std::size_t n = 0; n < depth.depth.size(); ++n) depth.depth[n] = sums.value[n * channels];
    return depth;
}

SumImage shrunk(SumImage image, int factor) {
    if (factor == 1) return image;
    SumImage mean{image.width / factor, image.height / factor, image.channels, {}};
    const auto channels = static_cast<std::size_t>(image.channels);
    mean.value.resize(static_cast<std::size_t>(mean.width) * static_cast<std::size_t>(mean.height) *
                      channels);
    const float weight = 1 / static_cast<float>(factor * factor);
    for (int row = 0; row < mean.height * factor; ++row)
        for (int column = 0; column < mean.width * factor; ++column) {
            const std::size_t to =
                static_cast<std::size_t>((row / factor) * mean.width + column / factor) * channels;
            const std::span<const float> from = image.at(column, row);
            for (std::size_t c = 0; c < channels; ++c) mean.value[to + c] += weight * from[c];
        }
    return mean;
}

bool operator==(const Drawn& a, const Drawn& b) {
    if (a.kind != b.kind || !(a.look.clip == b.look.clip)) return false;
    if (a.kind == Drawn::Kind::depth) return true;
    if (a.field.field != b.field.field || a.field.part != b.field.part) return false;
    if (a.kind == Drawn::Kind::maximum) return a.slabs == b.slabs;
    return a.kind == Drawn::Kind::field ||
           (a.look == b.look && a.slabs == b.slabs && a.transfer == b.transfer);
}

Drawn drawn_for(const Quantity& quantity, std::shared_ptr<const ValueTransfer> transfer) {
    const bool maximum = quantity.show == Show::maximum;
    const Drawn::Kind kind = quantity.show == Show::volume ? Drawn::Kind::light
                             : maximum                     ? Drawn::Kind::maximum
                             : of_field(quantity.show)     ? Drawn::Kind::field
                                                           : Drawn::Kind::depth;
    return {kind, quantity.field, quantity.look, maximum ? quantity.maximum_slabs : quantity.slabs,
            kind == Drawn::Kind::light ? std::move(transfer) : nullptr};
}

FieldUnit unit_of(const Fields& fields, const std::string& field) {
    if (const ScalarField* scalar = fields.find_scalar(field)) {
        const web::PageUnit unit = web::page_unit(*scalar);
        return {unit.reference, unit.unit};
    }
    if (const VectorField* vector = fields.find_vector(field)) {
        const web::PageUnit unit = web::page_unit(*vector);
        return {unit.reference, unit.unit};
    }
    return {};
}

float largest_column(const SumImage& sums) {
    float most = 0;
    for (std::size_t n = 0; n < sums.value.size(); n += static_cast<std::size_t>(sums.channels))
        most = std::max(most, sums.value[n]);
    return most;
}

ValueMap shown_map(const SumImage& sums, Show show, FieldUnit unit) {
    ValueMap map{sums.width, sums.height, {}};
    const double least = show == Show::column ? 0 : kLeastColumn * double{largest_column(sums)};
    const auto channels = static_cast<std::size_t>(sums.channels);
    for (std::size_t n = 0; n < sums.value.size(); n += channels) {
        const double column = double{sums.value[n]};
        double value = column;
        if (!(column > least)) {
            value = std::numeric_limits<double>::quiet_NaN();
        } else if (of_field(show)) {
            const double mean = double{sums.value[n + 1]} / column;
            const double square = double{sums.value[n + 2]} / column;
            value = show == Show::mean ? unit.reference + unit.unit * mean
                                       : unit.unit * std::sqrt(std::max(square - mean * mean, 0.0));
        }
        map.value.push_back(static_cast<float>(value));
    }
    return map;
}

ColorScale fitted_scale_of(const SumImage& sums, Show show, FieldUnit unit, bool log) {
    const ColorScale none{ColorScale::Kind::linear, 0, 1};
    if (show == Show::column) {
        const DepthImage column = depth_of(sums);
        return automatic_scale({&column, 1}, log ? ScaleFit::log : ScaleFit::linear);
    }
    const ValueMap map = shown_map(sums, show, unit);
    // Rims of supports do not count, as in values_for_scale.
    std::vector<float> values;
    const float least = 1e-3f * largest_column(sums);
    bool positive = false;
    for (std::size_t n = 0; n < map.value.size(); ++n) {
        if (!(sums.value[n * static_cast<std::size_t>(sums.channels)] > least)) continue;
        values.push_back(map.value[n]);
        positive = positive || map.value[n] > 0;
    }
    if (values.empty()) return none;
    return fitted_scale(values, log && positive ? ScaleFit::log : ScaleFit::linear);
}

}  // namespace vog::viewer
