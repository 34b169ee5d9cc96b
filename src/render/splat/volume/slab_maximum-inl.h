// slab_maximum-inl.h: Largest mean over the slabs of a cell, one SIMD vector of pixels at a time.
// Included once per SIMD target by slab_kernels.cpp.

template <class Tags>
void maximum_cell(float most_share, SlabCell& cell) {
    const typename Tags::Floats d;
    using V = hn::Vec<typename Tags::Floats>;
    const V nothing = hn::Set(d, -std::numeric_limits<float>::infinity());
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), most = hn::Set(d, most_share);
    cell.seen = {};
    for (std::size_t n = 0; n < kCellPixels; n += hn::Lanes(d)) {
        const auto sum = [&](int slab, int channel) {
            return hn::Load(d, cell.slab(slab)[channel].pixel.data() + n);
        };
        V densest = zero, largest = nothing;
        for (int slab = cell.lowest; slab <= cell.highest; ++slab)
            densest = hn::Max(densest, sum(slab, kTau));
        const V least = hn::Mul(densest, hn::Set(d, static_cast<float>(kLeastDensityShare)));
        for (int slab = cell.lowest; slab <= cell.highest; ++slab) {
            const V weight = sum(slab, kTau);
            const auto counts = hn::And(hn::Gt(weight, zero), hn::Ge(weight, least));
            if (hn::AllFalse(d, counts)) continue;
            const V mean = hn::Min(hn::Div(sum(slab, kFirst), weight), hn::Mul(most, weight));
            largest = hn::Max(largest, hn::IfThenElse(counts, mean, nothing));
        }
        const auto any = hn::Gt(largest, nothing);
        const V share = hn::Min(hn::Max(largest, zero), one);
        hn::Store(hn::IfThenElseZero(any, share), d, cell.seen[0].data() + n);
        hn::Store(hn::IfThenElse(any, zero, one), d, cell.seen[3].data() + n);
    }
}
