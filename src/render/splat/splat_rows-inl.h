// splat_rows-inl.h: Splats to pixels, one SIMD vector of pixels at a time, in single precision.
// Included once per SIMD target by splat_kernels.cpp and fields/field_kernels.cpp, inside their namespaces.

/// Reciprocals by estimates and a Newton step, faster than the divider on x86 (docs/performance.md).
constexpr bool kEstimates = HWY_ARCH_X86;

/// Tags of the loops: as wide as the target, or one lane.
struct WideLanes {
    using Doubles = hn::ScalableTag<double>;
    using Floats = hn::CappedTag<float, TilePixels::kMaxLanes>;
};
struct OneLane {
    using Doubles = hn::CappedTag<double, 1>;
    using Floats = hn::CappedTag<float, 1>;
};

/// 1 / v to a relative 2e-7 or better. With estimates of 11 bits, an estimate and a Newton step are
/// faster than a division, since the divider is busy with the square root (docs/performance.md).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V reciprocal(D d, V v) {
    if constexpr (kEstimates && hn::MaxLanes(D()) > 1) {
        const V r = hn::ApproximateReciprocal(v);
        return hn::MulAdd(r, hn::NegMulAdd(v, r, hn::Set(d, 1.0f)), r);
    } else {
        return hn::Div(hn::Set(d, 1.0f), v);
    }
}

/// Coefficients of one splat's forms, each repeated in every lane.
template <class V>
struct SplatLanes {
    V ax, ay, a0, by, b0, f0, cx, cy, c0, dy, d0, e02;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE SplatLanes<V> splat_lanes(D d, const FarSplat& s) {
    return {hn::Set(d, s.ax), hn::Set(d, s.ay), hn::Set(d, s.a0), hn::Set(d, s.by),
            hn::Set(d, s.b0), hn::Set(d, s.f0), hn::Set(d, s.cx), hn::Set(d, s.cy),
            hn::Set(d, s.c0), hn::Set(d, s.dy), hn::Set(d, s.d0), hn::Set(d, s.e02)};
}

/// The forms along a row: F = f - (ax x + a)², C = (cx x + c)² + n.
template <class V>
struct RowLanes {
    V a, f, c, n;
};
template <class V>
HWY_INLINE RowLanes<V> row_lanes(const SplatLanes<V>& s, V y) {
    const V b = hn::MulAdd(s.by, y, s.b0), across = hn::MulAdd(s.dy, y, s.d0);
    return {hn::MulAdd(s.ay, y, s.a0), hn::NegMulAdd(b, b, s.f0), hn::MulAdd(s.cy, y, s.c0),
            hn::MulAdd(across, across, s.e02)};
}

/// The kernel's polynomial, repeated in every lane. kDegree < 0: any degree, read term by term.
template <int kDegree, class V>
struct KernelLanes {
    V c[kDegree < 0 ? 1 : kDegree + 1];
    const KernelPolynomial* kernel;
};
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE KernelLanes<kDegree, V> kernel_lanes(D d, const KernelPolynomial& kernel) {
    KernelLanes<kDegree, V> lanes;
    lanes.kernel = &kernel;
    if constexpr (kDegree < 0) lanes.c[0] = hn::Zero(d);
    for (int power = 0; power <= kDegree; ++power)
        lanes.c[power] = hn::Set(d, kernel.coefficient[static_cast<std::size_t>(power)]);
    return lanes;
}

/// KernelPolynomial(ratio).
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V kernel_at(D d, const KernelLanes<kDegree, V>& lanes, V ratio) {
    if constexpr (kDegree < 0) {
        const std::vector<float>& coefficient = lanes.kernel->coefficient;
        const V v =
            hn::MulAdd(ratio, hn::Set(d, lanes.kernel->slope), hn::Set(d, lanes.kernel->shift));
        V sum = hn::Set(d, coefficient.back());
        for (std::size_t power = coefficient.size() - 1; power-- > 0;)
            sum = hn::MulAdd(sum, v, hn::Set(d, coefficient[power]));
        return hn::Max(sum, hn::Zero(d));  // the fit's error must not make T negative
    } else {
        // Estrin's scheme: one multiplication more than Horner's but half the latency, which limits
        // this loop.
        const V r2 = hn::Mul(ratio, ratio);
        V sum = kDegree % 2 == 0 ? lanes.c[kDegree]
                                 : hn::MulAdd(lanes.c[kDegree], ratio, lanes.c[kDegree - 1]);
        for (int power = kDegree - (kDegree % 2 == 0 ? 2 : 3); power >= 0; power -= 2)
            sum = hn::MulAdd(sum, r2, hn::MulAdd(lanes.c[power + 1], ratio, lanes.c[power]));
        return sum;
    }
}

/// depth plus sqrt(F) / C · KernelPolynomial(F / C), F = max(0, f - a²), C = c² + n: nothing
/// outside the support.
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V add_tau(D d, const KernelLanes<kDegree, V>& kernel, V a, V f, V c, V n, V depth) {
    const V big_f = hn::Max(hn::NegMulAdd(a, a, f), hn::Zero(d));
    const V inverse_c = reciprocal(d, hn::MulAdd(c, c, n));
    const V sum = kernel_at<kDegree>(d, kernel, hn::Mul(big_f, inverse_c));
    return hn::MulAdd(hn::Mul(hn::Sqrt(big_f), inverse_c), sum, depth);
}

/// kRows rows of pixels in one vector.
template <std::size_t kRows, class D>
struct Rows {
    static HWY_INLINE hn::Vec<D> load(D d, const float* at) { return hn::LoadU(d, at); }
    static HWY_INLINE void store(D d, hn::Vec<D> v, float* at) { hn::StoreU(v, d, at); }
};
#if HWY_TARGET != HWY_SCALAR  // one lane has no halves
template <std::size_t kRows, class D>
requires(kRows > 1) struct Rows<kRows, D> {
    using Half = hn::Half<D>;
    using HalfRows = Rows<kRows / 2, Half>;
    static constexpr std::size_t kBelow = kRows / 2 * TilePixels::kStride;
    static HWY_INLINE hn::Vec<D> load(D d, const float* at) {
        return hn::Combine(d, HalfRows::load(Half(), at + kBelow), HalfRows::load(Half(), at));
    }
    static HWY_INLINE void store(D, hn::Vec<D> v, float* at) {
        HalfRows::store(Half(), hn::LowerHalf(Half(), v), at);
        HalfRows::store(Half(), hn::UpperHalf(Half(), v), at + kBelow);
    }
};
#endif

/// Adds a splat so narrow that kRows of its rows fit one vector.
template <int kDegree, int kRows, class D>
HWY_INLINE void add_narrow(D d, const FarSplat& s, const TileRange& range,
                           const KernelLanes<kDegree, hn::Vec<D>>& kernel, TilePixels& tile) {
    using V = hn::Vec<D>;
    constexpr int kColumns = static_cast<int>(hn::MaxLanes(D())) / kRows;
    const SplatLanes<V> lanes = splat_lanes(d, s);
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
    const V x = hn::Add(hn::Load(d, kX.data()),
                        hn::Set(d, static_cast<float>(tile.column + range.x0 - s.column)));
    const V y = hn::Add(hn::Load(d, kY.data()),
                        hn::Set(d, static_cast<float>(tile.row + range.y0 - s.row)));
    // From block to block the four linear forms grow by a constant: additions leave the
    // multipliers, which bound this loop, to the rest. Their rounding adds up over at most 32 rows.
    V a = hn::MulAdd(lanes.ax, x, hn::MulAdd(lanes.ay, y, lanes.a0));
    V c = hn::MulAdd(lanes.cx, x, hn::MulAdd(lanes.cy, y, lanes.c0));
    V b = hn::MulAdd(lanes.by, y, lanes.b0), across = hn::MulAdd(lanes.dy, y, lanes.d0);
    const V rows = hn::Set(d, static_cast<float>(kRows));
    const V a_step = hn::Mul(lanes.ay, rows), c_step = hn::Mul(lanes.cy, rows);
    const V b_step = hn::Mul(lanes.by, rows), across_step = hn::Mul(lanes.dy, rows);
    using Block = Rows<kRows, D>;
    for (int row = range.y0; row <= range.y1; row += kRows) {
        float* at = tile.depth[row] + range.x0;
        const V f = hn::NegMulAdd(b, b, lanes.f0), n = hn::MulAdd(across, across, lanes.e02);
        Block::store(d, add_tau<kDegree>(d, kernel, a, f, c, n, Block::load(d, at)), at);
        a = hn::Add(a, a_step), c = hn::Add(c, c_step);
        b = hn::Add(b, b_step), across = hn::Add(across, across_step);
    }
}

/// Rows of a wide splat within a tile, computed one vector of rows at a time.
struct RowForms {
    static constexpr int kRoom = kTileHeight + TilePixels::kMaxLanes;
    alignas(64) float a[kRoom], f[kRoom], c[kRoom], n[kRoom];
    alignas(64) std::int32_t first[kRoom], last[kRoom];  ///< pixels of the tile that F > 0 covers
};

template <class D>
HWY_INLINE void row_forms(D d, const FarSplat& s, const TileRange& range, int column, int row,
                          RowForms& out) {
    using V = hn::Vec<D>;
    const hn::RebindToSigned<D> di;
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const V inverse_a = hn::Div(hn::Set(d, 1.0f), lanes.ax);
    // Rounding moves the ends of rows by about 1e-7 of their distance from the centre.
    const V slack = hn::Set(d, 0.02f), relative = hn::Set(d, 1e-6f);
    const V x0 = hn::Set(d, static_cast<float>(range.x0)),
            x1 = hn::Set(d, static_cast<float>(range.x1));
    const V origin = hn::Set(d, static_cast<float>(s.column - column));
    V y = hn::Iota(d, static_cast<float>(row + range.y0 - s.row));
    const auto step = static_cast<int>(hn::Lanes(d));
    for (int n = 0; n <= range.y1 - range.y0; n += step) {
        const RowLanes<V> r = row_lanes(lanes, y);
        hn::Store(r.a, d, out.a + n);
        hn::Store(r.f, d, out.f + n);
        hn::Store(r.c, d, out.c + n);
        hn::Store(r.n, d, out.n + n);
        const V half = hn::Mul(hn::Sqrt(hn::Max(r.f, hn::Zero(d))), inverse_a);
        const V middle = hn::Mul(r.a, inverse_a);
        const V extent = hn::Add(half, hn::MulAdd(relative, hn::Add(half, hn::Abs(middle)), slack));
        const V center = hn::Sub(origin, middle);
        hn::Store(hn::ConvertTo(di, hn::Max(x0, hn::Ceil(hn::Sub(center, extent)))), di,
                  out.first + n);
        hn::Store(hn::ConvertTo(di, hn::Min(x1, hn::Floor(hn::Add(center, extent)))), di,
                  out.last + n);
        y = hn::Add(y, hn::Set(d, static_cast<float>(step)));
    }
}

/// Adds a wider splat row by row, at the pixels where F > 0. Vectors may extend past the last pixel,
/// where F is negative.
template <int kDegree, class D>
HWY_INLINE void add_wide(D d, const FarSplat& s, const TileRange& range,
                         const KernelLanes<kDegree, hn::Vec<D>>& kernel, TilePixels& tile) {
    using V = hn::Vec<D>;
    RowForms rows;
    row_forms(d, s, range, tile.column, tile.row, rows);
    const V ax = hn::Set(d, s.ax), cx = hn::Set(d, s.cx);
    const auto step = static_cast<int>(hn::Lanes(d));
    const V a_step = hn::Set(d, s.ax * static_cast<float>(step));
    const V c_step = hn::Set(d, s.cx * static_cast<float>(step));
    const V origin = hn::Iota(d, static_cast<float>(tile.column - s.column));
    for (int n = 0; n <= range.y1 - range.y0; ++n) {
        const int first = rows.first[n], last = rows.last[n];
        const V x = hn::Add(origin, hn::Set(d, static_cast<float>(first)));
        V a = hn::MulAdd(ax, x, hn::Set(d, rows.a[n])),
          c = hn::MulAdd(cx, x, hn::Set(d, rows.c[n]));
        const V f = hn::Set(d, rows.f[n]), m = hn::Set(d, rows.n[n]);
        float* depth = tile.depth[range.y0 + n];
        for (int column = first; column <= last; column += step) {
            hn::StoreU(add_tau<kDegree>(d, kernel, a, f, c, m, hn::LoadU(d, depth + column)), d,
                       depth + column);
            a = hn::Add(a, a_step), c = hn::Add(c, c_step);
        }
    }
}

template <int kDegree, class Tags>
void add_far_degree(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
                    const KernelPolynomial& polynomial, TilePixels& tile) {
    const typename Tags::Floats d;
    const auto kernel = kernel_lanes<kDegree>(d, polynomial);
    constexpr auto kLanes = static_cast<int>(hn::MaxLanes(typename Tags::Floats()));
    constexpr std::size_t kAhead = 8;  // prefetch: splats of a tile are scattered in memory
    for (std::size_t n = 0; n < count; ++n) {
        if (n + kAhead < count) hwy::Prefetch(splats + index[n + kAhead]);
        const FarSplat& s = splats[index[n]];
        const TileRange range = range_in(tile, s.bounds);
        const int width = range.x1 - range.x0 + 1;
        if (kLanes >= 16 && width <= kLanes / 4)
            add_narrow<kDegree, kLanes >= 16 ? 4 : 1>(d, s, range, kernel, tile);
        else if (kLanes >= 8 && width <= kLanes / 2)
            add_narrow<kDegree, kLanes >= 8 ? 2 : 1>(d, s, range, kernel, tile);
        else if (kLanes > 1 && width <= kLanes)
            add_narrow<kDegree, 1>(d, s, range, kernel, tile);
        else
            add_wide<kDegree>(d, s, range, kernel, tile);
    }
}

template <class Tags>
void add_far(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
             const KernelPolynomial& kernel, TilePixels& tile) {
    // The degrees of the default cutoff and the paper's are unrolled.
    switch (kernel.shift == 0 ? kernel.coefficient.size() - 1 : 0) {
        case 6:
            return add_far_degree<6, Tags>(splats, index, count, kernel, tile);
        case 8:
            return add_far_degree<8, Tags>(splats, index, count, kernel, tile);
        default:
            return add_far_degree<-1, Tags>(splats, index, count, kernel, tile);
    }
}

template <class Tags>
void finish_tile(TilePixels& tile, const CameraFrame& frame, double unit, bool add, float* image) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const auto step = static_cast<int>(hn::Lanes(d));
    const int width = std::min(kTileWidth, frame.width - tile.column);
    const int height = std::min(kTileHeight, frame.height - tile.row);
    // |D|² = 1 + slope_x² + slope_y²; parallel rays have no slope.
    const double pixel = frame.orthographic ? 0 : 1 / frame.pixels_per_unit;
    // The unit, a power of two, in two factors: it may leave the range of floats, and T with it.
    const int exponent = std::ilogb(unit), half = exponent / 2;
    const V first = hn::Set(d, std::ldexp(1.0f, half));
    const V second = hn::Set(d, std::ldexp(1.0f, exponent - half));
    for (int y = 0; y < height; ++y) {
        const double slope_y = (tile.row + y - 0.5 * (frame.height - 1)) * pixel;
        const V rest = hn::Set(d, static_cast<float>(1 + slope_y * slope_y));
        float* depth = tile.depth[y];
        float* row =
            image + static_cast<std::size_t>(tile.row + y) * static_cast<std::size_t>(frame.width) +
            tile.column;
        for (int x = 0; x < width; x += step) {
            const double left = (tile.column + x - 0.5 * (frame.width - 1)) * pixel;
            const V slope_x = hn::MulAdd(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(pixel)),
                                         hn::Set(d, static_cast<float>(left)));
            const V length = hn::Sqrt(hn::MulAdd(slope_x, slope_x, rest));
            const V t = hn::Mul(hn::Mul(hn::Mul(hn::Load(d, depth + x), length), first), second);
            hn::Store(hn::Zero(d), d, depth + x);
            if (x + step <= width) {
                hn::StoreU(add ? hn::Add(t, hn::LoadU(d, row + x)) : t, d, row + x);
                continue;
            }
            alignas(64) float last[TilePixels::kMaxLanes] = {};
            hn::Store(t, d, last);
            for (int n = 0; n < width - x; ++n) row[x + n] = add ? row[x + n] + last[n] : last[n];
        }
        // Beside the image's edge vectors leave sums that are pixels of the next tile.
        std::fill(depth + width, depth + kTileWidth, 0.0f);
    }
    for (int y = height; y < kTileHeight; ++y)
        std::fill(tile.depth[y], tile.depth[y] + kTileWidth, 0.0f);
}
