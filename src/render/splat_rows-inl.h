// splat_rows-inl.h: splats to pixels, a vector of pixels at a time, in single precision: included
// once per SIMD target by splat_kernels.cpp, inside its namespace.

/// Reciprocal and square root to 3e-7 relative or better. Estimate and one Newton step where that
/// is faster: the divider has a tenth of the throughput of multiplication.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V reciprocal(D d, V v) {
    if constexpr (kEstimates && hn::MaxLanes(D()) > 1) {
        const V r = hn::ApproximateReciprocal(v);
        return hn::MulAdd(r, hn::NegMulAdd(v, r, hn::Set(d, 1.0f)), r);
    } else {
        return hn::Div(hn::Set(d, 1.0f), v);
    }
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE V square_root(D d, V v) {
    if constexpr (kEstimates && hn::MaxLanes(D()) > 1) {
        // 0 stays exactly 0: its estimate is finite.
        const V r = hn::ApproximateReciprocalSqrt(hn::Max(v, hn::Set(d, 1e-30f)));
        const V s = hn::Mul(v, r), half = hn::Mul(hn::Set(d, 0.5f), s);
        return hn::MulAdd(half, hn::NegMulAdd(s, r, hn::Set(d, 1.0f)), s);
    } else {
        return hn::Sqrt(v);
    }
}

/// The forms of one splat, one value in every lane.
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

/// What the forms are along a row: F = f - (ax x + a)², C = (cx x + c)² + n.
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

/// depth plus sqrt(F) / C · KernelPolynomial(F / C), F = max(0, f - a²), C = c² + n: nothing
/// outside the support. kDegree < 0: any degree.
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V add_tau(D d, const KernelPolynomial& kernel, V a, V f, V c, V n, V depth) {
    const V big_f = hn::Max(hn::NegMulAdd(a, a, f), hn::Zero(d));
    const V inverse_c = reciprocal(d, hn::MulAdd(c, c, n));
    const V ratio = hn::Mul(big_f, inverse_c);
    const int degree = kDegree < 0 ? static_cast<int>(kernel.coefficient.size()) - 1 : kDegree;
    const float* coefficient = kernel.coefficient.data();
    V v = ratio;
    if constexpr (kDegree < 0)
        v = hn::MulAdd(ratio, hn::Set(d, kernel.slope), hn::Set(d, kernel.shift));
    V sum = hn::Set(d, coefficient[degree]);
    for (int power = degree - 1; power >= 0; --power)
        sum = hn::MulAdd(sum, v, hn::Set(d, coefficient[power]));
    // The fit's error must not make T negative; in powers of F / C it does not.
    if constexpr (kDegree < 0) sum = hn::Max(sum, hn::Zero(d));
    return hn::MulAdd(hn::Mul(square_root(d, big_f), inverse_c), sum, depth);
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

/// A splat so narrow that kRows of its rows fit one vector.
template <int kDegree, int kRows, class D>
HWY_INLINE void add_narrow(D d, const FarSplat& s, const TileRange& range,
                           const KernelPolynomial& kernel, TilePixels& tile) {
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
    V y = hn::Add(hn::Load(d, kY.data()),
                  hn::Set(d, static_cast<float>(tile.row + range.y0 - s.row)));
    const V ax = hn::Mul(lanes.ax, x), cx = hn::Mul(lanes.cx, x);
    using Block = Rows<kRows, D>;
    for (int row = range.y0; row <= range.y1; row += kRows) {
        const RowLanes<V> r = row_lanes(lanes, y);
        float* at = tile.depth[row] + range.x0;
        Block::store(d,
                     add_tau<kDegree>(d, kernel, hn::Add(ax, r.a), r.f, hn::Add(cx, r.c), r.n,
                                      Block::load(d, at)),
                     at);
        y = hn::Add(y, hn::Set(d, static_cast<float>(kRows)));
    }
}

/// What a tile needs of the rows of a wide splat, computed a vector of rows at a time.
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
    // Rounding moves the ends of rows by some 1e-7 of their distance from the centre.
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
        const V reach = hn::Add(half, hn::MulAdd(relative, hn::Add(half, hn::Abs(middle)), slack));
        const V center = hn::Sub(origin, middle);
        hn::Store(hn::ConvertTo(di, hn::Max(x0, hn::Ceil(hn::Sub(center, reach)))), di,
                  out.first + n);
        hn::Store(hn::ConvertTo(di, hn::Min(x1, hn::Floor(hn::Add(center, reach)))), di,
                  out.last + n);
        y = hn::Add(y, hn::Set(d, static_cast<float>(step)));
    }
}

/// A splat wider than that: row by row, the pixels that F > 0 covers. Vectors may run past the last
/// pixel: F is negative there.
template <int kDegree, class D>
HWY_INLINE void add_wide(D d, const FarSplat& s, const TileRange& range,
                         const KernelPolynomial& kernel, TilePixels& tile) {
    using V = hn::Vec<D>;
    RowForms rows;
    row_forms(d, s, range, tile.column, tile.row, rows);
    const V ax = hn::Set(d, s.ax), cx = hn::Set(d, s.cx);
    const auto step = static_cast<int>(hn::Lanes(d));
    const V origin = hn::Iota(d, static_cast<float>(tile.column - s.column));
    for (int n = 0; n <= range.y1 - range.y0; ++n) {
        const V a = hn::Set(d, rows.a[n]), f = hn::Set(d, rows.f[n]);
        const V c = hn::Set(d, rows.c[n]), m = hn::Set(d, rows.n[n]);
        float* depth = tile.depth[range.y0 + n];
        for (int column = rows.first[n]; column <= rows.last[n]; column += step) {
            const V x = hn::Add(origin, hn::Set(d, static_cast<float>(column)));
            hn::StoreU(add_tau<kDegree>(d, kernel, hn::MulAdd(ax, x, a), f, hn::MulAdd(cx, x, c), m,
                                        hn::LoadU(d, depth + column)),
                       d, depth + column);
        }
    }
}

template <int kDegree, class Tags>
void add_far_degree(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
                    const KernelPolynomial& kernel, TilePixels& tile) {
    const typename Tags::Floats d;
    constexpr auto kLanes = static_cast<int>(hn::MaxLanes(typename Tags::Floats()));
    constexpr std::size_t kAhead = 8;  // splats of a tile lie apart in memory
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
void finish_tile(const TilePixels& tile, const CameraFrame& frame, double unit, bool add,
                 float* image) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const auto step = static_cast<int>(hn::Lanes(d));
    const int width = std::min(kTileWidth, frame.width - tile.column);
    const int height = std::min(kTileHeight, frame.height - tile.row);
    // |D|² = 1 + slope_x² + slope_y².
    const double pixel = 1 / frame.pixels_per_unit;
    const V scale = hn::Set(d, static_cast<float>(unit));
    for (int y = 0; y < height; ++y) {
        const double slope_y = (tile.row + y - 0.5 * (frame.height - 1)) * pixel;
        const V rest = hn::Set(d, static_cast<float>(1 + slope_y * slope_y));
        const float* depth = tile.depth[y];
        float* row =
            image + static_cast<std::size_t>(tile.row + y) * static_cast<std::size_t>(frame.width) +
            tile.column;
        for (int x = 0; x < width; x += step) {
            const double left = (tile.column + x - 0.5 * (frame.width - 1)) * pixel;
            const V slope_x = hn::MulAdd(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(pixel)),
                                         hn::Set(d, static_cast<float>(left)));
            const V length = hn::Sqrt(hn::MulAdd(slope_x, slope_x, rest));
            const V t = hn::Mul(hn::Mul(hn::Load(d, depth + x), length), scale);
            if (x + step <= width) {
                hn::StoreU(add ? hn::Add(t, hn::LoadU(d, row + x)) : t, d, row + x);
                continue;
            }
            alignas(64) float last[TilePixels::kMaxLanes] = {};
            hn::Store(t, d, last);
            for (int n = 0; n < width - x; ++n) row[x + n] = add ? row[x + n] + last[n] : last[n];
        }
    }
}
