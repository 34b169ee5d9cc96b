// chunk_shapes.cpp: a chunk is the exponents of its lattices, then columns: steps along the Morton curve from cell to cell,
// entries of the logarithms of shapes, masses, and places inside of the cells.
#include "io/vogz/chunk_shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/morton.h"
#include "io/vogz/bits.h"
#include "io/vogz/log_shape.h"
#include "vog/error.h"

namespace vog::vogz {

namespace {

/// Whole numbers of a lattice along the three axes.
using Place = std::array<std::int64_t, 3>;

/// Most bits of a place inside of its cell, along an axis.
constexpr int kMostPlaceBits = 40;

/// 2^exponent
/// exponent  of a normal number: -1022 to 1023
double power_of_two(int exponent) {
    constexpr int kBias = 1023, kDigits = 52;
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << kDigits);
}

/// Lattices of one chunk. Where Gaussians are much longer than thick, they are finer by powers of two.
struct ChunkLattice {
    std::int16_t cell_exponent = 0;  ///< edge of a cell: edge * 2^this
    std::uint8_t finer_mean = 0, finer_shape = 0;
    Place base{};            ///< least cell along each axis
    double mass_factor = 1;  ///< on all masses, near 1: that of the chunk is exact

    int exponent(const ShapeRounding& rounding, std::int64_t trace) const {
        return rounding.exponent(power_of_two(-finer_shape) * static_cast<double>(trace)) -
               finer_mean;
    }
    int place_bits(int exponent) const {
        return std::clamp(cell_exponent - exponent, 0, kMostPlaceBits);
    }
};

/// log2 of a mean ratio as a number of halvings.
std::uint8_t halvings(double mean_of_squares) {
    constexpr double kMost = 20;
    return static_cast<std::uint8_t>(
        std::clamp(std::floor(0.5 * std::log2(mean_of_squares)), 0.0, kMost));
}

/// Logarithms of a run of Gaussians, in its order.
struct Logarithms {
    std::array<std::vector<double>, 3> scale;  ///< along the Gaussians' own axes
    std::vector<double> mass;                  ///< of density * s0 * s1 * s2
};
Logarithms logarithms(const Gaussians& model, std::span<const std::uint32_t> index) {
    Logarithms logs;
    auto& [x, y, z] = logs.scale;
    for (auto* numbers : {&x, &y, &z, &logs.mass}) numbers->resize(index.size());
    for (std::size_t n = 0; n < index.size(); ++n) {
        const Vec3f s = model.scale[index[n]];
        x[n] = double{s.x}, y[n] = double{s.y}, z[n] = double{s.z};
        logs.mass[n] = double{model.density[index[n]]};
    }
    for (auto* numbers : {&x, &y, &z, &logs.mass}) take_logarithms(*numbers);
    for (const auto& scale : logs.scale)
        for (std::size_t n = 0; n < index.size(); ++n) logs.mass[n] += scale[n];
    return logs;
}

/// How much finer the means and shapes of a chunk are rounded than of round Gaussians.
void set_fineness(const Logarithms& logs, bool rotated, ChunkLattice& lattice) {
    const auto& [x, y, z] = logs.scale;
    const std::size_t count = x.size();
    // An error of 1 along an axis is one of spread / s in standard deviations. Its square:
    double mean = 0;
    std::vector<double> numbers(count);
    for (const auto& scale : logs.scale) {
        for (std::size_t n = 0; n < count; ++n)
            numbers[n] = 2 * ((x[n] + y[n] + z[n]) / 3 - scale[n]);
        take_exponentials(numbers);
        for (const double square : numbers) mean += square;
    }
    // A shear e of axes of the ratio exp(r) turns them by e / r, which changes the Gaussian by sinh(r) e / r.
    double shape = 0;
    const auto ratio = [&](std::size_t n) {
        return std::min(std::max({x[n], y[n], z[n]}) - std::min({x[n], y[n], z[n]}), 40.0);
    };
    for (std::size_t n = 0; n < count; ++n) numbers[n] = ratio(n);
    take_exponentials(numbers);
    for (std::size_t n = 0; n < count; ++n) {
        // sinh(r) / r is 1 + r^2 / 6 for small r, where the difference of exponentials has lost its digits.
        const double r = ratio(n);
        const double turn = r > 1e-3 ? (numbers[n] - 1 / numbers[n]) / (2 * r) : 1 + r * r / 6;
        shape += rotated ? turn * turn : 1;
    }
    const auto n = static_cast<double>(count);
    lattice.finer_mean = halvings(mean / (3 * n));
    lattice.finer_shape = halvings(shape / n);
}

Place cell_of(const Place& place, int bits) {
    return {place[0] >> bits, place[1] >> bits, place[2] >> bits};
}

/// Steps along the Morton curve, from 0.
std::vector<std::uint64_t> curve_steps(std::span<const Place> cells, const Place& base) {
    std::vector<std::uint64_t> steps;
    steps.reserve(cells.size());
    std::uint64_t before = 0;
    for (const Place& cell : cells) {
        const auto from_base = [&](std::size_t axis) {
            return static_cast<std::uint64_t>(cell[axis] - base[axis]);
        };
        const std::uint64_t code = morton_code(from_base(0), from_base(1), from_base(2));
        steps.push_back(zigzag(static_cast<std::int64_t>(code - before)));
        before = code;
    }
    return steps;
}

[[noreturn]] void refuse_scales() {
    throw Error(
        "compact model: Gaussians too small and too far apart for one lattice, expected scales "
        "within a factor of 10^9 of each other and of the model's box");
}

/// Cells of places, and steps along the Morton curve from one to the next.
struct Cells {
    std::vector<std::uint64_t> steps;
    Place base{};
    std::int64_t bits_inside = 0;
    bool fit = true;  ///< whether Morton codes hold them
};
Cells cells_at(std::span<const Place> place, std::span<const int> exponent, int cell_exponent) {
    Cells cells;
    std::vector<Place> cell(place.size());
    cells.base.fill(std::numeric_limits<std::int64_t>::max());
    Place last{};
    last.fill(std::numeric_limits<std::int64_t>::min());
    for (std::size_t n = 0; n < place.size(); ++n) {
        const int bits = cell_exponent - exponent[n];
        cell[n] = cell_of(place[n], std::clamp(bits, 0, 62));
        cells.bits_inside += 3 * bits;
        cells.fit = cells.fit && bits >= 0 && bits <= kMostPlaceBits;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cells.base[axis] = std::min(cells.base[axis], cell[n][axis]);
            last[axis] = std::max(last[axis], cell[n][axis]);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
        cells.fit = cells.fit && last[axis] - cells.base[axis] < std::int64_t{1} << kMortonAxisBits;
    if (cells.fit) cells.steps = curve_steps(cell, cells.base);
    return cells;
}

/// Exponent of the cells that take the fewest bits; none if none fit.
/// first  where the search begins
std::optional<int> best_exponent(std::span<const Place> place, std::span<const int> exponent,
                                 int first) {
    const auto [finest, coarsest] = std::ranges::minmax(exponent);
    const int most = finest + kMostPlaceBits;
    const auto bits_at = [&](int e) {
        const Cells cells = cells_at(place, exponent, e);
        return cells.fit ? static_cast<double>(cells.bits_inside) + column_bits(cells.steps)
                         : std::numeric_limits<double>::infinity();
    };
    // Cells are at least as much larger as it takes for Morton codes to hold them; larger ones cost less, then more.
    int best = std::clamp(first, coarsest, std::max(coarsest, most));
    double least = bits_at(best);
    while (std::isinf(least) && best < most) least = bits_at(++best);
    if (std::isinf(least)) return std::nullopt;
    for (const int direction : {-1, 1}) {
        const int before = best;
        for (int e = best + direction; e >= coarsest && e <= most; e += direction) {
            const double bits = bits_at(e);
            if (!(bits < least)) break;
            least = bits, best = e;
        }
        if (best != before) break;
    }
    return best;
}

/// Exponent of cells as large as the place that each Gaussian has in the box of all.
int even_exponent(std::span<const Place> place, std::span<const int> exponent) {
    double log_volume = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double lower = std::numeric_limits<double>::infinity(), upper = -lower;
        for (std::size_t n = 0; n < place.size(); ++n) {
            const double at = static_cast<double>(place[n][axis]) * power_of_two(exponent[n]);
            lower = std::min(lower, at), upper = std::max(upper, at);
        }
        log_volume += std::log2(std::max(upper - lower, std::ldexp(1.0, exponent.front())));
    }
    return static_cast<int>(
        std::lround((log_volume - std::log2(static_cast<double>(place.size()))) / 3));
}

/// Cells of all places at the exponent that takes the fewest bits.
Cells best_cells(std::span<const Place> place, std::span<const int> exponent,
                 ChunkLattice& lattice) {
    // The choice by a part of the chunk, near each other as all are; it must hold them all.
    constexpr std::size_t kSample = 1024;
    const std::size_t sample = std::min(place.size(), kSample), from = (place.size() - sample) / 2;
    const auto some_places = place.subspan(from, sample);
    const auto some_exponents = exponent.subspan(from, sample);
    std::optional<int> best =
        best_exponent(some_places, some_exponents, even_exponent(some_places, some_exponents));
    Cells cells;
    cells.fit = false;
    if (best) cells = cells_at(place, exponent, *best);
    if (!cells.fit) {
        best = best_exponent(place, exponent, best.value_or(std::ranges::max(exponent)));
        if (!best) refuse_scales();
        cells = cells_at(place, exponent, *best);
    }
    lattice.cell_exponent = static_cast<std::int16_t>(*best);
    lattice.base = cells.base;
    return cells;
}

}  // namespace

ShapeChunk shape_chunk(const Gaussians& model, std::span<const std::uint32_t> index,
                       const ShapeRounding& rounding, Compression compression) {
    const std::size_t count = index.size();
    const std::size_t entries = model.axis_aligned() ? kDiagonal : std::tuple_size_v<ShapeEntries>;
    const Logarithms logs = logarithms(model, index);
    ChunkLattice lattice;
    set_fineness(logs, !model.axis_aligned(), lattice);

    // Words of shapes and masses; places on the lattices that follow from them.
    LogShapes shapes = log_shapes(model, index, logs.scale);
    std::array<std::vector<std::int64_t>, 7> column;
    for (auto& words : column) words.resize(count);
    const double finer = std::ldexp(1.0, -lattice.finer_shape);
    for (std::size_t k = 0; k < entries; ++k) {
        const double step = finer * (k < kDiagonal ? rounding.diagonal_step : rounding.shear_step);
        take_nearest(shapes.entry[k], 1 / step, column[k]);
    }
    take_nearest(logs.mass, 1 / rounding.mass_step, column[6]);
    ShapeChunk chunk;
    chunk.extent = std::move(shapes.extent);
    chunk.spread.resize(count);
    std::vector<double> rounded_mass(count);
    std::vector<int> exponent(count);
    std::vector<Place> place(count);
    for (std::size_t n = 0; n < count; ++n) {
        const std::int64_t trace = column[0][n] + column[1][n] + column[2][n];
        chunk.spread[n] = finer * rounding.diagonal_step * static_cast<double>(trace) / 3;
        rounded_mass[n] = static_cast<double>(column[6][n]) * rounding.mass_step;
        exponent[n] = lattice.exponent(rounding, trace);
        const Vec3d from = vec_cast<double>(model.mean[index[n]]) - rounding.corner;
        const double cells = power_of_two(-exponent[n]) / rounding.edge;
        for (int axis = 0; axis < 3; ++axis) {
            const double steps = from[axis] * cells;  // 0 at least: rounded down by the conversion
            if (!(steps < 0x1p62)) refuse_scales();
            place[n][static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(steps);
        }
    }
    take_exponentials(chunk.spread);
    take_exponentials(rounded_mass);
    double mass = 0, all_rounded = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const Vec3d s = vec_cast<double>(model.scale[index[n]]);
        mass += double{model.density[index[n]]} * s.x * s.y * s.z;
        all_rounded += rounded_mass[n];
    }
    const Cells cells = best_cells(place, exponent, lattice);
    lattice.mass_factor = mass / all_rounded;

    put(chunk.bytes, lattice.cell_exponent);
    put(chunk.bytes, lattice.finer_mean);
    put(chunk.bytes, lattice.finer_shape);
    for (const std::int64_t base : lattice.base) put(chunk.bytes, base);
    put(chunk.bytes, lattice.mass_factor);
    put_words(chunk.bytes, cells.steps, compression);
    for (std::size_t k = 0; k < entries; ++k) put_numbers(chunk.bytes, column[k], compression);
    put_numbers(chunk.bytes, column[6], compression);
    BitWriter bits(static_cast<std::size_t>(cells.bits_inside));
    for (std::size_t n = 0; n < count; ++n) {
        const auto inside = static_cast<unsigned>(lattice.place_bits(exponent[n]));
        const std::uint64_t mask = (std::uint64_t{1} << inside) - 1;
        const auto [x, y, z] = place[n];
        const auto lower = [&](std::int64_t at) { return static_cast<std::uint64_t>(at) & mask; };
        if (3 * inside <= kMostBits)
            bits.put(lower(x) | lower(y) << inside | lower(z) << 2 * inside, 3 * inside);
        else
            for (const std::int64_t at : place[n]) bits.put(lower(at), inside);
    }
    const std::string places = bits.take();
    put(chunk.bytes, static_cast<std::uint32_t>(places.size()));
    chunk.bytes += places;
    return chunk;
}

void read_shapes(MemoryBytes& in, const ShapeRounding& rounding, Compression compression,
                 Gaussians& model, std::size_t begin, std::span<double> spread) {
    const std::size_t count = spread.size();
    const std::size_t entries = model.axis_aligned() ? kDiagonal : std::tuple_size_v<ShapeEntries>;
    ChunkLattice lattice;
    lattice.cell_exponent = in.number<std::int16_t>();
    lattice.finer_mean = in.number<std::uint8_t>();
    lattice.finer_shape = in.number<std::uint8_t>();
    for (std::int64_t& base : lattice.base) base = in.number<std::int64_t>();
    lattice.mass_factor = in.number<double>();
    // Kept between chunks: fresh memory costs more than the numbers in it.
    thread_local std::vector<std::uint64_t> steps;
    thread_local std::array<std::vector<std::int64_t>, 7> column;
    thread_local ShapeEntries shapes;
    thread_local std::vector<double> masses;
    steps.resize(count), masses.resize(count);
    take_words(in, steps, compression);
    for (std::size_t k = 0; k < column.size(); ++k) {
        column[k].resize(count);
        if (k < entries || k == 6) take_numbers(in, column[k], compression);
    }
    const auto place_bytes = in.number<std::uint32_t>();
    BitReader bits({in.take(place_bytes), place_bytes});

    const double finer = std::ldexp(1.0, -lattice.finer_shape);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const double step = finer * (k < kDiagonal ? rounding.diagonal_step : rounding.shear_step);
        shapes[k].resize(k < entries ? count : 0);
        for (std::size_t n = 0; n < shapes[k].size(); ++n)
            shapes[k][n] = step * static_cast<double>(column[k][n]);
    }
    set_shapes(model, begin, shapes, spread);
    for (std::size_t n = 0; n < count; ++n)
        masses[n] = static_cast<double>(column[6][n]) * rounding.mass_step;
    take_exponentials(masses);
    std::uint64_t code = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t i = begin + n;
        // Unsigned: words of a corrupt file may wrap around.
        const auto trace = static_cast<std::int64_t>(static_cast<std::uint64_t>(column[0][n]) +
                                                     static_cast<std::uint64_t>(column[1][n]) +
                                                     static_cast<std::uint64_t>(column[2][n]));
        const Vec3d s = vec_cast<double>(model.scale[i]);
        const double mass = lattice.mass_factor * masses[n];
        model.density[i] = static_cast<float>(
            std::min(mass / (s.x * s.y * s.z), double{std::numeric_limits<float>::max()}));

        code += static_cast<std::uint64_t>(from_zigzag(steps[n]));
        const int exponent = lattice.exponent(rounding, trace);
        const int inside = lattice.place_bits(exponent);
        const std::array<std::uint64_t, 3> cell{gather_bits(code >> 2), gather_bits(code >> 1),
                                                gather_bits(code)};
        const double edge = rounding.edge * power_of_two(exponent);
        const auto each = static_cast<unsigned>(inside);
        std::array<std::uint64_t, 3> lower;
        if (3 * inside <= kMostBits) {
            const std::uint64_t all = bits.take(3 * each), mask = (std::uint64_t{1} << each) - 1;
            lower = {all & mask, all >> each & mask, all >> 2 * each};
        } else {
            for (std::uint64_t& one : lower) one = bits.take(each);
        }
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            const auto place = static_cast<std::int64_t>(
                (cell[a] + static_cast<std::uint64_t>(lattice.base[a])) << inside | lower[a]);
            model.mean[i][axis] = static_cast<float>(rounding.corner[axis] +
                                                     edge * (static_cast<double>(place) + 0.5));
        }
    }
    if (!bits.at_end())
        in.fail(fmt::format("corrupt: {} bytes of places, expected those of {} Gaussians",
                            place_bytes, count));
}

}  // namespace vog::vogz
