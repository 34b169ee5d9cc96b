// web_fields.cpp: quantisation of fields to bytes with bounded errors.
#include "web/web_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace vog::web {

namespace {

constexpr int kValueWords = 65535, kChangeWords = 511, kDeviationWords = 1023, kRestWords = 127;

/// One component of a field, in a page's units.
struct Component {
    std::vector<double> value, deviation;
    std::vector<Vec3d> change;  ///< over a standard deviation along each own axis
};

/// Change of a plane over a standard deviation along the axes that the page has.
/// gradient  per world unit
Vec3d own_change(const WebShapes& shapes, const WebFrame& frame, std::size_t n, Vec3f gradient) {
    Vec3d along = vec_cast<double>(gradient);
    if (shapes.rotated) along = transpose(matrix_from_quat(shapes.rotation[n])) * along;
    for (int axis = 0; axis < 3; ++axis)
        along[axis] *= frame.unit * std::exp2(shapes.log_scale[n][axis]);
    return along;
}

/// Columns of bytes, and numbers of 10 bits whose lower two are gathered in columns at the end.
class Columns {
  public:
    explicit Columns(std::size_t count) : count_(count) {}
    void add(const std::vector<std::uint8_t>& column) {
        bytes_.append(column.begin(), column.end());
    }
    void add_split(const std::vector<std::uint16_t>& tens) {
        if (lows_ % 4 == 0) low_.emplace_back(count_, std::uint8_t{0});
        std::vector<std::uint8_t> column(count_);
        for (std::size_t n = 0; n < count_; ++n) {
            column[n] = static_cast<std::uint8_t>(tens[n] >> 2);
            low_.back()[n] =
                static_cast<std::uint8_t>(low_.back()[n] | (tens[n] & 3) << 2 * (lows_ % 4));
        }
        ++lows_;
        add(column);
    }
    std::string bytes() {
        for (const std::vector<std::uint8_t>& column : low_) add(column);
        low_.clear();
        return std::move(bytes_);
    }

  private:
    std::size_t count_;
    int lows_ = 0;
    std::string bytes_;
    std::vector<std::vector<std::uint8_t>> low_;
};

int word(double share, int most) {
    return static_cast<int>(std::lround(std::clamp(share, -1.0, 1.0) * most));
}

void add_value(const Component& of, WebField& field, Columns& columns) {
    const std::size_t count = of.value.size();
    WebField::Value range;
    if (count > 0) {
        const auto [low, high] = std::ranges::minmax(of.value);
        range = {low, high > low ? (high - low) / kValueWords : 1};
    }
    std::vector<std::uint8_t> low(count), high(count);
    for (std::size_t n = 0; n < count; ++n) {
        const int w = std::clamp(
            static_cast<int>(std::lround((of.value[n] - range.low) / range.step)), 0, kValueWords);
        low[n] = static_cast<std::uint8_t>(w & 0xff), high[n] = static_cast<std::uint8_t>(w >> 8);
    }
    field.value.push_back(range);
    columns.add(low);
    columns.add(high);
}

void add_changes(const Component& of, double most, Columns& columns) {
    std::vector<std::uint16_t> tens(of.change.size());
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t n = 0; n < tens.size(); ++n) {
            const double share = of.change[n][axis] / most;
            tens[n] = static_cast<std::uint16_t>(
                512 + word(std::copysign(std::sqrt(std::abs(share)), share), kChangeWords));
        }
        columns.add_split(tens);
    }
}

void add_deviations(const Component& of, double most, Columns& columns) {
    std::vector<std::uint16_t> tens(of.deviation.size());
    for (std::size_t n = 0; n < tens.size(); ++n)
        tens[n] =
            static_cast<std::uint16_t>(word(std::sqrt(of.deviation[n] / most), kDeviationWords));
    columns.add_split(tens);
}

/// Numbers from -1 to 1.
void add_shares(const std::vector<double>& shares, Columns& columns) {
    std::vector<std::uint8_t> column(shares.size());
    for (std::size_t n = 0; n < shares.size(); ++n)
        column[n] = static_cast<std::uint8_t>(kRestWords + word(shares[n], kRestWords));
    columns.add(column);
}

double largest(const std::vector<Component>& components, bool of_changes) {
    double most = 0;
    for (const Component& of : components) {
        for (const Vec3d c : of.change)
            if (of_changes) most = std::max({most, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
        for (const double deviation : of.deviation)
            if (!of_changes) most = std::max(most, deviation);
    }
    return most > 0 ? most : 1;
}

/// rest  columns of numbers from -1 to 1
WebField encoded(const std::vector<Component>& components,
                 const std::vector<std::vector<double>>& rest) {
    WebField field;
    field.change = largest(components, true);
    field.deviation = largest(components, false);
    Columns columns(components.front().value.size());
    for (const Component& of : components) add_value(of, field, columns);
    for (const Component& of : components) add_changes(of, field.change, columns);
    for (const Component& of : components) add_deviations(of, field.deviation, columns);
    for (const std::vector<double>& shares : rest) add_shares(shares, columns);
    field.bytes = columns.bytes();
    return field;
}

}  // namespace

WebUnit web_unit(const ScalarField& field) {
    const double half = 0.5 * (field.upper - field.lower);
    if (half > 0) return {field.lower + half, half};
    // Data of one value: as ExpectedLight has it.
    return {field.lower, std::max(std::abs(field.lower), 1e-300) * 1e-3};
}
WebUnit web_unit(const VectorField& field) { return {0, field.upper > 0 ? field.upper : 1}; }

WebField web_field(const WebShapes& shapes, const WebFrame& frame, const ScalarField& field) {
    const WebUnit in = web_unit(field);
    const std::size_t count = shapes.index.size();
    Component of{std::vector<double>(count), std::vector<double>(count), std::vector<Vec3d>(count)};
    std::vector<double> skewness(count);
    parallel_for(std::size_t{0}, count, [&](std::size_t n) {
        const std::size_t i = shapes.index[n];
        of.value[n] = (double{field.value[i]} - in.reference) / in.unit;
        of.deviation[n] = double{field.deviation[i]} / in.unit;
        of.change[n] = (1 / in.unit) * own_change(shapes, frame, n, field.gradient[i]);
        skewness[n] = double{field.skewness[i]} / 3;
    });
    return encoded({std::move(of)}, {std::move(skewness)});
}

WebField web_field(const WebShapes& shapes, const WebFrame& frame, const VectorField& field) {
    const WebUnit in = web_unit(field);
    const std::size_t count = shapes.index.size();
    const Component empty{std::vector<double>(count), std::vector<double>(count),
                          std::vector<Vec3d>(count)};
    std::vector<Component> components(3, empty);
    std::vector<std::vector<double>> correlation(3, std::vector<double>(count));
    parallel_for(std::size_t{0}, count, [&](std::size_t n) {
        const std::size_t i = shapes.index[n];
        const std::array<float, 6>& r = field.covariance[i];
        const double diagonal[3] = {double{r[0]}, double{r[3]}, double{r[5]}};
        const double off[3] = {double{r[1]}, double{r[2]}, double{r[4]}};
        const Vec3d value = vec_cast<double>(field.value[i]);
        for (std::size_t c = 0; c < 3; ++c) {
            components[c].value[n] = (value[static_cast<int>(c)] - in.reference) / in.unit;
            components[c].deviation[n] = std::sqrt(std::max(diagonal[c], 0.0)) / in.unit;
            components[c].change[n] =
                (1 / in.unit) * own_change(shapes, frame, n, field.gradient[c][i]);
            const double product = diagonal[c == 2 ? 1 : 0] * diagonal[c == 0 ? 1 : 2];
            correlation[c][n] = product > 0 ? off[c] / std::sqrt(product) : 0;  // xy xz yz
        }
    });
    return encoded(components, correlation);
}

}  // namespace vog::web
