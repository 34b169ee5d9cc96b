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

/// By the order of vog::Show.
constexpr const char* kNames[] = {
    "visibility", "column density",  "mean on rays", "deviation on rays",
    "volume",     "maximum on rays", "slice"};

bool same(const FieldChoice& a, const FieldChoice& b) {
    return a.field == b.field && a.part == b.part;
}
/// Whether the sums hold a largest value.
bool is_largest(const ResolvedPicture& picture) { return picture.request.show == Show::maximum; }

}  // namespace

const char* name_of(Show show) { return kNames[static_cast<std::size_t>(show)]; }

Show shaded_as(const Quantity& quantity) {
    if (quantity.show == Show::maximum) return Show::mean;
    return quantity.show == Show::mean && quantity.field.part == FieldPart::magnitude
               ? Show::deviation
               : quantity.show;
}

std::vector<FieldChoice> field_choices(const Fields& fields, Show show) {
    std::vector<FieldChoice> all;
    if (show == Show::slice) return all;  // not of windows
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
    if (show == Show::slice)
        throw Error(
            "the window draws no slices; choose T, column, mean, deviation, volume or maximum");
    if (all.empty())
        throw Error(fmt::format("{} needs a {}field, which this model lacks", name_of(show),
                                is_by_value(show) ? "scalar " : ""));
    if (text.empty()) {
        if (is_by_value(show)) return {scalar_to_begin_with(fields)->name, FieldPart::value};
        return all.front();
    }
    const FieldChoice choice = field_choice(text, fields);
    if (std::ranges::none_of(all, [&](const FieldChoice& one) { return same(one, choice); }))
        throw Error(
            fmt::format("{} cannot show {}; choose {}", name_of(show), field_label(choice),
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

ResolvedPicture sums_of(PictureRequest request, const FieldChoice& field,
                        const ValueTransfer* transfer) {
    ResolvedPicture picture;
    picture.field = field;
    if (transfer) picture.chosen.transfer = *transfer;
    if (is_depth(request.show)) request.show = Show::depth;
    if (is_field_map(request.show)) request.show = Show::mean;
    picture.request = std::move(request);
    return picture;
}

bool same_kind(const ResolvedPicture& a, const ResolvedPicture& b) {
    return a.request.show == b.request.show &&
           (is_depth(a.request.show) || same(a.field, b.field)) && channels_of(a) == channels_of(b);
}

bool same_moments(const ResolvedPicture& a, const ResolvedPicture& b) {
    const PictureRequest &p = a.request, &q = b.request;
    return same_kind(a, b) && p.width == q.width && p.height == q.height &&
           a.camera() == b.camera() && p.options.clip == q.options.clip &&
           p.options.pixel_error == q.options.pixel_error &&
           (!is_by_value(p.show) ||
            (p.slabs == q.slabs && (is_largest(a) || (p.look.light == q.look.light &&
                                                      a.chosen.transfer.gradient.empty() ==
                                                          b.chosen.transfer.gradient.empty()))));
}

bool same_sums(const ResolvedPicture& a, const ResolvedPicture& b) {
    return same_moments(a, b) &&
           (!is_by_value(a.request.show) || is_largest(a) ||
            (a.request.look == b.request.look && a.chosen.transfer == b.chosen.transfer));
}

int channels_of(const ResolvedPicture& picture) {
    return is_depth(picture.request.show) && picture.request.options.clip.empty() ? 1 : 4;
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

Sums numbers_of(const SumImage& sums, const ResolvedPicture& picture, FieldUnit unit) {
    Sums numbers;
    numbers.width = sums.width, numbers.height = sums.height;
    const bool depth = is_depth(picture.request.show), light = picture.request.show == Show::volume;
    for (std::size_t n = 0; n < sums.value.size(); n += static_cast<std::size_t>(sums.channels)) {
        const float* const sum = &sums.value[n];
        if (light) {
            numbers.light.push_back({sum[0], sum[1], sum[2], sum[3]});
            continue;
        }
        const double column = double{sum[0]};
        if (!is_largest(picture)) numbers.column.push_back(sum[0]);
        if (depth) continue;
        double mean = std::numeric_limits<double>::quiet_NaN(), deviation = mean;
        if (column > 0) {
            mean = double{sum[1]} / column;
            deviation = unit.unit * std::sqrt(std::max(double{sum[2]} / column - mean * mean, 0.0));
            mean = unit.reference + unit.unit * mean;
        }
        // A root mean square is the deviation from 0.
        if (picture.field.part == FieldPart::magnitude) mean = deviation;
        (is_largest(picture) ? numbers.maximum : numbers.mean).push_back(static_cast<float>(mean));
        if (!is_largest(picture)) numbers.deviation.push_back(static_cast<float>(deviation));
    }
    return numbers;
}

SumImage sums_from(Sums numbers, const ResolvedPicture& picture, FieldUnit unit) {
    SumImage image{numbers.width, numbers.height, channels_of(picture), {}};
    if (image.channels == 1) {
        image.value = std::move(numbers.column);
        return image;
    }
    const auto pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    image.value.resize(4 * pixels);
    for (std::size_t n = 0; n < pixels; ++n) {
        float* const to = &image.value[4 * n];
        if (picture.request.show == Show::volume) {
            const Rgba& pixel = numbers.light[n];
            to[0] = pixel.r, to[1] = pixel.g, to[2] = pixel.b, to[3] = pixel.a;
            continue;
        }
        const bool largest = is_largest(picture);
        const double weight =
            largest ? (std::isnan(numbers.maximum[n]) ? 0 : 1) : double{numbers.column[n]};
        to[0] = static_cast<float>(weight);
        if (is_depth(picture.request.show) || !(weight > 0)) continue;
        double mean = double{largest ? numbers.maximum[n] : numbers.mean[n]};
        double deviation = largest ? 0 : double{numbers.deviation[n]} / unit.unit;
        mean = (mean - unit.reference) / unit.unit;
        if (picture.field.part == FieldPart::magnitude) deviation = std::exchange(mean, 0.0);
        to[1] = static_cast<float>(weight * mean);
        to[2] = static_cast<float>(weight * (mean * mean + deviation * deviation));
    }
    return image;
}

DepthImage depth_of(const Sums& numbers) {
    DepthImage depth(numbers.width, numbers.height);
    depth.depth = numbers.column;
    return depth;
}

float largest_column(const Sums& numbers) {
    if (!numbers.maximum.empty()) return 1;
    return numbers.column.empty() ? 0 : std::ranges::max(numbers.column);
}

ColorScale fitted_scale_of(const Sums& numbers, Show show, ScaleFit fit) try {
    if (is_by_value(show)) return fitted_scale(numbers.maximum, fit);
    const FieldMaps maps{numbers.width, numbers.height, numbers.column, numbers.mean,
                         numbers.deviation};
    return colored_map(maps, show, fit).scale;
} catch (const Error&) {
    // Nothing is above 0.
    if (fit != ScaleFit::log) throw;
    return fitted_scale_of(numbers, show, ScaleFit::linear);
}

}  // namespace vog::viewer
