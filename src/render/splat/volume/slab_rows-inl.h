// slab_rows-inl.h: Light of splats to depth slabs, one SIMD vector of pixels at a time, in single precision.
// Included once per SIMD target by slab_kernels.cpp, after splat_rows-inl.h.

/// ChebyshevFit in every lane. kDegree < 0: any degree, read term by term.
template <int kDegree, class V>
struct SlabLanes {
    V slope, c[kDegree < 0 ? 1 : kDegree + 1];
    const ChebyshevFit* fitted;
};
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE SlabLanes<kDegree, V> slab_lanes(D d, const ChebyshevFit& fitted) {
    SlabLanes<kDegree, V> lanes;
    lanes.slope = hn::Set(d, fitted.slope);
    lanes.fitted = &fitted;
    if constexpr (kDegree < 0) lanes.c[0] = hn::Zero(d);
    for (int power = 0; power <= kDegree; ++power)
        lanes.c[power] = hn::Set(d, fitted.coefficient[static_cast<std::size_t>(power)]);
    return lanes;
}
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V polynomial_at(D d, const SlabLanes<kDegree, V>& lanes, V x) {
    const V v = hn::MulSub(x, lanes.slope, hn::Set(d, 1.0f));
    if constexpr (kDegree < 0) {
        const std::vector<float>& coefficient = lanes.fitted->coefficient;
        V sum = hn::Set(d, coefficient.back());
        for (std::size_t power = coefficient.size() - 1; power-- > 0;)
            sum = hn::MulAdd(sum, v, hn::Set(d, coefficient[power]));
        return sum;
    } else {
        // Estrin's scheme: half the latency of Horner's.
        const V v2 = hn::Mul(v, v);
        V sum = kDegree % 2 == 0 ? lanes.c[kDegree]
                                 : hn::MulAdd(lanes.c[kDegree], v, lanes.c[kDegree - 1]);
        for (int power = kDegree - (kDegree % 2 == 0 ? 2 : 3); power >= 0; power -= 2)
            sum = hn::MulAdd(sum, v2, hn::MulAdd(lanes.c[power + 1], v, lanes.c[power]));
        return sum;
    }
}

/// Polynomials in every lane.
template <int kPart, int kPeak, class V>
struct SlabPolynomialLanes {
    SlabLanes<kPart, V> part;
    SlabLanes<kPeak, V> peak;
};

/// What is the same at all pixels of a splat and a band.
template <class V>
struct LightLanes {
    V light[4][3];
    V depth, forward, per_forward, per_root, root_by, x, y, along, depth_x, depth_y;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightLanes<V> light_lanes(D d, const SlabSplat& s) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    LightLanes<V> lanes;
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t n = 0; n < 3; ++n) lanes.light[c][n] = set(s.light[c][n]);
    lanes.depth = set(s.depth), lanes.per_forward = set(1 / s.forward);
    lanes.forward = set(s.forward);
    lanes.per_root = set(s.per_root), lanes.root_by = set(1 / s.per_root);
    lanes.x = set(s.x), lanes.y = set(s.y), lanes.along = set(s.along);
    lanes.depth_x = set(s.depth_x), lanes.depth_y = set(s.depth_y);
    return lanes;
}

/// The forms of FarSplat at pixels, and their offsets from the projected mean.
template <class V>
struct SlabForms {
    V a, f, c, across;  ///< F = f - a², C = c² + across² + e02
    V dx, dy;
};

/// Slabs that a splat meets, the same for all its pixels.
struct SlabRun {
    int first, last;
    float back;  ///< depth of the back of the first
};
inline SlabRun slabs_of(const SlabSplat& light, const SlabBand& band) {
    const int first = band.slab_at(light.near), last = band.slab_at(light.far);
    return {first, last, band.first + static_cast<float>(first + 1) * band.thickness};
}

/// Adds the parts of one vector of pixels to the slabs they lie in.
/// offset  of the pixels in a plane of the band
template <bool kParallel, bool kClipped, class Block, class Polynomials, class D,
          class V = hn::Vec<D>>
HWY_INLINE void add_parts(D d, const Polynomials& polynomials, const SplatLanes<V>& s,
                          const LightLanes<V>& light, const SlabRun& slabs, const SlabForms<V>& at,
                          SlabBand& band, std::size_t offset) {
    const V zero = hn::Zero(d);
    const V big_f = hn::Max(hn::NegMulAdd(at.a, at.a, at.f), zero);
    const auto inside = hn::Gt(big_f, zero);
    if (hn::AllFalse(d, inside)) return;
    const V c = kParallel ? s.e02 : hn::MulAdd(at.c, at.c, hn::MulAdd(at.across, at.across, s.e02));
    const V root = hn::Sqrt(c), per_root = reciprocal(d, root);
    const V per_c = hn::Mul(per_root, per_root);
    const V ratio = hn::Mul(big_f, per_c);
    const V reach = hn::Sqrt(ratio);
    const V peak = hn::Mul(per_root, polynomial_at(d, polynomials.peak, ratio));
    const V deviation = hn::Mul(light.per_root, per_root);
    V nearest, z, slope;  // t*, z there, change of z with u
    if constexpr (kParallel) {
        nearest = hn::MulAdd(light.depth_x, at.dx, hn::MulAdd(light.depth_y, at.dy, light.depth));
        z = hn::MulAdd(light.x, at.dx, hn::Mul(light.y, at.dy));
        slope = hn::Mul(light.along, deviation);
    } else {
        const V across = hn::MulAdd(light.x, at.dx, hn::Mul(light.y, at.dy));
        const V along = hn::Add(light.along, across);
        const V delta_x = hn::MulAdd(s.cx, at.dx, hn::Mul(s.cy, at.dy));
        const V delta_y = hn::Mul(s.dy, at.dy);
        const V q = hn::Mul(hn::MulAdd(delta_x, at.c, hn::Mul(delta_y, at.across)), per_c);
        nearest = hn::NegMulAdd(light.forward, q, light.depth);
        z = hn::NegMulAdd(q, along, across);
        slope = hn::Mul(along, hn::Mul(deviation, light.per_forward));
    }
    const V per_deviation = hn::Mul(root, light.root_by);
    const V half_one = hn::Set(d, 0.5f);
    V lowest = hn::Neg(reach), highest = reach;
    if constexpr (kClipped) {
        const auto end_of = [&](const std::vector<float>& depths) {
            const V depth = Block::load(d, depths.data() + offset);
            return hn::Min(hn::Max(hn::Mul(hn::Sub(depth, nearest), per_deviation), lowest), reach);
        };
        highest = end_of(band.clip_far);
        lowest = end_of(band.clip_near);
    }
    const auto part_at = [&](V u) {
        return hn::Mul(u, polynomial_at(d, polynomials.part, hn::Mul(u, u)));
    };
    V from = lowest, before = part_at(lowest);
    // Backs of the slabs in deviations from the nearest point.
    const V thickness = hn::Mul(hn::Set(d, band.thickness), per_deviation);
    V back = hn::Mul(hn::Sub(hn::Set(d, slabs.back), nearest), per_deviation);
    float* sums = band.plane(slabs.first, 0) + offset;
    for (int slab = slabs.first; slab <= slabs.last; ++slab) {
        V to = highest;
        if (slab != slabs.last) to = hn::Min(hn::Max(back, lowest), highest);
        back = hn::Add(back, thickness);
        const V after = part_at(to);
        const V tau = hn::Mul(peak, hn::Sub(after, before));
        const V at_z = hn::MulAdd(slope, hn::Mul(half_one, hn::Add(from, to)), z);
        for (int n = 0; n < 4; ++n) {
            const V* q = light.light[n];
            V expected = hn::MulAdd(hn::MulAdd(q[2], at_z, q[1]), at_z, q[0]);
            // Colour is limited by what is absorbed in the end, for all splats at once.
            if (n == 3) expected = hn::Max(expected, zero);
            Block::store(d, hn::MulAdd(tau, expected, Block::load(d, sums)), sums);
            sums += SlabBand::kPlane;
        }
        from = to, before = after;
    }
}

/// Pixels of a band that a splat touches, inclusive; empty: y0 > y1.
inline TileRange range_in(const SlabBand& band, const PixelBounds& bounds) {
    return {std::max(bounds.x0 - band.column, 0), std::min(bounds.x1 - band.column, kTileWidth - 1),
            std::max(bounds.y0 - band.row, 0), std::min(bounds.y1 - band.row, kBandRows - 1)};
}

/// add_narrow of splat_rows-inl.h for light.
template <bool kParallel, bool kClipped, int kRows, class Polynomials, class D>
HWY_INLINE void add_narrow_light(D d, const FarSplat& s, const SlabSplat& light,
                                 const TileRange& range, const Polynomials& polynomials,
                                 SlabBand& band) {
    using V = hn::Vec<D>;
    constexpr int kColumns = static_cast<int>(hn::MaxLanes(D())) / kRows;
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const LightLanes<V> lights = light_lanes(d, light);
    const SlabRun slabs = slabs_of(light, band);
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
                        hn::Set(d, static_cast<float>(band.column + range.x0 - s.column)));
    const V a_row = hn::MulAdd(lanes.ax, x, lanes.a0), c_row = hn::MulAdd(lanes.cx, x, lanes.c0);
    SlabForms<V> at;
    at.dx = hn::Sub(x, hn::Set(d, light.mean_x));
    for (int row = range.y0; row <= range.y1; row += kRows) {
        const V y =
            hn::Add(hn::Load(d, kY.data()), hn::Set(d, static_cast<float>(band.row + row - s.row)));
        const V b = hn::MulAdd(lanes.by, y, lanes.b0);
        at.a = hn::MulAdd(lanes.ay, y, a_row);
        at.f = hn::NegMulAdd(b, b, lanes.f0);
        at.c = hn::MulAdd(lanes.cy, y, c_row);
        at.across = hn::MulAdd(lanes.dy, y, lanes.d0);
        at.dy = hn::Sub(y, hn::Set(d, light.mean_y));
        const auto offset =
            static_cast<std::size_t>(row) * SlabBand::kStride + static_cast<std::size_t>(range.x0);
        add_parts<kParallel, kClipped, Rows<kRows, D>>(d, polynomials, lanes, lights, slabs, at,
                                                       band, offset);
    }
}

/// add_wide of splat_rows-inl.h for light.
template <bool kParallel, bool kClipped, class Polynomials, class D>
HWY_INLINE void add_wide_light(D d, const FarSplat& s, const SlabSplat& light,
                               const TileRange& range, const Polynomials& polynomials,
                               SlabBand& band) {
    using V = hn::Vec<D>;
    RowForms rows;
    row_forms(d, s, range, band.column, band.row, rows);
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const LightLanes<V> lights = light_lanes(d, light);
    const SlabRun slabs = slabs_of(light, band);
    const auto step = static_cast<int>(hn::Lanes(d));
    const V origin = hn::Iota(d, static_cast<float>(band.column - s.column));
    for (int n = 0; n <= range.y1 - range.y0; ++n) {
        const int first = rows.first[n], last = rows.last[n];
        const float y = static_cast<float>(band.row + range.y0 + n - s.row);
        SlabForms<V> at;
        at.f = hn::Set(d, rows.f[n]);
        at.across = hn::Set(d, s.dy * y + s.d0);
        at.dy = hn::Set(d, y - light.mean_y);
        const V a_row = hn::Set(d, rows.a[n]), c_row = hn::Set(d, rows.c[n]);
        for (int column = first; column <= last; column += step) {
            const V x = hn::Add(origin, hn::Set(d, static_cast<float>(column)));
            at.a = hn::MulAdd(lanes.ax, x, a_row);
            at.c = hn::MulAdd(lanes.cx, x, c_row);
            at.dx = hn::Sub(x, hn::Set(d, light.mean_x));
            const auto offset = static_cast<std::size_t>(range.y0 + n) * SlabBand::kStride +
                                static_cast<std::size_t>(column);
            add_parts<kParallel, kClipped, Rows<1, D>>(d, polynomials, lanes, lights, slabs, at,
                                                       band, offset);
        }
    }
}

template <bool kParallel, int kPart, int kPeak, class Tags>
void add_lights_degree(const FarSplat* splats, const SlabSplat* lights, const std::uint32_t* index,
                       std::size_t count, const SlabPolynomials& polynomials, SlabBand& band) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const SlabPolynomialLanes<kPart, kPeak, V> lanes{slab_lanes<kPart>(d, polynomials.part),
                                                     slab_lanes<kPeak>(d, polynomials.peak)};
    constexpr auto kLanes = static_cast<int>(hn::MaxLanes(typename Tags::Floats()));
    constexpr bool kClipped = kPart < 0;  // slower anyway
    for (std::size_t n = 0; n < count; ++n) {
        const FarSplat& s = splats[index[n]];
        const SlabSplat& light = lights[index[n]];
        const TileRange range = range_in(band, s.bounds);
        if (range.y0 > range.y1) continue;  // other bands of the tile
        band.touch(range, light.near, light.far);
        const int width = range.x1 - range.x0 + 1;
        if (kLanes >= 16 && width <= kLanes / 4)
            add_narrow_light<kParallel, kClipped, kLanes >= 16 ? 4 : 1>(d, s, light, range, lanes,
                                                                        band);
        else if (kLanes >= 8 && width <= kLanes / 2)
            add_narrow_light<kParallel, kClipped, kLanes >= 8 ? 2 : 1>(d, s, light, range, lanes,
                                                                       band);
        else if (kLanes > 1 && width <= kLanes)
            add_narrow_light<kParallel, kClipped, 1>(d, s, light, range, lanes, band);
        else
            add_wide_light<kParallel, kClipped>(d, s, light, range, lanes, band);
    }
}

template <bool kParallel, class Tags>
void add_lights(const FarSplat* splats, const SlabSplat* lights, const std::uint32_t* index,
                std::size_t count, const SlabPolynomials& polynomials, SlabBand& band) {
    // The degrees of the default cutoff are unrolled, without a clip.
    constexpr int kPart = 5, kPeak = 6;
    const bool usual = !band.clipped && polynomials.part.coefficient.size() == kPart + 1 &&
                       polynomials.peak.coefficient.size() == kPeak + 1;
    return usual ? add_lights_degree<kParallel, kPart, kPeak, Tags>(splats, lights, index, count,
                                                                    polynomials, band)
                 : add_lights_degree<kParallel, -1, -1, Tags>(splats, lights, index, count,
                                                              polynomials, band);
}

template <class Tags>
void composite_band(SlabBand& band, const CameraFrame& frame, Rgba* image) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const auto step = static_cast<int>(hn::Lanes(d));
    const TileRange& pixels = band.pixels;
    const int width = pixels.x1 + 1;
    // |D|² = 1 + slope_x² + slope_y²; parallel rays have no slope.
    const double pixel = frame.orthographic ? 0 : 1 / frame.pixels_per_unit;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const V dark = hn::Set(d, 1e-6f);  // transmittance that hides all behind
    for (int y = pixels.y0; y <= pixels.y1; ++y) {
        const double slope_y = (band.row + y - 0.5 * (frame.height - 1)) * pixel;
        const V rest = hn::Set(d, static_cast<float>(1 + slope_y * slope_y));
        Rgba* row = image +
                    static_cast<std::size_t>(band.row + y) * static_cast<std::size_t>(frame.width) +
                    band.column;
        for (int x = pixels.x0; x < width; x += step) {
            const double left = (band.column + x - 0.5 * (frame.width - 1)) * pixel;
            const V slope_x = hn::MulAdd(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(pixel)),
                                         hn::Set(d, static_cast<float>(left)));
            const V length = hn::Sqrt(hn::MulAdd(slope_x, slope_x, rest));
            const std::size_t offset =
                static_cast<std::size_t>(y) * SlabBand::kStride + static_cast<std::size_t>(x);
            V color[3] = {zero, zero, zero}, transmittance = one;
            for (int slab = 0; slab < band.slabs; ++slab) {
                if (!band.touched[static_cast<std::size_t>(slab)]) continue;
                const V s = hn::LoadU(d, band.plane(slab, 3) + offset);
                if (hn::AllFalse(d, hn::Gt(s, zero))) continue;
                const V depth = hn::Mul(s, length);
                const V passed = hn::Exp(d, hn::Neg(depth));
                // (1 - e^{-depth}) / depth; its series where the difference cancels
                const V series = hn::MulAdd(
                    hn::MulAdd(hn::MulAdd(depth, hn::Set(d, -1 / 24.0f), hn::Set(d, 1 / 6.0f)),
                               depth, hn::Set(d, -0.5f)),
                    depth, one);
                const auto thin = hn::Lt(depth, hn::Set(d, 0.06f));
                const V share = hn::IfThenElse(
                    thin, series, hn::Div(hn::Sub(one, passed), hn::Max(depth, hn::Set(d, 1e-3f))));
                const V weight = hn::Mul(hn::Mul(transmittance, share), length);
                for (int n = 0; n < 3; ++n) {
                    // Quadratics are fitted one by one: light is at most all that is absorbed.
                    const V light =
                        hn::Max(hn::Min(hn::LoadU(d, band.plane(slab, n) + offset), s), zero);
                    color[n] = hn::MulAdd(weight, light, color[n]);
                }
                transmittance = hn::Mul(transmittance, passed);
                if (hn::AllTrue(d, hn::Lt(transmittance, dark))) break;
            }
            alignas(64) float part[4][TilePixels::kMaxLanes];
            for (int n = 0; n < 3; ++n) hn::Store(color[n], d, part[n]);
            hn::Store(hn::Sub(one, transmittance), d, part[3]);
            for (int n = 0; n < std::min(step, width - x); ++n)
                row[x + n] = {part[0][n], part[1][n], part[2][n], part[3][n]};
        }
    }
    band.clear();
}
