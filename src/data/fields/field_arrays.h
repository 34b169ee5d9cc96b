// field_arrays.h: fields of a model as plain arrays: every array at once, and columns of floats with names.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "vog/fields.h"

namespace vog {

/// Calls visit(a, b, ...) for each array `a` of the first fields and the same array of the others, which are
/// the same fields in the same order. Order: scalar fields, then vector fields; in each as declared.
template <class Visit, class First, class... Others>
void each_array(const Visit& visit, First& first, Others&... others) {
    for (std::size_t k = 0; k < first.scalar.size(); ++k) {
        visit(first.scalar[k].value, others.scalar[k].value...);
        visit(first.scalar[k].gradient, others.scalar[k].gradient...);
        visit(first.scalar[k].deviation, others.scalar[k].deviation...);
        visit(first.scalar[k].skewness, others.scalar[k].skewness...);
    }
    for (std::size_t k = 0; k < first.vector.size(); ++k) {
        visit(first.vector[k].value, others.vector[k].value...);
        for (std::size_t c = 0; c < 3; ++c)
            visit(first.vector[k].gradient[c], others.vector[k].gradient[c]...);
        visit(first.vector[k].covariance, others.vector[k].covariance...);
    }
}

/// Fields of the same names, units and ranges, for no Gaussians.
Fields empty_fields(const Fields& fields);
/// Whether both have the same fields, by kind, name and unit, in the same order.
bool same_fields(const Fields& a, const Fields& b);

/// Names of a field's floats as properties of a file: `temperature`, `temperature_gx`, ... `velocity_zz`; the value of
/// a field that is called as a property of every model, `density_value`. Bytes that are not printable ASCII,
/// blanks and % are written %XX.
std::vector<std::string> column_names(const ScalarField& field);
std::vector<std::string> column_names(const VectorField& field);
/// Names for all fields, in the order of each_array.
std::vector<std::string> column_names(const Fields& fields);
/// Text whose bytes outside of printable ASCII, blanks and % are written %XX.
std::string percent_escaped(const std::string& text);

/// One float of each Gaussian: that of Gaussian i is first[i * step].
template <class Float>
struct Column {
    Float* first;
    std::size_t step;
    Float& operator[](std::size_t i) const { return first[i * step]; }
};
/// Columns in the order of column_names.
/// fields  Fields or const Fields
template <class AnyFields>
auto columns_of(AnyFields& fields) {
    using Float = std::conditional_t<std::is_const_v<AnyFields>, const float, float>;
    std::vector<Column<Float>> columns;
    each_array(
        [&](auto& array) {
            constexpr std::size_t kFloats = sizeof(*array.data()) / sizeof(float);
            auto* first = reinterpret_cast<Float*>(array.data());
            // No arithmetic on the null of an empty array.
            for (std::size_t c = 0; c < kFloats; ++c)
                columns.push_back({array.empty() ? first : first + c, kFloats});
        },
        fields);
    return columns;
}

/// Checks names, units and ranges.
/// throws  vog::Error for an empty name, one that no terminal shows or that collides with another's columns
void check_descriptions(const Fields& fields);
/// Checks descriptions, lengths and values of the fields of n Gaussians.
/// throws  vog::Error with the first offence
void validate(const Fields& fields, std::size_t n);

}  // namespace vog
