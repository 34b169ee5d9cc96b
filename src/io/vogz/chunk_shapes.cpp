// chunk_shapes.cpp: a chunk is the exponents of its lattices, then columns: steps along the Morton curve from cell to cell,
// entries of the logarithms of shapes, masses, and places inside of the cells.
#include "io/vogz/chunk_shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

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

/// Lattices of one chunk. Where Gaussians are much longer than thick, they are finer by powers of two.
struct ChunkLattice {
    std::int16_t cell_exponent = 0;  ///< edge of a cell: edge * 2^this
    std::uint8_t finer_mean = 0, finer_shape = 0;
    Place base{};            ///< least cell along each axis
    double mass_factor = 1;  ///< on all masses, near 1: that of the chunk is exact

    int exponent(const ShapeRounding& rounding, std::int64_t trace) const {
        return rounding.exponent(std::ldexp(static_cast<double>(trace), -finer_shape)) - finer_mean;
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

/// How much finer the means and shapes of a chunk are rounded than of round Gaussians.
void set_fineness(const Gaussians& model, std::span<const std::uint32_t> index,
                  ChunkLattice& lattice) {
    double mean = 0, shape = 0;
    for (const std::uint32_t i : index) {
        const Vec3d s = vec_cast<double>(model.scale[i]);
        const double spread = std::cbrt(s.x * s.y * s.z);
        // An error of 1 along the thinnest axis is one of spread / s in standard deviations.
        mean += (spread * spread) * (1 / (s.x * s.x) + 1 / (s.y * s.y) + 1 / (s.z * s.z)) / 3;
        // A shear e of axes of the ratio exp(r) turns them by e / r, which changes the Gaussian by sinh(r) e / r.
        const double r = std::log(std::max({s.x, s.y, s.z}) / std::min({s.x, s.y, s.z}));
        const double turn = r > 0 ? std::sinh(std::min(r, 40.0)) / r : 1;
        shape += model.axis_aligned() ? 1 : turn * turn;
    }
    const auto n = static_cast<double>(index.size());
    lattice.finer_mean = halvings(mean / n);
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

/// Bits of a place: those of its cell, and those inside.
struct Cells {
    std::vector<Place> cell;
    Place base{};
    double bits = 0;
    bool fit = true;  ///< whether Morton codes hold them
};
Cells cells_at(std::span<const Place> place, std::span<const int> exponent, int cell_exponent) {
    Cells cells;
    cells.base.fill(std::numeric_limits<std::int64_t>::max());
    Place last{};
    last.fill(std::numeric_limits<std::int64_t>::min());
    for (std::size_t n = 0; n < place.size(); ++n) {
        const int bits = std::max(cell_exponent - exponent[n], 0);
        cells.cell.push_back(cell_of(place[n], std::min(bits, 62)));
        cells.bits += 3 * bits;
        cells.fit = cells.fit && bits <= kMostPlaceBits && cell_exponent >= exponent[n];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cells.base[axis] = std::min(cells.base[axis], cells.cell.back()[axis]);
            last[axis] = std::max(last[axis], cells.cell.back()[axis]);
        }
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
        cells.fit = cells.fit && last[axis] - cells.base[axis] < std::int64_t{1} << kMortonAxisBits;
    if (!cells.fit) return cells;
    cells.bits += column_bits(curve_steps(cells.cell, cells.base));
    return cells;
}

/// Edge of the cells that takes the fewest bits.
Cells best_cells(std::span<const Place> place, std::span<const int> exponent,
                 ChunkLattice& lattice) {
    const auto [finest, coarsest] = std::ranges::minmax(exponent);
    Cells best;
    best.fit = false;
    // Gaussians lie a few standard deviations apart, hundreds of steps. Cells are as much larger as it takes for Morton
    // codes to hold them.
    constexpr int kLeast = 2, kMost = 14;
    for (int e = coarsest + kLeast; e <= finest + kMostPlaceBits; ++e) {
        if (best.fit && e > coarsest + kMost) break;
        Cells tried = cells_at(place, exponent, e);
        if (!tried.fit || (best.fit && tried.bits >= best.bits)) continue;
        best = std::move(tried);
        lattice.cell_exponent = static_cast<std::int16_t>(e);
    }
    return best;
}

}  // namespace

ShapeChunk shape_chunk(const Gaussians& model, std::span<const std::uint32_t> index,
                       const ShapeRounding& rounding, Compression compression) {
    const std::size_t count = index.size();
    const std::size_t entries = model.axis_aligned() ? kDiagonal : std::tuple_size_v<LogShape>;
    ShapeChunk chunk;
    chunk.spread.resize(count);
    ChunkLattice lattice;
    set_fineness(model, index, lattice);

    // Words of shapes and masses; places on the lattices that follow from them.
    std::array<std::vector<std::int64_t>, 7> column;
    for (auto& words : column) words.resize(count);
    std::vector<int> exponent(count);
    std::vector<Place> place(count);
    double mass = 0, rounded_mass = 0;
    const double finer = std::ldexp(1.0, -lattice.finer_shape);
    for (std::size_t n = 0; n < count; ++n) {
        const std::uint32_t i = index[n];
        const LogShape shape = log_shape(model, i);
        for (std::size_t k = 0; k < entries; ++k)
            column[k][n] = std::llround(shape[k] / (finer * (k < kDiagonal ? rounding.diagonal_step
                                                                           : rounding.shear_step)));
        const std::int64_t trace = column[0][n] + column[1][n] + column[2][n];
        chunk.spread[n] = std::exp(finer * rounding.diagonal_step * static_cast<double>(trace) / 3);
        const Vec3d s = vec_cast<double>(model.scale[i]);
        const double log_mass =
            std::log(double{model.density[i]}) + std::log(s.x) + std::log(s.y) + std::log(s.z);
        column[6][n] = std::llround(log_mass / rounding.mass_step);
        mass += std::exp(log_mass);
        rounded_mass += std::exp(static_cast<double>(column[6][n]) * rounding.mass_step);
        exponent[n] = lattice.exponent(rounding, trace);
        const Vec3d from = vec_cast<double>(model.mean[i]) - rounding.corner;
        const double cell = std::ldexp(rounding.edge, exponent[n]);
        for (int axis = 0; axis < 3; ++axis) {
            const double steps = std::floor(from[axis] / cell);
            if (!(steps < 0x1p62)) refuse_scales();
            place[n][static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(steps);
        }
    }
    // The choice by a part of the chunk, near each other as all are; it must hold them all.
    constexpr std::size_t kSample = 1024;
    const std::size_t sample = std::min(count, kSample), from = (count - sample) / 2;
    Cells cells = best_cells(std::span(place).subspan(from, sample),
                             std::span(exponent).subspan(from, sample), lattice);
    if (cells.fit) cells = cells_at(place, exponent, lattice.cell_exponent);
    if (!cells.fit) cells = best_cells(place, exponent, lattice);
    if (!cells.fit) refuse_scales();
    lattice.base = cells.base;
    lattice.mass_factor = mass / rounded_mass;

    put(chunk.bytes, lattice.cell_exponent);
    put(chunk.bytes, lattice.finer_mean);
    put(chunk.bytes, lattice.finer_shape);
    for (const std::int64_t base : lattice.base) put(chunk.bytes, base);
    put(chunk.bytes, lattice.mass_factor);
    put_words(chunk.bytes, curve_steps(cells.cell, lattice.base), compression);
    for (std::size_t k = 0; k < entries; ++k) put_numbers(chunk.bytes, column[k], compression);
    put_numbers(chunk.bytes, column[6], compression);
    BitWriter bits;
    for (std::size_t n = 0; n < count; ++n) {
        const int inside = lattice.place_bits(exponent[n]);
        const std::uint64_t mask = (std::uint64_t{1} << inside) - 1;
        for (const std::int64_t p : place[n])
            bits.put(static_cast<std::uint64_t>(p) & mask, inside);
    }
    const std::string places = bits.take();
    put(chunk.bytes, static_cast<std::uint32_t>(places.size()));
    chunk.bytes += places;
    return chunk;
}

void read_shapes(MemoryBytes& in, const ShapeRounding& rounding, Compression compression,
                 Gaussians& model, std::size_t begin, std::span<double> spread) {
    const std::size_t count = spread.size();
    const std::size_t entries = model.axis_aligned() ? kDiagonal : std::tuple_size_v<LogShape>;
    ChunkLattice lattice;
    lattice.cell_exponent = in.number<std::int16_t>();
    lattice.finer_mean = in.number<std::uint8_t>();
    lattice.finer_shape = in.number<std::uint8_t>();
    for (std::int64_t& base : lattice.base) base = in.number<std::int64_t>();
    lattice.mass_factor = in.number<double>();
    std::vector<std::uint64_t> steps(count);
    take_words(in, steps, compression);
    std::array<std::vector<std::int64_t>, 7> column;
    for (std::size_t k = 0; k < column.size(); ++k) {
        column[k].resize(count);
        if (k < entries || k == 6) take_numbers(in, column[k], compression);
    }
    const auto place_bytes = in.number<std::uint32_t>();
    BitReader bits({in.take(place_bytes), place_bytes});

    const double finer = std::ldexp(1.0, -lattice.finer_shape);
    std::vector<LogShape> shapes(count);
    for (std::size_t k = 0; k < entries; ++k) {
        const double step = finer * (k < kDiagonal ? rounding.diagonal_step : rounding.shear_step);
        for (std::size_t n = 0; n < count; ++n)
            shapes[n][k] = step * static_cast<double>(column[k][n]);
    }
    set_shapes(model, begin, shapes);
    std::uint64_t code = 0;
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t i = begin + n;
        // Unsigned: words of a corrupt file may wrap around.
        const auto trace = static_cast<std::int64_t>(static_cast<std::uint64_t>(column[0][n]) +
                                                     static_cast<std::uint64_t>(column[1][n]) +
                                                     static_cast<std::uint64_t>(column[2][n]));
        spread[n] = std::exp(finer * rounding.diagonal_step * static_cast<double>(trace) / 3);

        const Vec3d s = vec_cast<double>(model.scale[i]);
        const double mass =
            lattice.mass_factor * std::exp(static_cast<double>(column[6][n]) * rounding.mass_step);
        model.density[i] = static_cast<float>(
            std::min(mass / s.x / s.y / s.z, double{std::numeric_limits<float>::max()}));

        code += static_cast<std::uint64_t>(from_zigzag(steps[n]));
        const int exponent = lattice.exponent(rounding, trace);
        const int inside = lattice.place_bits(exponent);
        const std::array<std::uint64_t, 3> cell{gather_bits(code >> 2), gather_bits(code >> 1),
                                                gather_bits(code)};
        const double edge = std::ldexp(rounding.edge, exponent);
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            const auto place = static_cast<std::int64_t>(
                (cell[a] + static_cast<std::uint64_t>(lattice.base[a])) << inside |
                bits.take(inside));
            model.mean[i][axis] = static_cast<float>(rounding.corner[axis] +
                                                     edge * (static_cast<double>(place) + 0.5));
        }
    }
    if (!bits.at_end())
        in.fail(fmt::format("corrupt: {} bytes of places, expected those of {} Gaussians",
                            place_bytes, count));
}

}  // namespace vog::vogz
