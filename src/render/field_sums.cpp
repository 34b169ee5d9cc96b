// field_sums.cpp: Choice of a field by its name, and its sums along one ray through one Gaussian in closed
// form, double precision (docs/fields.md). Every renderer is tested against it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "render/shown_field.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

namespace {

/// Parts of vector fields by the text behind the name.
struct Part {
    FieldPart part;
    std::string_view suffix;
};
constexpr std::array<Part, 4> kParts{{{FieldPart::x, "x"},
                                      {FieldPart::y, "y"},
                                      {FieldPart::z, "z"},
                                      {FieldPart::magnitude, "magnitude"}}};

/// "velocity" of "velocity.magnitude".
std::string whole_name(const std::string& text) {
    for (const auto& [part, suffix] : kParts)
        if (text.ends_with(fmt::format(".{}", suffix)))
            return text.substr(0, text.size() - suffix.size() - 1);
    return text;
}

[[noreturn]] void no_such_field(const std::string& text, const Fields& fields) {
    if (fields.empty())
        throw Error(fmt::format(
            "no field '{}': the model has none; vog convert VOLUME -o model.ply --field {} adds it",
            printable(text), printable(whole_name(text))));
    std::vector<std::string> names;
    for (const std::string& name : fields.names()) names.push_back(printable(name));
    throw Error(
        fmt::format("no field '{}' in the model, expected one of {}{}; vog convert VOLUME -o "
                    "model.ply --field NAME adds others",
                    printable(text), fmt::join(names, ", "),
                    fields.vector.empty()
                        ? ""
                        : " (of a vector field NAME.x, NAME.y, NAME.z or NAME.magnitude, too)"));
}

}  // namespace

FieldChoice field_choice(const std::string& text, const Fields& fields) {
    if (fields.find_scalar(text)) return {text, FieldPart::value};
    if (fields.find_vector(text)) return {text, FieldPart::view};
    const std::size_t dot = text.rfind('.');
    if (dot == std::string::npos) no_such_field(text, fields);
    const std::string name = text.substr(0, dot);
    if (fields.find_vector(name))
        for (const auto& [part, suffix] : kParts)
            if (text.substr(dot + 1) == suffix) return {name, part};
    no_such_field(text, fields);
}

std::string field_label(const FieldChoice& choice) {
    if (choice.part == FieldPart::value) return choice.field;
    if (choice.part == FieldPart::view) return choice.field + " along the view";
    if (choice.part == FieldPart::magnitude) return "rms of " + choice.field;
    const auto* found = std::ranges::find(kParts, choice.part, &Part::part);
    return choice.field + "." + std::string(found->suffix);
}

FieldSums field_sums(const Gaussians& gaussians, const FieldChoice& choice, std::size_t i,
                     Vec3d origin, Vec3d direction, const Clipping& clip) {
    if (choice.part == FieldPart::magnitude) {
        FieldSums all;
        for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z}) {
            const FieldSums one =
                field_sums(gaussians, {choice.field, part}, i, origin, direction, clip);
            all = {one.column, 0, all.second + one.second};
        }
        return all;
    }
    const Vec3d along = normalized(direction);
    const Mat3 w = whitening(gaussians, i);
    const Vec3d to_mean = vec_cast<double>(gaussians.mean[i]) - (origin - gaussians.origin);
    const double k = double{gaussians.cutoff}, density = double{gaussians.density[i]};
    const RayInterval seen = clipped_ray(clip, origin, along);
    const device::SegmentMoments s = device::segment_moments(plain(w * to_mean), plain(w * along),
                                                             k * k, {seen.first, seen.last});
    if (!(s.zeroth > 0)) return {};
    const device::FieldPlane plane = field_towards(gaussians, choice, along).plane(i);
    const device::FieldMean mean =
        device::mean_along(plane, plain(s.nearest * along - to_mean), plain(along), s);
    const double column = density * s.zeroth;
    return {column, column * mean.first, column * mean.second};
}

std::vector<float> values_for_scale(const FieldMaps& maps, std::span<const float> shown) {
    const float least = 1e-3f * *std::ranges::max_element(maps.column);
    std::vector<float> values;
    for (std::size_t n = 0; n < shown.size(); ++n)
        if (maps.column[n] > 0 && maps.column[n] >= least) values.push_back(shown[n]);
    return values;
}

ValueMap visible_values(const FieldMaps& maps, std::span<const float> shown, double least_share) {
    ValueMap map{maps.width, maps.height, {shown.begin(), shown.end()}};
    const double least = least_share * double{*std::ranges::max_element(maps.column)};
    for (std::size_t n = 0; n < shown.size(); ++n)
        if (!(maps.column[n] > 0) || double{maps.column[n]} < least)
            map.value[n] = std::numeric_limits<float>::quiet_NaN();
    return map;
}

}  // namespace vog
