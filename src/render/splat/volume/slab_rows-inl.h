// slab_rows-inl.h: Moments of splats to the depth slabs of a cell, one SIMD vector of pixels at a time, single precision.
// Included once per SIMD target by slab_kernels.cpp, after slab_finish-inl.h.

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
/// v  slope x - 1
template <int kDegree, class D, class V = hn::Vec<D>>
HWY_INLINE V polynomial_at(D d, const SlabLanes<kDegree, V>& lanes, V v) {
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

/// 1 / sqrt(v), v > 0, to a relative 4e-7 or better: the estimate of 11 bits and a Newton step.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V reciprocal_root(D d, V v) {
    if constexpr (kEstimates && hn::MaxLanes(D()) > 1) {
        const V r = hn::ApproximateReciprocalSqrt(v);
        const V half = hn::Mul(hn::Mul(hn::Set(d, -0.5f), v), r);
        return hn::Mul(r, hn::MulAdd(half, r, hn::Set(d, 1.5f)));
    } else {
        return hn::Div(hn::Set(d, 1.0f), hn::Sqrt(v));
    }
}

/// Polynomials in every lane.
template <int kPart, int kPeak, class V>
struct SlabPolynomialLanes {
    SlabLanes<kPart, V> part;
    SlabLanes<kPeak, V> peak;
    /// Square root of part's slope, and its reciprocal: deviations times it have v = u² - 1.
    V scale, unscale;
};

/// Coefficients of a splat, the same at all pixels; deviations in the scale of the polynomial.
template <class V>
struct ValueLanes {
    V depth, forward, per_forward, half_per_root, root_by, value, x, y, along, depth_x, depth_y;
    V variance, variance3, third, gradient[3];
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE ValueLanes<V> value_lanes(D d, const SlabSplat& s, float scale) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    ValueLanes<V> lanes;
    lanes.depth = set(s.depth), lanes.per_forward = set(1 / s.forward);
    lanes.forward = set(s.forward);
    lanes.half_per_root = set(0.5f * s.per_root / scale), lanes.root_by = set(scale / s.per_root);
    lanes.value = set(s.value), lanes.x = set(s.x), lanes.y = set(s.y), lanes.along = set(s.along);
    lanes.depth_x = set(s.depth_x), lanes.depth_y = set(s.depth_y);
    lanes.variance = set(s.variance), lanes.variance3 = set(3 * s.variance);
    lanes.third = set(s.third);
    for (int n = 0; n < 3; ++n) lanes.gradient[n] = set(s.gradient[n]);
    return lanes;
}

/// Columns of a vector of pixels, from the origin of a splat, and forms that are the same in all rows.
template <class V>
struct CellLanes {
    V x, a_row, c_row, dx;
};

/// Chords of a vector of pixels, and the field along them. u: deviations from the nearest point, in the polynomial's scale.
template <class V>
struct ChordLanes {
    V lowest, highest, before, end;  ///< ends in u, and the integrals up to them
    V peak, phi, half_slope;         ///< phi at the nearest point, half its change with u
    V nearest, per_depth;            ///< depth of u = 0, change of u with depth
};
/// Range of the depths of chords.
template <class V>
struct ChordDepths {
    V near, far;
};

/// F = (k² - m²) C of FarSplat, 0 outside of the support.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V form_at(D d, const SplatLanes<V>& s, const CellLanes<V>& columns, V y) {
    const V b = hn::MulAdd(s.by, y, s.b0), a = hn::MulAdd(s.ay, y, columns.a_row);
    return hn::Max(hn::NegMulAdd(a, a, hn::NegMulAdd(b, b, s.f0)), hn::Zero(d));
}

/// The chords of one vector of pixels.
/// n      first pixel
/// y, dy  rows from the splat's origin, and from its mean
template <bool kParallel, bool kClipped, class Polynomials, class D, class V = hn::Vec<D>>
HWY_INLINE void find_chords(D d, const Polynomials& polynomials, const SplatLanes<V>& s,
                            const ValueLanes<V>& of, const CellLanes<V>& columns, V big_f, V y,
                            V dy, const SlabCell& cell, std::size_t n, ChordLanes<V>& out,
                            ChordDepths<V>& depths) {
    const V dx = columns.dx;
    const V c_form = hn::MulAdd(s.cy, y, columns.c_row), d_form = hn::MulAdd(s.dy, y, s.d0);
    const V c = kParallel ? s.e02 : hn::MulAdd(c_form, c_form, hn::MulAdd(d_form, d_form, s.e02));
    const V one = hn::Set(d, 1.0f);
    const V per_root = reciprocal_root(d, c);
    const V per_c = hn::Mul(per_root, per_root);
    const V ratio = hn::Mul(big_f, per_c);
    const V reach = hn::Mul(hn::Sqrt(ratio), polynomials.scale);
    const V peak_at = hn::MulSub(ratio, polynomials.peak.slope, one);
    const V peak = hn::Mul(hn::Mul(per_root, polynomials.unscale),
                           polynomial_at(d, polynomials.peak, peak_at));
    const V half_deviation = hn::Mul(of.half_per_root, per_root);
    V nearest, phi, half_slope;  // t*, phi there, half the change of phi with u
    if constexpr (kParallel) {
        nearest = hn::MulAdd(of.depth_x, dx, hn::MulAdd(of.depth_y, dy, of.depth));
        phi = hn::MulAdd(of.x, dx, hn::MulAdd(of.y, dy, of.value));
        half_slope = hn::Mul(of.along, half_deviation);
    } else {
        const V across = hn::MulAdd(of.x, dx, hn::Mul(of.y, dy));
        const V along = hn::Add(of.along, across);
        const V delta_x = hn::MulAdd(s.cx, dx, hn::Mul(s.cy, dy));
        const V delta_y = hn::Mul(s.dy, dy);
        const V q = hn::Mul(hn::MulAdd(delta_x, c_form, hn::Mul(delta_y, d_form)), per_c);
        nearest = hn::NegMulAdd(of.forward, q, of.depth);
        phi = hn::NegMulAdd(q, along, hn::Add(across, of.value));
        half_slope = hn::Mul(along, hn::Mul(half_deviation, of.per_forward));
    }
    // Depths from the nearest point become scaled deviations.
    const V per_deviation = hn::Mul(hn::Mul(c, per_root), of.root_by);
    V lowest = hn::Neg(reach), highest = reach;
    if constexpr (kClipped) {
        const auto end_of = [&](const CellPixels& clip) {
            const V depth = hn::Load(d, clip.data() + n);
            return hn::Min(hn::Max(hn::Mul(hn::Sub(depth, nearest), per_deviation), lowest), reach);
        };
        highest = end_of(cell.clip_far);
        lowest = end_of(cell.clip_near);
    }
    const auto part_at = [&](V u) {
        return hn::Mul(u, polynomial_at(d, polynomials.part, hn::MulSub(u, u, one)));
    };
    const V before = part_at(lowest);
    const V end = kClipped ? part_at(highest) : hn::Neg(before);  // an odd function
    out = {lowest, highest, before, end, peak, phi, half_slope, nearest, per_deviation};
    const V deviation = hn::Add(half_deviation, half_deviation);
    depths.near = hn::Min(depths.near, hn::MulAdd(lowest, deviation, nearest));
    depths.far = hn::Max(depths.far, hn::MulAdd(highest, deviation, nearest));
}

/// Adds the parts of a vector of pixels to the slabs they lie in.
/// first_back  depth of the back of the first of the slabs
/// sums        of the first pixel in it
template <int kChannels, class Polynomials, class D, class V = hn::Vec<D>>
HWY_INLINE void add_parts(D d, const Polynomials& polynomials, const ValueLanes<V>& of,
                          const ChordLanes<V>& chord, float first_back, float slab_depth, int slabs,
                          float* sums) {
    const V one = hn::Set(d, 1.0f);
    V from = chord.lowest, before = chord.before;
    V back = hn::Mul(hn::Sub(hn::Set(d, first_back), chord.nearest), chord.per_depth);
    const V thickness = hn::Mul(hn::Set(d, slab_depth), chord.per_depth);
    const auto add = [&](int channel, V tau, V by) {
        float* sum = sums + channel * kCellPixels;
        hn::Store(hn::MulAdd(tau, by, hn::Load(d, sum)), d, sum);
    };
    const auto add_part = [&](V to, V after) {
        const V tau = hn::Mul(chord.peak, hn::Sub(after, before));
        // In the middle of the part.
        const V phi = hn::MulAdd(chord.half_slope, hn::Add(from, to), chord.phi);
        hn::Store(hn::Add(tau, hn::Load(d, sums)), d, sums);
        add(kFirst, tau, phi);
        if constexpr (kChannels >= kUnlitChannels) {
            const V square = hn::Mul(phi, phi);
            add(kSecond, tau, hn::Add(square, of.variance));
            add(kThird, tau, hn::MulAdd(hn::Add(square, of.variance3), phi, of.third));
        }
        if constexpr (kChannels == kLitChannels)
            for (int n = 0; n < 3; ++n) add(kGradient + n, tau, of.gradient[n]);
        from = to, before = after;
        sums += kChannels * kCellPixels;
    };
    for (int slab = 1; slab < slabs; ++slab) {
        const V to = hn::Min(hn::Max(back, chord.lowest), chord.highest);
        const V v = hn::MulSub(to, to, one);
        add_part(to, hn::Mul(to, polynomial_at(d, polynomials.part, v)));
        back = hn::Add(back, thickness);
    }
    add_part(chord.highest, chord.end);
}

template <bool kParallel, bool kClipped, int kChannels, class Polynomials, class D>
HWY_INLINE void add_splat(D d, const FarSplat& s, const SlabSplat& field, const CellSplat& slabs,
                          const Polynomials& polynomials, SlabCell& cell) {
    using V = hn::Vec<D>;
    const SplatLanes<V> lanes = splat_lanes(d, s);
    const ValueLanes<V> values = value_lanes(d, field, hn::GetLane(polynomials.scale));
    const V left = hn::Set(d, static_cast<float>(cell.column - s.column));
    const V top = hn::Set(d, static_cast<float>(cell.row - s.row));
    const V mean_x = hn::Set(d, field.mean_x), mean_y = hn::Set(d, field.mean_y);
    const auto inside = [](int at, int first, int most) {
        return static_cast<std::size_t>(std::clamp(at - first, 0, most));
    };
    const std::size_t step = hn::Lanes(d);
    const std::size_t x0 = inside(s.bounds.x0, cell.column, kCellWidth - 1) / step * step;
    const std::size_t x1 = inside(s.bounds.x1, cell.column, kCellWidth - 1);
    const std::size_t y0 = inside(s.bounds.y0, cell.row, kCellHeight - 1);
    const std::size_t y1 = inside(s.bounds.y1, cell.row, kCellHeight - 1);
    for (std::size_t column = x0; column <= x1; column += step) {
        CellLanes<V> columns;
        columns.x = hn::Add(hn::LoadU(d, kPixelsOfCell.x.data() + column), left);
        columns.a_row = hn::MulAdd(lanes.ax, columns.x, lanes.a0);
        columns.c_row = hn::MulAdd(lanes.cx, columns.x, lanes.c0);
        columns.dx = hn::Sub(columns.x, mean_x);
        // In loops one by one: a chord is a long chain of operations, and several of them overlap.
        V forms[kCellHeight], ys[kCellHeight];
        std::size_t rows[kCellHeight], count = 0;
        for (std::size_t row = y0; row <= y1; ++row) {
            if (!cell.draws(row)) continue;
            rows[count] = row * kCellWidth + column;
            ys[count] = hn::Add(hn::Set(d, static_cast<float>(row)), top);
            forms[count] = form_at(d, lanes, columns, ys[count]);
            count += !hn::AllFalse(d, hn::Gt(forms[count], hn::Zero(d)));
        }
        if (count == 0) continue;
        ChordLanes<V> chords[kCellHeight];
        ChordDepths<V> depths{hn::Set(d, std::numeric_limits<float>::max()),
                              hn::Set(d, std::numeric_limits<float>::lowest())};
        for (std::size_t n = 0; n < count; ++n)
            find_chords<kParallel, kClipped>(d, polynomials, lanes, values, columns, forms[n],
                                             ys[n], hn::Sub(ys[n], mean_y), cell, rows[n],
                                             chords[n], depths);
        // Fewer slabs than the whole splat meets: never one that is composited already.
        const int first = std::clamp<int>(cell.slab_at(hn::GetLane(hn::MinOfLanes(d, depths.near))),
                                          slabs.first, slabs.last);
        const int last = std::clamp<int>(cell.slab_at(hn::GetLane(hn::MaxOfLanes(d, depths.far))),
                                         first, slabs.last);
        cell.touch(first, last);
        const float first_back =
            cell.depths.first + static_cast<float>(first + 1) * cell.depths.thickness;
        float* sums = cell.slab(first)->pixel.data();
        for (std::size_t n = 0; n < count; ++n)
            add_parts<kChannels>(d, polynomials, values, chords[n], first_back,
                                 cell.depths.thickness, last - first + 1, sums + rows[n]);
    }
}

/// Adds the first splats of a run. Not inlined: sums and pictures share it.
template <bool kParallel, bool kClipped, int kChannels, class Polynomials, class D>
HWY_NOINLINE void add_splats(D d, const CellRun& run, std::size_t count,
                             const Polynomials& polynomials, SlabCell& cell) {
    for (const CellSplat& at : run.splats.first(count))
        add_splat<kParallel, kClipped, kChannels>(d, run.far[at.splat], run.fields[at.splat], at,
                                                  polynomials, cell);
}

/// Calls body(add) with a loop over splats for the frame and the polynomials.
template <bool kParallel, int kChannels, int kPart, int kPeak, class Tags, class Body>
void with_degrees(const CellSplats& splats, SlabCell& cell, const Body& body) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const SlabPolynomials& polynomials = splats.polynomials;
    const float scale = std::sqrt(polynomials.part.slope);
    const SlabPolynomialLanes<kPart, kPeak, V> lanes{slab_lanes<kPart>(d, polynomials.part),
                                                     slab_lanes<kPeak>(d, polynomials.peak),
                                                     hn::Set(d, scale), hn::Set(d, 1 / scale)};
    constexpr bool kClipped = kPart < 0;  // slower anyway
    body([&](const CellRun& run, std::size_t count) {
        if (count > 0) add_splats<kParallel, kClipped, kChannels>(d, run, count, lanes, cell);
    });
}
template <bool kParallel, int kChannels, class Tags, class Body>
void with_clip(const CellSplats& splats, SlabCell& cell, const Body& body) {
    // The degrees of the default cutoff are unrolled, without a clip.
    constexpr int kPart = 5, kPeak = 6;
    const SlabPolynomials& polynomials = splats.polynomials;
    const bool usual = !cell.clipped && polynomials.part.coefficient.size() == kPart + 1 &&
                       polynomials.peak.coefficient.size() == kPeak + 1;
    usual ? with_degrees<kParallel, kChannels, kPart, kPeak, Tags>(splats, cell, body)
          : with_degrees<kParallel, kChannels, -1, -1, Tags>(splats, cell, body);
}
template <bool kParallel, class Tags, class Body>
void with_channels(const CellSplats& splats, SlabCell& cell, const Body& body) {
    switch (cell.channels) {
        case kMaximumChannels:
            return with_clip<kParallel, kMaximumChannels, Tags>(splats, cell, body);
        case kUnlitChannels:
            return with_clip<kParallel, kUnlitChannels, Tags>(splats, cell, body);
        default:
            return with_clip<kParallel, kLitChannels, Tags>(splats, cell, body);
    }
}
template <class Tags, class Body>
void with_splats(const CellSplats& splats, SlabCell& cell, const Body& body) {
    splats.frame.orthographic ? with_channels<true, Tags>(splats, cell, body)
                              : with_channels<false, Tags>(splats, cell, body);
}

template <class Tags>
void sum_cell(const CellSplats& splats, SlabCell& cell) {
    with_splats<Tags>(splats, cell, [&](const auto& add) {
        for (const CellRun& run : splats.runs) add(run, run.splats.size());
    });
}

template <class Tags>
void draw_cell(const CellSplats& splats, const SlabLight& light, SlabCell& cell) {
    const typename Tags::Floats d;
    CellView view;
    begin_cell(d, splats.frame, cell, view);
    with_splats<Tags>(splats, cell, [&](const auto& add) {
        for (int slab = 0; slab <= cell.slabs; ++slab) {
            bool more = false;
            for (CellRun& run : splats.runs) {
                std::size_t count = 0;
                while (count < run.splats.size() && run.splats[count].first == slab) ++count;
                add(run, count);
                run.splats = run.splats.subspan(count);
                more |= !run.splats.empty();
            }
            // The slab before is complete, and so is this one, which its surfaces are found by.
            const int complete = slab - 1;
            if (complete >= cell.lowest && complete <= cell.highest) {
                if (composite_slab(d, light, complete, view, cell)) return;
                // It stays as the neighbour of the next one.
                cell.clear(cell.lowest, complete - 1);
                cell.lowest = complete;
            }
            if (!more && complete >= cell.highest) return;
        }
    });
}
