// fields.cpp: names, joining and checks of the fields of a model.
#include "vog/fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <type_traits>

#include "core/paging.h"
#include "data/fields/field_arrays.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

namespace {

template <class Field>
const Field* find_named(const std::vector<Field>& fields, const std::string& name) {
    const auto found =
        std::ranges::find_if(fields, [&](const Field& field) { return field.name == name; });
    return found == fields.end() ? nullptr : &*found;
}

template <class Field>
Field described_as(const Field& other) {
    Field field;
    field.name = other.name;
    field.unit = other.unit;
    field.lower = other.lower;
    field.upper = other.upper;
    if constexpr (std::is_same_v<Field, ScalarField>)
        field.is_measure = other.is_measure, field.spread = other.spread,
        field.background = other.background;
    return field;
}

/// Whether a model has a property of this name itself, or a layout of others is told by it (docs/formats.md).
bool is_own_property(const std::string& name) {
    for (const char* own :
         {"x",        "y",       "z",      "scale_0",  "scale_1", "scale_2", "rot_0",
          "rot_1",    "rot_2",   "rot_3",  "density",  "radius",  "error",   "nodes",
          "vertices", "opacity", "sigmat", "sigmat_0", "nx",      "ny",      "nz"})
        if (name == own) return true;
    return name.starts_with("f_dc_") || name.starts_with("f_rest_");
}

std::string in_quotes(const std::string& text) { return fmt::format("'{}'", printable(text, 100)); }

template <class Field>
void check_description(const Field& field) {
    if (field.name.empty()) throw Error("a field without a name, expected one");
    for (const std::string& text : {field.name, field.unit})
        if (printable(text) != text)
            throw Error(fmt::format("field {}, unit {}: expected UTF-8 without control characters",
                                    in_quotes(field.name), in_quotes(field.unit)));
    if (!(field.lower <= field.upper) || !std::isfinite(field.lower) || !std::isfinite(field.upper))
        throw Error(fmt::format("field {}: range {} to {}, expected finite and in this order",
                                in_quotes(field.name), field.lower, field.upper));
    if constexpr (std::is_same_v<Field, ScalarField>)
        if (!std::isfinite(field.background))
            throw Error(fmt::format("field {}: background {}, expected a finite number",
                                    in_quotes(field.name), field.background));
}

/// throws vog::Error unless both lists have fields of the same names and units
template <class Field>
void require_same(const std::vector<Field>& fields, const std::vector<Field>& others) {
    for (const auto& [from, to] : {std::pair{&fields, &others}, std::pair{&others, &fields}})
        for (const Field& field : *from) {
            const Field* same = find_named(*to, field.name);
            if (!same)
                throw Error(
                    fmt::format("field {}: one model has it and one has not, expected the same "
                                "fields in models that are joined",
                                in_quotes(field.name)));
            if constexpr (std::is_same_v<Field, ScalarField>) {
                if (same->background != field.background)
                    throw Error(fmt::format(
                        "field {}: backgrounds {} and {}, expected one in models that are joined",
                        in_quotes(field.name), field.background, same->background));
                if (same->is_measure != field.is_measure)
                    throw Error(
                        fmt::format("field {}: the measure itself in one model and not in the "
                                    "other, expected the same fields in models that are joined",
                                    in_quotes(field.name)));
            }
            if (same->unit != field.unit)
                throw Error(fmt::format("field {}: in {} and in {}, expected one unit",
                                        in_quotes(field.name), in_quotes(field.unit),
                                        in_quotes(same->unit)));
        }
}

void append_arrays(ScalarField& field, const ScalarField& other) {
    append_kept(field.value, other.value);
    append_kept(field.gradient, other.gradient);
    append_kept(field.deviation, other.deviation);
    append_kept(field.skewness, other.skewness);
}

void append_arrays(VectorField& field, const VectorField& other) {
    append_kept(field.value, other.value);
    for (std::size_t c = 0; c < 3; ++c) append_kept(field.gradient[c], other.gradient[c]);
    append_kept(field.covariance, other.covariance);
}

/// Refuses a value of one Gaussian. number: "deviation -1, expected finite and >= 0"
[[noreturn]] void refuse(const std::string& field, std::size_t i, const std::string& number) {
    throw Error(fmt::format("Gaussian {}: field {}: {}", i, in_quotes(field), number));
}

template <class... Arrays>
void require_length(const std::string& field, std::size_t n, const Arrays&... arrays) {
    for (const std::size_t length : {arrays.size()...})
        if (length != n)
            throw Error(fmt::format("field {}: an array of {} values, expected {}, one a Gaussian",
                                    in_quotes(field), length, n));
}

std::string text(Vec3f v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

void check_values(const ScalarField& field, std::size_t n) {
    require_length(field.name, n, field.value, field.gradient, field.deviation, field.skewness);
    for (std::size_t i = 0; i < n; ++i) {
        keep_memory_at(i);
        if (!std::isfinite(field.value[i]))
            refuse(field.name, i, fmt::format("value {}, expected finite", field.value[i]));
        if (!finite(field.gradient[i]))
            refuse(field.name, i,
                   fmt::format("gradient {}, expected finite", text(field.gradient[i])));
        if (!(field.deviation[i] >= 0) || !std::isfinite(field.deviation[i]))
            refuse(field.name, i,
                   fmt::format("deviation {}, expected finite and >= 0", field.deviation[i]));
        if (!(std::abs(field.skewness[i]) <= 3))
            refuse(field.name, i,
                   fmt::format("skewness {}, expected in [-3, 3]", field.skewness[i]));
    }
}

void check_values(const VectorField& field, std::size_t n) {
    require_length(field.name, n, field.value, field.gradient[0], field.gradient[1],
                   field.gradient[2], field.covariance);
    for (std::size_t i = 0; i < n; ++i) {
        keep_memory_at(i);
        if (!finite(field.value[i]))
            refuse(field.name, i, fmt::format("value {}, expected finite", text(field.value[i])));
        for (std::size_t c = 0; c < 3; ++c)
            if (!finite(field.gradient[c][i]))
                refuse(field.name, i,
                       fmt::format("gradient {} of {}, expected finite", text(field.gradient[c][i]),
                                   "xyz"[c]));
        const std::array<float, 6>& r = field.covariance[i];
        if (!(r[0] >= 0 && r[3] >= 0 && r[5] >= 0) ||
            !std::ranges::all_of(r, [](float value) { return std::isfinite(value); }))
            refuse(field.name, i,
                   fmt::format("covariance {} {} {} {} {} {} (xx xy xz yy yz zz), expected finite, "
                               "xx, yy and zz >= 0",
                               r[0], r[1], r[2], r[3], r[4], r[5]));
    }
}

}  // namespace

const ScalarField* Fields::find_scalar(const std::string& name) const {
    return find_named(scalar, name);
}

const VectorField* Fields::find_vector(const std::string& name) const {
    return find_named(vector, name);
}

std::vector<std::string> Fields::names() const {
    std::vector<std::string> all;
    for (const ScalarField& field : scalar) all.push_back(field.name);
    for (const VectorField& field : vector) all.push_back(field.name);
    return all;
}

void append(Fields& fields, std::size_t n, const Fields& other, std::size_t m) {
    if (n == 0 && (m > 0 || fields.empty())) {
        fields = other;
        return;
    }
    if (m == 0) return;
    require_same(fields.scalar, other.scalar);
    require_same(fields.vector, other.vector);
    const auto join = [](auto& field, const auto& same) {
        field.lower = std::min(field.lower, same.lower);
        field.upper = std::max(field.upper, same.upper);
        append_arrays(field, same);
    };
    for (ScalarField& field : fields.scalar) {
        const ScalarField& same = *other.find_scalar(field.name);
        if (field.spread != same.spread) field.spread = {};
        join(field, same);
    }
    for (VectorField& field : fields.vector) join(field, *other.find_vector(field.name));
}

Fields empty_fields(const Fields& fields) {
    Fields empty;
    for (const ScalarField& field : fields.scalar) empty.scalar.push_back(described_as(field));
    for (const VectorField& field : fields.vector) empty.vector.push_back(described_as(field));
    return empty;
}

bool same_fields(const Fields& a, const Fields& b) {
    const auto same = [](const auto& one, const auto& other) {
        return one.name == other.name && one.unit == other.unit;
    };
    return std::ranges::equal(a.scalar, b.scalar, same) &&
           std::ranges::equal(a.vector, b.vector, same);
}

std::string percent_escaped(const std::string& text) {
    std::string safe;
    for (const char letter : text)
        if (letter > ' ' && letter < 0x7f && letter != '%')
            safe += letter;
        else
            safe += fmt::format("%{:02X}", static_cast<unsigned char>(letter));
    return safe;
}

std::vector<std::string> column_names(const ScalarField& field) {
    const std::string name = percent_escaped(field.name);
    return {is_own_property(name) ? name + "_value" : name,
            name + "_gx",
            name + "_gy",
            name + "_gz",
            name + "_sd",
            name + "_skew"};
}

std::vector<std::string> column_names(const VectorField& field) {
    const std::string name = percent_escaped(field.name);
    std::vector<std::string> names;
    for (const char* part : {"_x", "_y", "_z", "_x_gx", "_x_gy", "_x_gz", "_y_gx", "_y_gy", "_y_gz",
                             "_z_gx", "_z_gy", "_z_gz", "_xx", "_xy", "_xz", "_yy", "_yz", "_zz"})
        names.push_back(name + part);
    return names;
}

std::vector<std::string> column_names(const Fields& fields) {
    std::vector<std::string> names;
    const auto add = [&](const auto& field) {
        for (std::string& name : column_names(field)) names.push_back(std::move(name));
    };
    std::ranges::for_each(fields.scalar, add);
    std::ranges::for_each(fields.vector, add);
    return names;
}

void check_descriptions(const Fields& fields) {
    std::map<std::string, std::string> field_of;  // column name to field name
    const auto check = [&](const auto& field) {
        check_description(field);
        for (const std::string& column : column_names(field)) {
            const auto [taken, is_new] = field_of.try_emplace(column, field.name);
            if (is_new) continue;
            throw Error(
                taken->second == field.name
                    ? fmt::format("two fields {}, expected one of each name", in_quotes(field.name))
                    : fmt::format("fields {} and {} both have a property {} in files, expected "
                                  "another name for one",
                                  in_quotes(taken->second), in_quotes(field.name),
                                  in_quotes(column)));
        }
    };
    std::ranges::for_each(fields.scalar, check);
    std::ranges::for_each(fields.vector, check);
    // A vector field may share its name with a scalar one and no column.
    for (const VectorField& field : fields.vector)
        if (fields.find_scalar(field.name))
            throw Error(
                fmt::format("two fields {}, expected one of each name", in_quotes(field.name)));
}

void validate(const Fields& fields, std::size_t n) {
    check_descriptions(fields);
    for (const ScalarField& field : fields.scalar) check_values(field, n);
    for (const VectorField& field : fields.vector) check_values(field, n);
}

}  // namespace vog
