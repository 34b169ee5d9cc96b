// slab_finish-inl.h: Sums of depth slabs to light, one SIMD vector of pixels at a time: classification after blending.
// Included once per SIMD target by slab_kernels.cpp, after slab_light-inl.h.

/// Central moments of a vector of pixels; the gradient is a sum.
template <class V>
struct MomentLanes {
    V tau, mean, variance, third, gradient[3];
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE MomentLanes<V> moments_at(D d, const SlabPlane* slab, bool lit, std::size_t n) {
    const auto sum = [&](int channel) { return hn::Load(d, slab[channel].pixel.data() + n); };
    MomentLanes<V> m;
    const V zero = hn::Zero(d), two = hn::Set(d, 2.0f), three = hn::Set(d, 3.0f);
    m.tau = sum(kTau);
    const V per = hn::Div(hn::Set(d, 1.0f), hn::Max(m.tau, hn::Set(d, 1e-30f)));
    m.mean = hn::Mul(sum(kFirst), per);
    const V square = hn::Mul(sum(kSecond), per), mean2 = hn::Mul(m.mean, m.mean);
    // Rounding of sums of equal values must not spread them.
    const V noise = hn::Set(d, 1 - 4e-7f);
    m.variance = hn::Max(hn::MulSub(square, noise, mean2), zero);
    m.third = hn::NegMulAdd(m.mean, hn::MulSub(three, square, hn::Mul(two, mean2)),
                            hn::Mul(sum(kThird), per));
    for (int c = 0; c < 3; ++c) m.gradient[c] = lit ? sum(kGradient + c) : zero;
    return m;
}

/// Two normal distributions in every lane.
template <class V>
struct PairLanes {
    V high, low, of_high;  ///< means, the weight of `high`
    V high_variance, low_variance;
};
/// device::normal_pair.
template <class D, class V = hn::Vec<D>>
HWY_INLINE PairLanes<V> normal_pair(D d, const MomentLanes<V>& m, bool labels) {
    using device::NormalPair;
    const float most = labels ? NormalPair::kMostOfLabels : NormalPair::kMostSkewness;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const V zero = hn::Zero(d), one = set(1);
    const auto spread =
        hn::Gt(m.variance, set(labels ? NormalPair::kLeastOfLabels : NormalPair::kLeastVariance));
    const V deviation = hn::Sqrt(m.variance);
    const V cube = hn::Max(hn::Mul(m.variance, deviation), set(1e-12f));
    const V skew = hn::Min(hn::Max(hn::Div(m.third, cube), set(-most)), set(most));
    const V u = hn::Mul(skew, set(labels ? 1 : NormalPair::kPerCube));
    const V root = hn::Sqrt(hn::MulAdd(u, u, set(4)));
    const V half = hn::IfThenElseZero(
        spread, hn::Mul(deviation, set(0.5f * (labels ? 1 : NormalPair::kShare))));
    const auto share = [&](V offset) {
        return hn::Min(hn::Max(hn::MulAdd(half, offset, m.mean), zero), one);
    };
    const V variance =
        hn::IfThenElse(spread, hn::Mul(m.variance, set(NormalPair::kNarrow)), m.variance);
    const V high = share(hn::Add(u, root)), low = share(hn::Sub(u, root));
    const V of_high = hn::MulAdd(hn::Div(u, root), set(-0.5f), set(0.5f));
    if (labels) return {high, low, of_high, zero, zero};
    const auto within = [&](V mean) {
        const V room = hn::Min(mean, hn::Sub(one, mean));
        return hn::IfThenElse(spread, hn::Min(variance, hn::Mul(room, room)), variance);
    };
    return {high, low, of_high, within(high), within(low)};
}

/// Place in a row of MeanLight's table, and how much of the next column counts.
template <class D>
HWY_INLINE void set_columns(D d, const device::MeanLight& table, hn::Vec<D> mean,
                            std::int32_t* column, float* right) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    const hn::RebindToSigned<D> di;
    using V = hn::Vec<D>;
    const V part = hn::Sub(hn::Min(hn::Max(mean, set(table.low)), set(table.high)), set(table.low));
    const V x = hn::Mul(hn::MulAdd(mean, set(table.per_range), hn::Mul(part, set(table.per_part))),
                        set(device::MeanLight::kColumns - 1));
    const auto at = hn::Min(hn::ConvertTo(di, x), hn::Set(di, device::MeanLight::kColumns - 2));
    hn::Store(at, di, column);
    hn::Store(hn::Sub(x, hn::ConvertTo(d, at)), d, right);
}

/// device::seen_share: depths of cells.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V seen_share(D d, V high, V low, V of_high) {
    const V one = hn::Set(d, 1.0f), thin = hn::Set(d, device::kThinCell);
    const V mean = hn::MulAdd(of_high, hn::Sub(high, low), low);
    const auto mixed = hn::Gt(mean, thin);
    if (hn::AllFalse(d, mixed)) return one;
    const V through = hn::Exp(d, hn::Neg(low));
    const V passed = hn::MulAdd(of_high, hn::Sub(hn::Exp(d, hn::Neg(high)), through), through);
    const V seen = hn::Neg(hn::Log(d, hn::Max(passed, hn::Set(d, 1e-30f))));
    return hn::IfThenElse(mixed, hn::Div(seen, hn::Max(mean, thin)), one);
}

/// MeanLight::at of one pixel, from the first of its four entries.
template <class D8>
HWY_INLINE void table_at([[maybe_unused]] D8 d8, const float* upper, float right, float down,
                         float* out) {
    const float* lower = upper + std::ptrdiff_t{4} * device::MeanLight::kColumns;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(D8()) == 8) {
        // An entry and the next one in its row lie side by side.
        const hn::Half<D8> d4;
        const auto a = hn::LoadU(d8, upper), b = hn::LoadU(d8, lower);
        const auto both = hn::MulAdd(hn::Set(d8, down), hn::Sub(b, a), a);
        const auto left = hn::LowerHalf(d4, both);
        const auto change = hn::Sub(hn::UpperHalf(d4, both), left);
        return hn::Store(hn::MulAdd(hn::Set(d4, right), change, left), d4, out);
    }
#endif
    const hn::CappedTag<float, 4> d4;
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d4)) {
        const auto between = [&](const float* entry) {
            const auto left = hn::LoadU(d4, entry + c);
            return hn::MulAdd(hn::Set(d4, right), hn::Sub(hn::LoadU(d4, entry + 4 + c), left),
                              left);
        };
        const auto above = between(upper);
        hn::Store(hn::MulAdd(hn::Set(d4, down), hn::Sub(between(lower), above), above), d4,
                  out + c);
    }
}

/// device::gradient_factor.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V gradient_factor(D d, const device::MeanLight& light, const MomentLanes<V>& m) {
    const auto set = [&](float v) { return hn::Set(d, v); };
    const V* g = m.gradient;
    const V steep = hn::Sqrt(hn::MulAdd(g[0], g[0], hn::MulAdd(g[1], g[1], hn::Mul(g[2], g[2]))));
    const V share = hn::Div(hn::Mul(set(light.per_gradient), steep), hn::Max(m.tau, set(1e-30f)));
    V factor = set(light.gradient.first);
    for (int n = 0; n < light.gradient.parts; ++n) {
        const V within = hn::Max(hn::Sub(share, set(light.gradient.start[n])), hn::Zero(d));
        factor = hn::MulAdd(hn::Min(within, set(light.gradient.width[n])),
                            set(light.gradient.slope[n]), factor);
    }
    return hn::Min(hn::Max(factor, hn::Zero(d)), set(1));
}

/// Light of pairs, per unit of tau; of lanes that do not count, 0. Pixel by pixel: a pixel's four channels lie side by
/// side in the table, and gathers of them took four times as long.
/// cell  tau of a cell of such matter
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightLanes<V> mean_light(D d, const device::MeanLight& light, const MomentLanes<V>& m,
                                    V cell, hn::Mask<D> counts) {
    using Table = device::MeanLight;
    constexpr std::size_t kMost = TilePixels::kMaxLanes;
    const hn::RebindToSigned<D> di;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const PairLanes<V> pair = normal_pair(d, m, light.labels);
    V factor = set(1);
    if (light.gradient.any()) {
        factor = gradient_factor(d, light, m);
        counts = hn::And(counts, hn::Gt(factor, hn::Zero(d)));
        cell = hn::Mul(cell, factor);
    }
    // Both of the pair within four deviations of values that have light.
    const auto reaches = [&](V gap, V variance) {
        return hn::Or(hn::Le(gap, hn::Zero(d)),
                      hn::Le(hn::Mul(gap, gap), hn::Mul(set(16), variance)));
    };
    counts = hn::And(counts,
                     hn::And(reaches(hn::Sub(set(light.first_seen), pair.high), pair.high_variance),
                             reaches(hn::Sub(pair.low, set(light.last_seen)), pair.low_variance)));
    alignas(64) float out[2][4 * kMost], down[2][kMost], right[2][kMost];
    alignas(64) std::int32_t column[2][kMost], row[2][kMost];
    alignas(8) std::uint8_t of_mask[8] = {};
    hn::StoreMaskBits(d, counts, of_mask);
    for (auto& of_mean : out)
        for (std::size_t c = 0; c < 4; ++c) hn::Store(hn::Zero(d), d, of_mean + c * hn::Lanes(d));
    unsigned bits = of_mask[0] | of_mask[1] << 8u;
    if (!light.table) {
        hn::Store(pair.high, d, right[0]);
        hn::Store(pair.low, d, right[1]);
        hn::Store(hn::Sqrt(pair.high_variance), d, down[0]);
        hn::Store(hn::Sqrt(pair.low_variance), d, down[1]);
        for (; bits != 0; bits &= bits - 1) {
            const auto n = static_cast<std::size_t>(std::countr_zero(bits));
            for (std::size_t p = 0; p < 2; ++p)
                light.pieces.light(right[p][n], down[p][n], out[p] + 4 * n);
        }
    } else {
        set_columns(d, light, pair.high, column[0], right[0]);
        set_columns(d, light, pair.low, column[1], right[1]);
        // MeanLight::row
        constexpr float kFirst = Table::kLeastVariance;
        const V first = set(kFirst), most = set(Table::kMostVariance);
        const auto set_row = [&](V variance, std::int32_t* rows, float* under) {
            const V octaves = hn::Mul(
                hn::ConvertTo(
                    d, hn::Sub(hn::BitCast(di, hn::Min(variance, most)), hn::BitCast(di, first))),
                set(0x1p-23f));
            const V y = hn::IfThenElse(hn::Le(variance, first), hn::Mul(variance, set(1 / kFirst)),
                                       hn::Add(octaves, set(1)));
            const auto above = hn::Min(hn::ConvertTo(di, y), hn::Set(di, Table::kRows - 2));
            hn::Store(hn::ShiftLeft<10>(above), di, rows);
            static_assert(Table::kColumns == 1 << 10);
            hn::Store(hn::Sub(y, hn::ConvertTo(d, above)), d, under);
        };
        set_row(pair.high_variance, row[0], down[0]);
        set_row(pair.low_variance, row[1], down[1]);
        for (; bits != 0; bits &= bits - 1) {
            const auto n = static_cast<std::size_t>(std::countr_zero(bits));
            for (std::size_t p = 0; p < 2; ++p)
                table_at(hn::CappedTag<float, 8>(), light.table + 4 * (row[p][n] + column[p][n]),
                         right[p][n], down[p][n], out[p] + 4 * n);
        }
    }
    LightLanes<V> all, high;
    hn::LoadInterleaved4(d, out[0], high.c[0], high.c[1], high.c[2], high.c[3]);
    hn::LoadInterleaved4(d, out[1], all.c[0], all.c[1], all.c[2], all.c[3]);
    V seen = seen_share(d, hn::Mul(cell, high.c[3]), hn::Mul(cell, all.c[3]), pair.of_high);
    if (light.gradient.any()) seen = hn::Mul(seen, factor);
    for (int c = 0; c < 4; ++c)
        all.c[c] = hn::Mul(hn::MulAdd(pair.of_high, hn::Sub(high.c[c], all.c[c]), all.c[c]), seen);
    return all;
}

/// A vector of pixels behind those before.
template <class V>
struct SeenLanes {
    V c[3], passed;
};
/// Composites moments.
/// along    tau on the ray
/// reached  light at a share of the way through them, 0 in front
/// light    mean_light(), of lanes that do not count 0
template <class D, class Reached, class V = hn::Vec<D>>
HWY_INLINE void composite_part(D d, const SlabLight& of, const MomentLanes<V>& m,
                               const CellRays& rays, std::size_t n, V along, const Reached& reached,
                               LightLanes<V> light, SeenLanes<V>& seen) {
    const V one = hn::Set(d, 1.0f), depth = hn::Mul(light.c[3], along);
    // (1 - e^{-depth}) / depth, and e^{-depth}; the series where the difference cancels
    V part = hn::MulAdd(hn::MulAdd(hn::MulAdd(depth, hn::Set(d, -1 / 24.0f), hn::Set(d, 1 / 6.0f)),
                                   depth, hn::Set(d, -0.5f)),
                        depth, one);
    V passed = hn::NegMulAdd(depth, part, one);
    const auto thin = hn::Lt(depth, hn::Set(d, 0.06f));
    if (!hn::AllTrue(d, thin)) {
        passed = hn::IfThenElse(thin, passed, hn::Exp(d, hn::Neg(depth)));
        part = hn::IfThenElse(thin, part,
                              hn::Div(hn::Sub(one, passed), hn::Max(depth, hn::Set(d, 1e-3f))));
    }
    if (of.lattice.any()) {
        // device::seen_at
        V share = hn::NegMulAdd(depth, hn::Set(d, 1 / 12.0f), hn::Set(d, 0.5f));
        const V absorbed = hn::Max(hn::Mul(depth, part), hn::Set(d, 1e-3f));
        share = hn::IfThenElse(hn::Lt(depth, hn::Set(d, 0.1f)), share,
                               hn::Div(hn::Sub(part, passed), absorbed));
        const ReachedLanes<V> arrives = reached(share);
        of.look.on ? shade(d, of.look, m.gradient, rays, n, arrives, light)
                   : spread(d, of.look, rays, n, arrives, light);
    } else if (of.look.on) {
        ReachedLanes<V> arrives;
        set_all(of, one, arrives.direct);
        arrives.ambient = one;
        shade(d, of.look, m.gradient, rays, n, arrives, light);
    }
    const V weight = hn::Mul(hn::Mul(seen.passed, part), along);
    for (int c = 0; c < 3; ++c) seen.c[c] = hn::MulAdd(weight, light.c[c], seen.c[c]);
    seen.passed = hn::Mul(seen.passed, passed);
}

using device::kSurfaceDepth, device::kSurfaceSteps;

/// A slab beside one that is divided.
template <class V>
struct NeighbourLanes {
    MomentLanes<V> m;
    V trend;  ///< device::trend_between
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE NeighbourLanes<V> neighbour(D d, const SlabCell& cell, int slab, std::size_t n,
                                       const MomentLanes<V>& own) {
    NeighbourLanes<V> out;
    const V zero = hn::Zero(d);
    if (slab >= 0 && slab < cell.slabs) {
        out.m = moments_at(d, cell.slab(slab), cell.channels == kLitChannels, n);
    } else {
        out.m = own;
        out.m.tau = zero;
    }
    const V share = hn::Div(out.m.tau, hn::Max(own.tau, hn::Set(d, 1e-30f)));
    const V change = hn::Mul(hn::Min(share, hn::Set(d, 1.0f)), hn::Sub(out.m.mean, own.mean));
    out.trend = hn::Mul(hn::Mul(change, change), hn::Set(d, 1 / 12.0f));
    return out;
}

/// Moments of the steps of a slab: between the means of slabs weights, means and spreads are linear, and steps
/// together have the slab's weight and mean.
/// division  device::division_of
/// by_tau    whether the length of gradients counts
template <class D, class V = hn::Vec<D>>
HWY_INLINE void divide_slab(D d, const MomentLanes<V>& own, const NeighbourLanes<V> (&beside)[2],
                            V division, bool by_tau, MomentLanes<V> (&steps)[kSurfaceSteps]) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), least = hn::Set(d, 1e-30f);
    const V trend_share = hn::Mul(division, division);
    V whole = zero, first = zero;
    for (int k = 0; k < kSurfaceSteps; ++k) {
        const float at = (static_cast<float>(k) + 0.5f) / kSurfaceSteps - 0.5f;
        const NeighbourLanes<V>& other = beside[at < 0 ? 0 : 1];
        const V share = hn::Mul(division, hn::Set(d, std::abs(at))), rest = hn::Sub(one, share);
        const V b = hn::Mul(other.m.tau, share), tau = hn::MulAdd(own.tau, rest, b);
        const V of = hn::Div(b, hn::Max(tau, least)), left = hn::Sub(one, of);
        MomentLanes<V>& m = steps[k];
        m.tau = tau;
        m.mean = hn::MulAdd(of, other.m.mean, hn::Mul(left, own.mean));
        const V variance = hn::MulAdd(of, other.m.variance, hn::Mul(left, own.variance));
        m.variance = hn::Max(hn::NegMulAdd(trend_share, other.trend, variance), zero);
        m.third = hn::MulAdd(of, other.m.third, hn::Mul(left, own.third));
        for (int c = 0; c < 3; ++c)
            m.gradient[c] = hn::MulAdd(share, other.m.gradient[c], hn::Mul(rest, own.gradient[c]));
        whole = hn::Add(whole, tau), first = hn::MulAdd(tau, m.mean, first);
    }
    const V per = hn::Div(one, hn::Max(whole, least));
    const V scale = hn::Mul(own.tau, per), shift = hn::NegMulAdd(first, per, own.mean);
    for (MomentLanes<V>& m : steps) {
        m.tau = hn::Mul(m.tau, scale);
        m.mean = hn::Add(m.mean, shift);
        for (int c = 0; c < 3 && by_tau; ++c) m.gradient[c] = hn::Mul(m.gradient[c], scale);
    }
}

/// Composites a slab behind those before.
/// returns  whether all pixels are dark
template <class D>
HWY_NOINLINE bool composite_slab(D d, const SlabLight& light, int slab, CellView& view,
                                 SlabCell& cell) {
    const CellRays& rays = view.pixels;
    using V = hn::Vec<D>;
    const V zero = hn::Zero(d), dark = hn::Set(d, light.dark);
    const bool lit = cell.channels == kLitChannels;
    bool hidden = true;
    for (std::size_t n = 0; n < kCellPixels; n += hn::Lanes(d)) {
        if (!cell.draws(n / kCellWidth)) continue;
        SeenLanes<V> before;
        before.passed = hn::Load(d, cell.seen[3].data() + n);
        const auto visible = hn::Ge(before.passed, dark);
        const auto counts =
            hn::And(visible, hn::Gt(hn::Load(d, cell.slab(slab)->pixel.data() + n), zero));
        hidden = hidden && hn::AllFalse(d, visible);
        if (hn::AllFalse(d, counts)) continue;
        for (std::size_t c = 0; c < 3; ++c) before.c[c] = hn::Load(d, cell.seen[c].data() + n);
        const MomentLanes<V> own = moments_at(d, cell.slab(slab), lit, n);
        const V length = hn::Load(d, rays.length.data() + n), along = hn::Mul(own.tau, length);
        const auto lit_of = [&](const MomentLanes<V>& m, V tau, int parts, hn::Mask<D> lanes) {
            const V per_cell = hn::Set(d, light.light.parts_per_cell * static_cast<float>(parts));
            return mean_light(d, light.light, m, hn::Mul(tau, per_cell), lanes);
        };
        const auto reached_in = [&](int part, int parts) {
            return [&, part, parts](V share) {
                const V scale = hn::Set(d, 1 / static_cast<float>(parts));
                const V of_slab = hn::Mul(scale, hn::Add(share, hn::Set(d, float(part))));
                return view.reached(d, light, cell.depths, slab, n, of_slab);
            };
        };
        // 1 / 32,768 of a pixel's light is not seen, of any number of slabs.
        const auto some = hn::Gt(hn::Mul(along, hn::Set(d, light.light.most)),
                                 hn::Set(d, 1.0f / static_cast<float>(32768 * cell.slabs)));
        const LightLanes<V> own_light = lit_of(own, along, 1, hn::And(counts, some));
        const V depth = hn::Mul(own_light.c[3], along);
        if (hn::AllTrue(d, hn::Eq(depth, zero))) continue;
        SeenLanes<V> seen = before;
        V division = zero;
        auto divides = hn::And(counts, hn::Gt(depth, hn::Set(d, kSurfaceDepth)));
        if (light.light.labels) divides = hn::FirstN(d, 0);
        if (!hn::AllFalse(d, divides)) {
            const V one = hn::Set(d, 1.0f);
            const NeighbourLanes<V> beside[2] = {neighbour(d, cell, slab - 1, n, own),
                                                 neighbour(d, cell, slab + 1, n, own)};
            const V own_share = hn::Max(hn::Mul(own.variance, hn::Set(d, device::kSurfaceShare)),
                                        hn::Set(d, 1e-12f));
            const V sloped = lit ? hn::Set(d, 2.0f)
                                 : hn::Div(hn::Max(beside[0].trend, beside[1].trend), own_share);
            const V deep = hn::Mul(depth, hn::Set(d, 1 / kSurfaceDepth));
            division = hn::Min(hn::Sub(hn::Min(deep, sloped), one), one);
            divides = hn::And(divides, hn::Gt(division, zero));
            if (!hn::AllFalse(d, divides)) {
                MomentLanes<V> steps[kSurfaceSteps];
                divide_slab(d, own, beside, hn::Max(division, zero), light.light.gradient.any(),
                            steps);
                SeenLanes<V> divided = before;
                for (int k = 0; k < kSurfaceSteps; ++k) {
                    const MomentLanes<V>& step = steps[k];
                    const auto open = hn::And(divides, hn::Ge(divided.passed, dark));
                    if (hn::AllFalse(d, open)) break;
                    const V tau = hn::Mul(step.tau, length);
                    composite_part(d, light, step, rays, n, tau, reached_in(k, kSurfaceSteps),
                                   lit_of(step, tau, kSurfaceSteps, open), divided);
                }
                for (int c = 0; c < 3; ++c)
                    seen.c[c] = hn::IfThenElse(divides, divided.c[c], seen.c[c]);
                seen.passed = hn::IfThenElse(divides, divided.passed, seen.passed);
            }
        }
        if (!hn::AllTrue(d, divides)) {
            SeenLanes<V> whole = before;
            composite_part(d, light, own, rays, n, along, reached_in(0, 1), own_light, whole);
            for (int c = 0; c < 3; ++c) seen.c[c] = hn::IfThenElse(divides, seen.c[c], whole.c[c]);
            seen.passed = hn::IfThenElse(divides, seen.passed, whole.passed);
        }
        for (std::size_t c = 0; c < 3; ++c) hn::Store(seen.c[c], d, cell.seen[c].data() + n);
        hn::Store(seen.passed, d, cell.seen[3].data() + n);
    }
    return hidden;
}

template <class Tags>
void composite_cell(const SlabLight& light, SlabCell& cell) {
    const typename Tags::Floats d;
    CellView view;
    begin_cell(d, light.frame, cell, view);
    for (int slab = cell.lowest; slab <= cell.highest; ++slab)
        if (composite_slab(d, light, slab, view, cell)) return;
}
