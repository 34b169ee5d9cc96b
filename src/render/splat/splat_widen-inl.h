// splat_widen-inl.h: Gaussians smaller than a pixel (docs/method.md): their screen covariance is
// raised to that of kLeastDeviationPx, then their sum over the pixels to their mass. Included by
// splat_project-inl.h.
//
// With J the change of the pixel per world unit at the mean and S the covariance, the screen
// covariance is J S Jᵀ. An eigenvalue l below the least, with the unit eigenvector v on the screen,
// is raised by d = least - l: S' = S + d b bᵀ with b across the view and J b = v. In whitened space,
// with q = W b and g² = 1 + d |q|²,
//   W' x = W x - (1 - 1/g) q q·(W x) / |q|²      spread'(x) = spread(x) + (g - 1) q (b·x) / |q|²
// the volume grows g-fold, and the peak falls g-fold to conserve the mass.

/// The view at the means.
template <class V>
struct MeanPoint {
    V slope_r, slope_u;  ///< of the rays there, right and up over forward; parallel rays: 0
    V pixels;            ///< that a world unit across the view covers
    V per_depth2;        ///< 1 / distance² along the view; parallel rays: 0
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE MeanPoint<V> mean_point(D d, V right, V up, V forward, V pixels_per_unit) {
    const V inverse = hn::Div(hn::Set(d, 1.0), forward);
    return {hn::Mul(right, inverse), hn::Mul(up, inverse), hn::Mul(pixels_per_unit, inverse),
            hn::Mul(inverse, inverse)};
}

/// Symmetric 2x2 matrices.
template <class V>
struct Symmetric2 {
    V xx, xy, yy;
};
/// Eigenvalues >= 0.
template <class V>
struct Eigenvalues2 {
    V large, small;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE Eigenvalues2<V> eigenvalues(D d, const Symmetric2<V>& m) {
    const V half = hn::Set(d, 0.5);
    const V mid = hn::Mul(half, hn::Add(m.xx, m.yy)), dif = hn::Mul(half, hn::Sub(m.xx, m.yy));
    const V rad = hn::Sqrt(hn::MulAdd(dif, dif, hn::Mul(m.xy, m.xy)));
    return {hn::Add(mid, rad), hn::Max(hn::Zero(d), hn::Sub(mid, rad))};
}
/// Unit eigenvector (x, y) of the larger eigenvalue; (-y, x) is the other's.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void eigenvector(D d, const Symmetric2<V>& m, V& x, V& y) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const V dif = hn::Mul(hn::Set(d, 0.5), hn::Sub(m.xx, m.yy));
    const V rad = hn::Sqrt(hn::MulAdd(dif, dif, hn::Mul(m.xy, m.xy)));
    // Of two parallel forms the one without cancellation.
    const auto wide = hn::Ge(dif, zero);
    x = hn::IfThenElse(wide, hn::Add(rad, dif), m.xy);
    y = hn::IfThenElse(wide, m.xy, hn::Sub(rad, dif));
    const V length2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const auto round = hn::Not(hn::Gt(length2, zero));
    const V inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(round, one, length2)));
    x = hn::IfThenElse(round, one, hn::Mul(x, inverse));
    y = hn::IfThenElse(round, zero, hn::Mul(y, inverse));
}

/// Raises the screen variance along (x, y) by `more` pixels².
template <class D, class V = hn::Vec<D>>
HWY_INLINE void raise(D d, V x, V y, V more, V unit_per_pixel, Shape<V>& s) {
    const V one = hn::Set(d, 1.0);
    const V bx = hn::Mul(x, unit_per_pixel), by = hn::Mul(y, unit_per_pixel);
    const Lanes3<V> q_over = combine(s.right_over, bx, s.up_over, by);
    const V inverse_length = hn::Div(one, hn::Sqrt(dot(q_over, q_over)));
    const Lanes3<V> q{hn::Mul(q_over.x, inverse_length), hn::Mul(q_over.y, inverse_length),
                      hn::Mul(q_over.z, inverse_length)};  // unit length
    const V length = hn::Div(s.peak, inverse_length);      // |W b|
    const V g = hn::Sqrt(hn::MulAdd(more, hn::Mul(length, length), one));
    const V spread = hn::Div(hn::Sub(g, one), length);
    s.spread_r = combine(s.spread_r, one, q, hn::Mul(spread, bx));
    s.spread_u = combine(s.spread_u, one, q, hn::Mul(spread, by));
    const V less = hn::Sub(hn::Div(one, g), one);
    const auto whitened = [&](const Lanes3<V>& over) {
        const Lanes3<V> to = combine(over, one, q, hn::Mul(less, dot(q, over)));
        return Lanes3<V>{hn::Mul(to.x, g), hn::Mul(to.y, g), hn::Mul(to.z, g)};  // over the peak
    };
    s.right_over = whitened(s.right_over);
    s.up_over = whitened(s.up_over);
    s.forward_over = whitened(s.forward_over);
    s.peak = hn::Div(s.peak, g);
    s.volume = hn::Mul(s.volume, g);
}

/// Covariance on the screen, pixels².
template <class D, class V = hn::Vec<D>>
HWY_INLINE Symmetric2<V> screen_covariance(D d, const MeanPoint<V>& at, const Shape<V>& s) {
    const V one = hn::Set(d, 1.0), scale2 = hn::Mul(at.pixels, at.pixels);
    const V slope_r = hn::Neg(at.slope_r), slope_u = hn::Neg(at.slope_u);
    const Lanes3<V> x = combine(s.spread_r, one, s.spread_f, slope_r);
    const Lanes3<V> y = combine(s.spread_u, one, s.spread_f, slope_u);
    return {hn::Mul(dot(x, x), scale2), hn::Mul(dot(x, y), scale2), hn::Mul(dot(y, y), scale2)};
}

/// Widens the Gaussians in front of the eye that are thinner than limits.least2.
/// returns  the smaller variance of each on the screen, pixels²
template <class D, class V = hn::Vec<D>>
HWY_INLINE V widen(D d, const MeanPoint<V>& at, const PixelLimits& limits, hn::Mask<D> in_front,
                   const CameraAxes<V>& axes, Lanes3<V> scale, Shape<V>& s) {
    const V least = hn::Set(d, limits.least2);
    const V before = eigenvalues(d, screen_covariance(d, at, s)).small;
    const auto thin = hn::And(in_front, hn::Lt(before, least));
    if (hn::AllFalse(d, thin)) return before;
    // Below a millionth of a pixel a scale leaves no digits to (1 - 1/g): raised to that first.
    const V unit_per_pixel = hn::Div(hn::Set(d, 1.0), at.pixels);
    const V floor = hn::Mul(unit_per_pixel, hn::Set(d, 1e-6));
    const Lanes3<V> kept{hn::Max(scale.x, floor), hn::Max(scale.y, floor), hn::Max(scale.z, floor)};
    const V volume = hn::Mul(kept.x, hn::Mul(kept.y, kept.z));
    Shape<V> wide = shape_of(d, axes, kept, hn::Mul(s.peak, hn::Div(s.volume, volume)));
    const Symmetric2<V> covariance = screen_covariance(d, at, wide);
    const Eigenvalues2<V> now = eigenvalues(d, covariance);
    V x, y;
    eigenvector(d, covariance, x, y);
    const V zero = hn::Zero(d);
    raise(d, hn::Neg(y), x, hn::Max(zero, hn::Sub(least, now.small)), unit_per_pixel, wide);
    raise(d, x, y, hn::Max(zero, hn::Sub(least, now.large)), unit_per_pixel, wide);
    const auto choose = [&](V& to, V from) { to = hn::IfThenElse(thin, from, to); };
    const auto choose3 = [&](Lanes3<V>& to, const Lanes3<V>& from) {
        choose(to.x, from.x), choose(to.y, from.y), choose(to.z, from.z);
    };
    choose3(s.spread_r, wide.spread_r), choose3(s.spread_u, wide.spread_u);
    choose3(s.spread_f, wide.spread_f);
    choose3(s.right_over, wide.right_over), choose3(s.up_over, wide.up_over);
    choose3(s.forward_over, wide.forward_over);
    choose(s.peak, wide.peak), choose(s.volume, wide.volume);
    choose(s.inverse_peak_volume, wide.inverse_peak_volume);
    return hn::IfThenElse(thin, least, before);
}

/// Coefficients of FarSplat for one vector of Gaussians.
template <class V>
struct SplatForms {
    V ax, ay, a0, by, b0, f0, cx, cy, c0, dy, d0, e02;
};

/// Divides tau by its sum over the pixels of an endless image, where `mask`.
/// integral  of tau / |D| over the screen
/// share     of the correction that is applied, [0, 1]
/// reach     half extents of the widest support, pixels
template <class D, class V = hn::Vec<D>>
HWY_INLINE void normalize(D d, const KernelPolynomial& kernel, double reach_x, double reach_y,
                          V integral, V share, hn::Mask<D> mask, SplatForms<V>& s) {
    const hn::Rebind<float, D> df;
    using F = hn::Vec<decltype(df)>;
    const auto f = [&](V v) { return hn::DemoteTo(df, v); };
    const F ax = f(s.ax), ay = f(s.ay), a0 = f(s.a0), by = f(s.by), b0 = f(s.b0), f0 = f(s.f0);
    const F cx = f(s.cx), cy = f(s.cy), c0 = f(s.c0), dy = f(s.dy), d0 = f(s.d0), e02 = f(s.e02);
    const F zero = hn::Zero(df);
    // The projected centre is within half a pixel of (0, 0).
    const int columns = static_cast<int>(reach_x + 0.5), rows = static_cast<int>(reach_y + 0.5);
    F sum = zero;
    for (int row = -rows; row <= rows; ++row) {
        const F y = hn::Set(df, static_cast<float>(row));
        const F b = hn::MulAdd(by, y, b0), across = hn::MulAdd(dy, y, d0);
        const F rest = hn::NegMulAdd(b, b, f0), n = hn::MulAdd(across, across, e02);
        const F a_row = hn::MulAdd(ay, y, a0), c_row = hn::MulAdd(cy, y, c0);
        for (int column = -columns; column <= columns; ++column) {
            const F x = hn::Set(df, static_cast<float>(column));
            const F a = hn::MulAdd(ax, x, a_row), c = hn::MulAdd(cx, x, c_row);
            const F big_f = hn::Max(hn::NegMulAdd(a, a, rest), zero);
            const F inverse_c = hn::Div(hn::Set(df, 1.0f), hn::MulAdd(c, c, n));
            const F v = hn::MulAdd(hn::Mul(big_f, inverse_c), hn::Set(df, kernel.slope),
                                   hn::Set(df, kernel.shift));
            F value = hn::Set(df, kernel.coefficient.back());
            for (std::size_t power = kernel.coefficient.size() - 1; power-- > 0;)
                value = hn::MulAdd(value, v, hn::Set(df, kernel.coefficient[power]));
            sum = hn::MulAdd(hn::Mul(hn::Sqrt(big_f), inverse_c), hn::Max(value, zero), sum);
        }
    }
    const V one = hn::Set(d, 1.0);
    const V excess = hn::Sub(hn::Div(hn::PromoteTo(d, sum), integral), one);
    // A centre outside the image's range of whole pixels has no sum.
    const auto usable = hn::And(mask, hn::Gt(excess, hn::Set(d, -0.9)));
    const V by_linear = hn::IfThenElse(usable, hn::MulAdd(share, excess, one), one);
    const V by_square = hn::Mul(by_linear, by_linear);
    for (V* linear : {&s.ax, &s.ay, &s.a0, &s.by, &s.b0, &s.cx, &s.cy, &s.c0, &s.dy, &s.d0})
        *linear = hn::Mul(*linear, by_linear);
    s.f0 = hn::Mul(s.f0, by_square), s.e02 = hn::Mul(s.e02, by_square);
}

/// 1 up to `from`, 0 from `to`, linear between them.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V taper(D d, V value, double from, double to) {
    const V rest = hn::Mul(hn::Sub(hn::Set(d, to), value), hn::Set(d, 1 / (to - from)));
    return hn::Min(hn::Set(d, 1.0), hn::Max(hn::Zero(d), rest));
}

/// Divides the splats of `mask` thinner than kSampledDeviationPx by their sums over pixels.
/// half_x, half_y   half extents of the supports, pixels
/// least_variance   smaller variances on the screen, pixels²
template <class D, class V = hn::Vec<D>>
HWY_INLINE void normalize_small(D d, const SplatModel& model, const MeanPoint<V>& at, V half_x,
                                V half_y, const Shape<V>& shape, V least_variance, hn::Mask<D> mask,
                                SplatForms<V>& forms) {
    const PixelLimits& limits = model.limits;
    mask = hn::And(mask, hn::Lt(least_variance, hn::Set(d, limits.sampled2)));
    if (hn::AllFalse(d, mask)) return;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), cutoff = hn::Set(d, model.cutoff);
    const V sff = dot(shape.spread_f, shape.spread_f);
    const V depth2 = hn::Mul(sff, at.per_depth2);
    const Symmetric2<V> covariance = screen_covariance(d, at, shape);
    const V half = hn::Mul(cutoff, hn::Sqrt(hn::Max(covariance.xx, covariance.yy)));
    const V deviation = hn::Sqrt(hn::Mul(least_variance, hn::Set(d, limits.variance)));
    const V share = hn::Mul(taper(d, deviation, device::kTaperFromPx, device::kSampledDeviationPx),
                            hn::Mul(taper(d, half, device::kTaperHalfPx, device::kMostHalfPx),
                                    taper(d, hn::Mul(cutoff, hn::Sqrt(depth2)),
                                          device::kTaperHalfDepth, device::kMostHalfDepth)));
    mask = hn::And(mask, hn::Gt(share, zero));
    if (hn::AllFalse(d, mask)) return;
    // Over the screen tau / |D| has the integral mass times the pixels of a world unit squared.
    const V spread = hn::MulAdd(hn::Set(d, 3 * limits.variance), depth2, one);
    const V integral = hn::Mul(hn::Mul(hn::Mul(shape.peak, shape.volume), hn::Set(d, limits.mass)),
                               hn::Mul(hn::Mul(at.pixels, at.pixels), spread));
    const double reach_x = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(mask, half_x, zero)));
    const double reach_y = hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElse(mask, half_y, zero)));
    normalize(d, *model.kernel, reach_x, reach_y, integral, share, mask, forms);
}
