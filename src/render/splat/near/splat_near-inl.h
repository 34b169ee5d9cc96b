// splat_near-inl.h: Gaussians that the eye or a clip may cut, one SIMD vector of pixels at a time, in double precision.
// Included once per SIMD target by splat_kernels.cpp, inside its namespace, after splat_project-inl.h.
//
// u counts standard deviations along the ray from the point nearest the mean, t*: the chord is |u| <= sqrt(k² - m²), and an
// interval of the ray cuts it to u0 ... u1. With e and d of ray_gaussian.h
//   tau / |D| = density e^{-m²/2} sqrt(pi/2) / |d| (erf(u1 / sqrt 2) - erf(u0 / sqrt 2))

template <class V>
HWY_INLINE Lanes3<V> cross(const Lanes3<V>& a, const Lanes3<V>& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

/// erf(u / sqrt 2) to 1.5e-7 (Abramowitz and Stegun 7.1.26).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V normal_part(D d, V u) {
    constexpr double kPoly[] = {0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429};
    const V one = hn::Set(d, 1.0);
    const V t =
        hn::Div(one, hn::MulAdd(hn::Abs(u), hn::Set(d, 0.3275911 / std::numbers::sqrt2), one));
    V sum = hn::Set(d, kPoly[4]);
    for (int n = 3; n >= 0; --n) sum = hn::MulAdd(sum, t, hn::Set(d, kPoly[n]));
    const V rest = hn::Exp(d, hn::Mul(hn::Mul(u, u), hn::Set(d, -0.5)));
    return hn::CopySign(hn::NegMulAdd(hn::Mul(sum, t), rest, one), u);
}

template <class Tags>
void add_near(const NearSplat& s, double cutoff, const TileRays& rays, TilePixels& tile) {
    const typename Tags::Doubles d;
    using V = hn::Vec<typename Tags::Doubles>;
    const hn::Rebind<float, typename Tags::Doubles> df;
    const TileRange range = range_in(tile, s.bounds);
    const auto step = static_cast<int>(hn::Lanes(d));
    const V zero = hn::Zero(d), k2 = hn::Set(d, cutoff * cutoff), one = hn::Set(d, 1.0);
    const V scale = hn::Set(d, s.density * std::sqrt(0.5 * std::numbers::pi));
    const Lanes3<V> shift = set3(d, s.shift_x), turn = set3(d, s.step_x);
    for (int y = range.y0; y <= range.y1; ++y) {
        const double row = tile.row + y;
        const Lanes3<V> e_row = set3(d, s.e + row * s.shift_y);
        const Lanes3<V> d_row = set3(d, s.corner + row * s.step_y);
        for (int x = range.x0; x <= range.x1; x += step) {
            const V column = hn::Iota(d, static_cast<double>(tile.column + x));
            const Lanes3<V> e = combine(e_row, one, shift, column);
            const Lanes3<V> along = combine(d_row, one, turn, column);
            const V inverse_c = hn::Div(one, dot(along, along));
            const Lanes3<V> offset = cross(e, along);
            const V m2 = hn::Mul(dot(offset, offset), inverse_c);
            const auto meets = hn::Lt(m2, k2);
            if (hn::AllFalse(d, meets)) continue;
            const V deviation = hn::Sqrt(inverse_c);  // t of a unit of u
            const V nearest = hn::Mul(dot(e, along), inverse_c);
            const V reach = hn::Sqrt(hn::Max(hn::Sub(k2, m2), zero));
            V first = zero, last = hn::Set(d, HUGE_VAL);
            if (s.clipped) hn::LoadInterleaved2(d, &rays.kept[y][x].first, first, last);
            const auto end_of = [&](V t) {
                const V u = hn::Div(hn::Sub(t, nearest), deviation);
                return hn::Min(hn::Max(u, hn::Neg(reach)), reach);
            };
            const V part = hn::Sub(normal_part(d, end_of(last)), normal_part(d, end_of(first)));
            const V peak = hn::Exp(d, hn::Mul(m2, hn::Set(d, -0.5)));
            const V tau = hn::Mul(hn::Mul(scale, deviation), hn::Mul(peak, hn::Max(part, zero)));
            float* at = tile.depth[y] + x;
            const auto sum = hn::DemoteTo(df, hn::IfThenElseZero(meets, tau));
            hn::StoreU(hn::Add(hn::LoadU(df, at), sum), df, at);
        }
    }
}
