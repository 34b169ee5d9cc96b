// field_rows-inl.h: Splats of a field to pixels, one SIMD vector of pixels at a time, in single precision.
// Included once per SIMD target by field_kernels.cpp, after splat_rows-inl.h.

/// The field at pixels: value v, P, A and r² of field_kernels.h.
template <class V>
struct FieldLanes {
    V value, across, along, variance;
};

/// PlaneSplat, repeated in every lane.
template <class V>
struct PlaneLanes {
    V value, x, y, along, variance;
    HWY_INLINE FieldLanes<V> operator()(V dx, V dy) const {
        return {value, hn::MulAdd(x, dx, hn::Mul(y, dy)), along, variance};
    }
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE PlaneLanes<V> plane_lanes(D d, const PlaneSplat& s) {
    return {hn::Set(d, s.value), hn::Set(d, s.x), hn::Set(d, s.y), hn::Set(d, s.along),
            hn::Set(d, s.variance)};
}

/// ViewSplat, repeated in every lane.
template <class V>
struct ViewLanes {
    V v, vx, vy;
    V px, py, pxx, pxy, pyy;
    V a, ax, ay;
    V r, rx, ry, rxx, rxy, ryy;
    HWY_INLINE FieldLanes<V> operator()(V x, V y) const {
        const V p_x = hn::MulAdd(pxx, x, hn::MulAdd(pxy, y, px)), p_y = hn::MulAdd(pyy, y, py);
        const V r_x = hn::MulAdd(rxx, x, hn::MulAdd(rxy, y, rx)), r_y = hn::MulAdd(ryy, y, ry);
        return {hn::MulAdd(vx, x, hn::MulAdd(vy, y, v)), hn::MulAdd(p_x, x, hn::Mul(p_y, y)),
                hn::MulAdd(ax, x, hn::MulAdd(ay, y, a)), hn::MulAdd(r_x, x, hn::MulAdd(r_y, y, r))};
    }
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE ViewLanes<V> plane_lanes(D d, const ViewSplat& s) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    return {set(s.value[0]),    set(s.value[1]),    set(s.value[2]),    set(s.across[0]),
            set(s.across[1]),   set(s.across[2]),   set(s.across[3]),   set(s.across[4]),
            set(s.along[0]),    set(s.along[1]),    set(s.along[2]),    set(s.variance[0]),
            set(s.variance[1]), set(s.variance[2]), set(s.variance[3]), set(s.variance[4]),
            set(s.variance[5])};
}

/// ChordVariance, repeated in every lane. kDegree < 0: any degree, read term by term.
template <int kDegree, class V>
struct VarianceLanes {
    V slope, c[kDegree < 0 ? 1 : kDegree + 1];
    const ChordVariance* fitted;
};
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE VarianceLanes<kDegree, V> variance_lanes(D d, const ChordVariance& fitted) {
    VarianceLanes<kDegree, V> lanes;
    lanes.slope = hn::Set(d, fitted.slope);
    lanes.fitted = &fitted;
    if constexpr (kDegree < 0) lanes.c[0] = hn::Zero(d);
    for (int power = 0; power <= kDegree; ++power)
        lanes.c[power] = hn::Set(d, fitted.coefficient[static_cast<std::size_t>(power)]);
    return lanes;
}

/// ChordVariance(ratio).
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V variance_at(D d, const VarianceLanes<kDegree, V>& lanes, V ratio) {
    const V v = hn::MulSub(ratio, lanes.slope, hn::Set(d, 1.0f));
    if constexpr (kDegree < 0) {
        const std::vector<float>& coefficient = lanes.fitted->coefficient;
        V sum = hn::Set(d, coefficient.back());
        for (std::size_t power = coefficient.size() - 1; power-- > 0;)
            sum = hn::MulAdd(sum, v, hn::Set(d, coefficient[power]));
        return sum;
    } else {
        V sum = lanes.c[kDegree];
        for (int power = kDegree - 1; power >= 0; --power) sum = hn::MulAdd(sum, v, lanes.c[power]);
        return sum;
    }
}

/// Polynomials in every lane.
template <int kKernel, int kVariance, class V>
struct PolynomialLanes {
    KernelLanes<kKernel, V> kernel;
    VarianceLanes<kVariance, V> variance;
};

/// Three sums of one vector of pixels.
template <class V>
struct SumLanes {
    V tau, first, second;
};
/// The forms of FarSplat at pixels, and their offsets from the projected mean.
template <class V>
struct FormLanes {
    V a, f, c, across;  ///< F = f - a², C = c² + across² + e02
    V dx, dy;
};
/// Factors that are the same at all pixels of a splat: of parallel rays 1 / C and (g·D)² / |W D|².
template <class V>
struct FixedLanes {
    V per_c, inverse_c, spread;
};
template <bool kParallel, class D, class Splat, class V = hn::Vec<D>>
HWY_INLINE FixedLanes<V> fixed_lanes(D d, const FarSplat& s, const Splat& field) {
    if constexpr (kParallel)
        return {hn::Zero(d), hn::Set(d, 1 / s.e02),
                hn::Set(d, field.along * (field.along * (field.per_c / s.e02)))};
    else
        return {hn::Set(d, field.per_c), hn::Zero(d), hn::Zero(d)};
}
template <bool kParallel, class Polynomials, class D, class Plane, class V = hn::Vec<D>>
HWY_INLINE SumLanes<V> field_tau(D d, const Polynomials& polynomials, const SplatLanes<V>& s,
                                 const Plane& plane, const FixedLanes<V>& fixed,
                                 const FormLanes<V>& at) {
    const V big_f = hn::Max(hn::NegMulAdd(at.a, at.a, at.f), hn::Zero(d));
    V inverse_c = fixed.inverse_c, spread = fixed.spread;
    if constexpr (!kParallel)
        inverse_c = reciprocal(d, hn::MulAdd(at.c, at.c, hn::MulAdd(at.across, at.across, s.e02)));
    const V ratio = hn::Mul(big_f, inverse_c);
    const V tau =
        hn::Mul(hn::Mul(hn::Sqrt(big_f), inverse_c), kernel_at(d, polynomials.kernel, ratio));
    const FieldLanes<V> field = plane(at.dx, at.dy);
    V phi = hn::Add(field.value, field.across);
    if constexpr (!kParallel) {
        const V along = hn::Add(field.along, field.across);
        const V delta_x = hn::MulAdd(s.cx, at.dx, hn::Mul(s.cy, at.dy));
        const V delta_y = hn::Mul(s.dy, at.dy);
        const V dots = hn::MulAdd(delta_x, at.c, hn::Mul(delta_y, at.across));
        const V share = hn::Mul(along, inverse_c);
        phi = hn::NegMulAdd(dots, share, phi);
        spread = hn::Mul(share, hn::Mul(along, fixed.per_c));
    }
    const V square = hn::MulAdd(
        phi, phi, hn::MulAdd(spread, variance_at(d, polynomials.variance, ratio), field.variance));
    return {tau, hn::Mul(tau, phi), hn::Mul(tau, square)};
}

template <class Block, class D, class V = hn::Vec<D>>
HWY_INLINE void add_sums(D d, const SumLanes<V>& sums, FieldTile& tile, int row, int column) {
    const V parts[3] = {sums.tau, sums.first, sums.second};
    for (int n = 0; n < 3; ++n) {
        float* at = tile.sum[n].depth[row] + column;
        Block::store(d, hn::Add(Block::load(d, at), parts[n]), at);
    }
}

/// add_narrow of splat_rows-inl.h for a field.
template <bool kParallel, int kRows, class Polynomials, class Splat, class D>
HWY_INLINE void add_narrow_field(D d, const FarSplat& s, const Splat& field, const TileRange& range,
                                 const Polynomials& polynomials, FieldTile& tile) {
    using V = hn::Vec<D>;
    constexpr int kColumns = static_cast<int>(hn::MaxLanes(D())) / kRows;
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const auto plane = plane_lanes(d, field);
    const FixedLanes<V> fixed = fixed_lanes<kParallel>(d, s, field);
    alignas(64) static constexpr auto kX = [] {
        std::array<float, hn::MaxLanes(D())> x{};
        for (std::size_t n = 0; n < x.size(); ++n) x[n] = static_cast<float>(n % kColumns);
        return x;
    }();
    alignas(64) static constexpr auto kY = [] {
        std::array<float, hn::MaxLanes(D())> y{};
        for (std::size_t n = 0; n < y.size(); ++n) y[n] = static_cast<float>(n / kColumns);
        return y;
    }();
    const TilePixels& place = tile.sum[0];
    const V x = hn::Add(hn::Load(d, kX.data()),
                        hn::Set(d, static_cast<float>(place.column + range.x0 - s.column)));
    V y = hn::Add(hn::Load(d, kY.data()),
                  hn::Set(d, static_cast<float>(place.row + range.y0 - s.row)));
    const V a_row = hn::MulAdd(lanes.ax, x, lanes.a0), c_row = hn::MulAdd(lanes.cx, x, lanes.c0);
    const V mean_y = hn::Set(d, field.mean_y), rows = hn::Set(d, static_cast<float>(kRows));
    FormLanes<V> at;
    at.dx = hn::Sub(x, hn::Set(d, field.mean_x));
    for (int row = range.y0; row <= range.y1; row += kRows) {
        const V b = hn::MulAdd(lanes.by, y, lanes.b0);
        at.a = hn::MulAdd(lanes.ay, y, a_row);
        at.f = hn::NegMulAdd(b, b, lanes.f0);
        if constexpr (!kParallel) {
            at.c = hn::MulAdd(lanes.cy, y, c_row);
            at.across = hn::MulAdd(lanes.dy, y, lanes.d0);
        }
        at.dy = hn::Sub(y, mean_y);
        add_sums<Rows<kRows, D>>(d, field_tau<kParallel>(d, polynomials, lanes, plane, fixed, at),
                                 tile, row, range.x0);
        y = hn::Add(y, rows);
    }
}

/// add_wide of splat_rows-inl.h for a field.
template <bool kParallel, class Polynomials, class Splat, class D>
HWY_INLINE void add_wide_field(D d, const FarSplat& s, const Splat& field, const TileRange& range,
                               const Polynomials& polynomials, FieldTile& tile) {
    using V = hn::Vec<D>;
    const TilePixels& place = tile.sum[0];
    RowForms rows;
    row_forms(d, s, range, place.column, place.row, rows);
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const auto plane = plane_lanes(d, field);
    const FixedLanes<V> fixed = fixed_lanes<kParallel>(d, s, field);
    const auto step = static_cast<int>(hn::Lanes(d));
    const V columns = hn::Set(d, static_cast<float>(step)), mean_x = hn::Set(d, field.mean_x);
    const V origin = hn::Iota(d, static_cast<float>(place.column - s.column));
    for (int n = 0; n <= range.y1 - range.y0; ++n) {
        const int first = rows.first[n], last = rows.last[n];
        const float y = static_cast<float>(place.row + range.y0 + n - s.row);
        V x = hn::Add(origin, hn::Set(d, static_cast<float>(first)));
        FormLanes<V> at;
        at.f = hn::Set(d, rows.f[n]);
        at.across = hn::Set(d, s.dy * y + s.d0);
        at.dy = hn::Set(d, y - field.mean_y);
        const V a_row = hn::Set(d, rows.a[n]), c_row = hn::Set(d, rows.c[n]);
        for (int column = first; column <= last; column += step) {
            at.a = hn::MulAdd(lanes.ax, x, a_row);
            at.c = hn::MulAdd(lanes.cx, x, c_row);
            at.dx = hn::Sub(x, mean_x);
            add_sums<Rows<1, D>>(d, field_tau<kParallel>(d, polynomials, lanes, plane, fixed, at),
                                 tile, range.y0 + n, column);
            x = hn::Add(x, columns);
        }
    }
}

template <bool kParallel, int kKernel, int kVariance, class Tags, class Splat>
void add_fields_degree(const FarSplat* splats, const Splat* planes, const std::uint32_t* index,
                       std::size_t count, const FieldPolynomials& polynomials, FieldTile& tile) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const PolynomialLanes<kKernel, kVariance, V> lanes{
        kernel_lanes<kKernel>(d, polynomials.kernel),
        variance_lanes<kVariance>(d, polynomials.variance)};
    constexpr auto kLanes = static_cast<int>(hn::MaxLanes(typename Tags::Floats()));
    constexpr std::size_t kAhead = 8;
    for (std::size_t n = 0; n < count; ++n) {
        if (n + kAhead < count) {
            hwy::Prefetch(splats + index[n + kAhead]);
            hwy::Prefetch(planes + index[n + kAhead]);
        }
        const FarSplat& s = splats[index[n]];
        const Splat& field = planes[index[n]];
        const TileRange range = range_in(tile.sum[0], s.bounds);
        const int width = range.x1 - range.x0 + 1;
        if (kLanes >= 16 && width <= kLanes / 4)
            add_narrow_field<kParallel, kLanes >= 16 ? 4 : 1>(d, s, field, range, lanes, tile);
        else if (kLanes >= 8 && width <= kLanes / 2)
            add_narrow_field<kParallel, kLanes >= 8 ? 2 : 1>(d, s, field, range, lanes, tile);
        else if (kLanes > 1 && width <= kLanes)
            add_narrow_field<kParallel, 1>(d, s, field, range, lanes, tile);
        else
            add_wide_field<kParallel>(d, s, field, range, lanes, tile);
    }
}

template <bool kParallel, class Tags, class Splat>
void add_fields(const FarSplat* splats, const Splat* planes, const std::uint32_t* index,
                std::size_t count, const FieldPolynomials& polynomials, FieldTile& tile) {
    // The degrees of the default cutoff are unrolled.
    constexpr int kKernel = 6, kVariance = 5;
    const KernelPolynomial& kernel = polynomials.kernel;
    const bool usual = kernel.shift == 0 && kernel.coefficient.size() == kKernel + 1 &&
                       polynomials.variance.coefficient.size() == kVariance + 1;
    return usual ? add_fields_degree<kParallel, kKernel, kVariance, Tags>(splats, planes, index,
                                                                          count, polynomials, tile)
                 : add_fields_degree<kParallel, -1, -1, Tags>(splats, planes, index, count,
                                                              polynomials, tile);
}

/// Column, mean and deviation from sums; NaN without column.
template <class D, class V = hn::Vec<D>>
HWY_INLINE SumLanes<V> finished(D d, const MapRow& row, V first_factor, V second_factor,
                                const SumLanes<V>& sums, V first_pixel) {
    const V nothing = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
    const V column = hn::Mul(hn::Mul(sums.tau, first_factor), second_factor);
    const auto none = hn::Not(hn::Gt(column, hn::Zero(d)));
    if (hn::AllTrue(d, none)) return {column, nothing, nothing};
    const V per_column = hn::Div(hn::Set(d, 1.0f), sums.tau);
    V mean = hn::Mul(sums.first, per_column), unit = hn::Set(d, static_cast<float>(row.unit));
    const V square = hn::NegMulAdd(mean, mean, hn::Mul(sums.second, per_column));
    const auto high = static_cast<float>(row.reference);
    if (row.along_rays) {
        const V x = hn::Add(first_pixel, hn::Iota(d, 0.0f));
        const V slope = hn::MulAdd(x, hn::Set(d, static_cast<float>(row.slope_step)),
                                   hn::Set(d, static_cast<float>(row.slope)));
        const V length =
            hn::Sqrt(hn::MulAdd(slope, slope, hn::Set(d, static_cast<float>(row.rest2))));
        const V per_length = hn::Div(hn::Set(d, 1.0f), length);
        const V reference =
            hn::MulAdd(x, hn::Set(d, static_cast<float>(row.reference_step)), hn::Set(d, high));
        unit = hn::Mul(unit, per_length);
        mean = hn::MulAdd(mean, unit, hn::Mul(reference, per_length));
    } else {
        // The reference as two floats: a mean is then rounded once.
        const auto low = static_cast<float>(row.reference - double{high});
        mean = hn::Add(hn::Set(d, high), hn::MulAdd(mean, unit, hn::Set(d, low)));
    }
    const V deviation = hn::Mul(unit, hn::Sqrt(hn::Max(square, hn::Zero(d))));
    return {column, hn::IfThenElse(none, nothing, mean), hn::IfThenElse(none, nothing, deviation)};
}

template <class Tags>
void finish_row(const MapRow& row) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const std::size_t step = hn::Lanes(d);
    // The unit in two factors: it may leave the range of floats.
    const int exponent = std::ilogb(row.depth_unit), half = exponent / 2;
    const V first = hn::Set(d, std::ldexp(1.0f, half));
    const V second = hn::Set(d, std::ldexp(1.0f, exponent - half));
    alignas(64) float part[3][TilePixels::kMaxLanes];
    float* const maps[3] = {row.column, row.mean, row.deviation};
    for (std::size_t at = 0; at < row.count; at += step) {
        const V x = hn::Set(d, static_cast<float>(at));
        if (at + step <= row.count) {
            const SumLanes<V> out =
                finished(d, row, first, second,
                         SumLanes<V>{hn::LoadU(d, maps[0] + at), hn::LoadU(d, maps[1] + at),
                                     hn::LoadU(d, maps[2] + at)},
                         x);
            hn::StoreU(out.tau, d, maps[0] + at);
            hn::StoreU(out.first, d, maps[1] + at);
            hn::StoreU(out.second, d, maps[2] + at);
            continue;
        }
        const std::size_t left = row.count - at;
        for (std::size_t n = 0; n < 3; ++n) {
            std::fill(part[n], part[n] + TilePixels::kMaxLanes, 0.0f);
            std::copy_n(maps[n] + at, left, part[n]);
        }
        const SumLanes<V> out = finished(
            d, row, first, second,
            SumLanes<V>{hn::Load(d, part[0]), hn::Load(d, part[1]), hn::Load(d, part[2])}, x);
        hn::Store(out.tau, d, part[0]);
        hn::Store(out.first, d, part[1]);
        hn::Store(out.second, d, part[2]);
        for (std::size_t n = 0; n < 3; ++n) std::copy_n(part[n], left, maps[n] + at);
    }
}
