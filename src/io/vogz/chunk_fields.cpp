// chunk_fields.cpp: columns of a field: deviations, values, changes over a standard deviation, skewness or correlations.
#include "io/vogz/chunk_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace vog::vogz {

namespace {

using Index = std::span<const std::uint32_t>;

/// Writes columns of numbers rounded to multiples of a step.
class ColumnWriter {
  public:
    ColumnWriter(std::size_t count, Compression compression)
        : numbers_(count), compression_(compression) {}
    /// value(n)  of number n of the chunk
    template <class Value>
    void add(double step, const Value& value) {
        for (std::size_t n = 0; n < numbers_.size(); ++n)
            numbers_[n] = std::llrint(std::clamp(value(n) / step, -kMost, kMost));
        put_numbers(bytes_, numbers_, compression_);
    }
    std::string take() { return std::move(bytes_); }

  private:
    static constexpr double kMost =
        1e15;  // far beyond the range of a field, and well inside of 64 bits
    std::vector<std::int64_t> numbers_;
    Compression compression_;
    std::string bytes_;
};

/// Reads what ColumnWriter wrote.
class ColumnReader {
  public:
    ColumnReader(MemoryBytes& in, std::size_t count, Compression compression)
        : in_(in), numbers_(count), compression_(compression) {}
    /// set(n, value)  for number n of the chunk
    template <class Set>
    void take(double step, const Set& set) {
        take_numbers(in_, numbers_, compression_);
        for (std::size_t n = 0; n < numbers_.size(); ++n)
            set(n, step * static_cast<double>(numbers_[n]));
    }

  private:
    MemoryBytes& in_;
    std::vector<std::int64_t> numbers_;
    Compression compression_;
};

/// Steps of a field's columns, in its unit or as shares.
struct FieldSteps {
    double value, change, root_deviation, share;

    explicit FieldSteps(const FieldRounding& rounding)
        : value(rounding.unit * rounding.step),
          change(rounding.unit * rounding.step * kChangeSteps),
          root_deviation(rounding.step * kDeviationSteps),
          share(rounding.step * kShareSteps) {}
};

/// Places of the variances and covariances among xx xy xz yy yz zz.
constexpr std::array<std::size_t, 3> kVariances{0, 3, 5};
struct Correlation {
    std::size_t place, a, b;
};
constexpr std::array<Correlation, 3> kCorrelations{{{1, 0, 1}, {2, 0, 2}, {4, 1, 2}}};

float finite(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -kMost, kMost));
}

}  // namespace

std::string field_chunk(const ScalarField& field, const FieldRounding& rounding, Index index,
                        std::span<const double> spread, Compression compression) {
    const FieldSteps steps(rounding);
    ColumnWriter columns(index.size(), compression);
    columns.add(steps.root_deviation, [&](std::size_t n) {
        return std::sqrt(field.deviation[index[n]] / rounding.unit);
    });
    columns.add(steps.value,
                [&](std::size_t n) { return field.value[index[n]] - rounding.reference; });
    for (int axis = 0; axis < 3; ++axis)
        columns.add(steps.change, [&](std::size_t n) {
            return spread[n] * double{field.gradient[index[n]][axis]};
        });
    columns.add(steps.share, [&](std::size_t n) { return double{field.skewness[index[n]]}; });
    return columns.take();
}

std::string field_chunk(const VectorField& field, const FieldRounding& rounding, Index index,
                        std::span<const double> spread, Compression compression) {
    const FieldSteps steps(rounding);
    ColumnWriter columns(index.size(), compression);
    for (const std::size_t place : kVariances)
        columns.add(steps.root_deviation, [&](std::size_t n) {
            const double variance = std::max(0.0f, field.covariance[index[n]][place]);
            return std::sqrt(std::sqrt(variance) / rounding.unit);
        });
    for (int axis = 0; axis < 3; ++axis)
        columns.add(steps.value,
                    [&](std::size_t n) { return double{field.value[index[n]][axis]}; });
    for (const auto& gradient : field.gradient)
        for (int axis = 0; axis < 3; ++axis)
            columns.add(steps.change, [&](std::size_t n) {
                return spread[n] * double{gradient[index[n]][axis]};
            });
    for (const auto [place, a, b] : kCorrelations)
        columns.add(steps.share, [&, place = place, a = a, b = b](std::size_t n) {
            const auto& c = field.covariance[index[n]];
            const double variances = double{c[kVariances[a]]} * c[kVariances[b]];
            return variances > 0 ? std::clamp(c[place] / std::sqrt(variances), -1.0, 1.0) : 0;
        });
    return columns.take();
}

void read_field(MemoryBytes& in, const FieldRounding& rounding, Compression compression,
                ScalarField& field, std::size_t begin, std::span<const double> spread) {
    const FieldSteps steps(rounding);
    ColumnReader columns(in, spread.size(), compression);
    columns.take(steps.root_deviation, [&](std::size_t n, double root) {
        field.deviation[begin + n] = finite(root * root * rounding.unit);
    });
    columns.take(steps.value, [&](std::size_t n, double value) {
        field.value[begin + n] = finite(value + rounding.reference);
    });
    for (int axis = 0; axis < 3; ++axis)
        columns.take(steps.change, [&](std::size_t n, double change) {
            field.gradient[begin + n][axis] = finite(change / spread[n]);
        });
    columns.take(steps.share, [&](std::size_t n, double skewness) {
        field.skewness[begin + n] = static_cast<float>(std::clamp(skewness, -3.0, 3.0));
    });
}

void read_field(MemoryBytes& in, const FieldRounding& rounding, Compression compression,
                VectorField& field, std::size_t begin, std::span<const double> spread) {
    const FieldSteps steps(rounding);
    ColumnReader columns(in, spread.size(), compression);
    for (const std::size_t place : kVariances)
        columns.take(steps.root_deviation, [&](std::size_t n, double root) {
            const double deviation = root * root * rounding.unit;
            field.covariance[begin + n][place] = finite(deviation * deviation);
        });
    for (int axis = 0; axis < 3; ++axis)
        columns.take(steps.value, [&](std::size_t n, double value) {
            field.value[begin + n][axis] = finite(value);
        });
    for (auto& gradient : field.gradient)
        for (int axis = 0; axis < 3; ++axis)
            columns.take(steps.change, [&](std::size_t n, double change) {
                gradient[begin + n][axis] = finite(change / spread[n]);
            });
    // Rounding by half a step may leave a matrix of correlations with an eigenvalue as low as -step; a share of the unit
    // matrix makes up for it.
    const double shrink = 1 / (1 + steps.share);
    for (const auto [place, a, b] : kCorrelations)
        columns.take(steps.share, [&, place = place, a = a, b = b](std::size_t n, double share) {
            auto& c = field.covariance[begin + n];
            c[place] = finite(shrink * std::clamp(share, -1.0, 1.0) *
                              std::sqrt(double{c[kVariances[a]]} * c[kVariances[b]]));
        });
}

namespace {

/// Step of the logarithms of lengths.
constexpr double kLengthStep = 1.0 / 64;
constexpr std::int64_t kNoLength = -(1 << 20);

std::int64_t length_word(double length) {
    return length > 0 ? static_cast<std::int64_t>(std::ceil(std::log(length) / kLengthStep))
                      : kNoLength;
}
float length_of(std::int64_t word) {
    if (word <= kNoLength) return 0;
    return std::nextafter(finite(std::exp(static_cast<double>(word) * kLengthStep)),
                          std::numeric_limits<float>::max());
}

}  // namespace

std::string link_chunk(const Hierarchy& hierarchy, std::size_t begin, std::size_t end, double step,
                       Compression compression) {
    // A mean moves by at most 0.71 steps of its Gaussian's standard deviations an axis, the support grows by at most one.
    const double larger = 1 + 4 * step;
    std::string bytes;
    std::vector<std::uint64_t> words;
    for (const auto* counts : {&hierarchy.node_count, &hierarchy.leaf_count}) {
        words.assign(counts->begin() + static_cast<std::ptrdiff_t>(begin),
                     counts->begin() + static_cast<std::ptrdiff_t>(end));
        put_words(bytes, words, compression);
    }
    std::vector<std::int64_t> lengths;
    for (std::size_t n = begin; n < end; ++n)
        lengths.push_back(length_word(larger * double{hierarchy.radius[n]}));
    put_numbers(bytes, lengths, compression);
    lengths.clear();
    for (std::size_t n = begin; n < end; ++n) lengths.push_back(length_word(hierarchy.error[n]));
    put_numbers(bytes, lengths, compression);
    return bytes;
}

void read_links(MemoryBytes& in, Compression compression, Hierarchy& hierarchy, std::size_t begin,
                std::size_t end) {
    std::vector<std::uint64_t> words(end - begin);
    for (auto* counts : {&hierarchy.node_count, &hierarchy.leaf_count}) {
        take_words(in, words, compression);
        for (std::size_t n = begin; n < end; ++n) {
            if (words[n - begin] > 255)
                in.fail(fmt::format("corrupt: node {} with {} children", n, words[n - begin]));
            (*counts)[n] = static_cast<std::uint8_t>(words[n - begin]);
        }
    }
    std::vector<std::int64_t> lengths(end - begin);
    for (auto* array : {&hierarchy.radius, &hierarchy.error}) {
        take_numbers(in, lengths, compression);
        for (std::size_t n = begin; n < end; ++n) (*array)[n] = length_of(lengths[n - begin]);
    }
}

}  // namespace vog::vogz
