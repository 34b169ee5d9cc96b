// slab_layers-inl.h: Slabs of several layers to one picture: in each slab optical depths add up, and colours by them.
// Included once per SIMD target by slab_kernels.cpp, after slab_finish-inl.h.

/// Adds the optical depth of one slab of a model, and colours times it.
/// sums  red, green, blue, tau
template <class D>
void add_slab(D d, const SlabLight& light, int slab, CellView& view, SlabCell& cell,
              const CellPixels& passed, std::array<CellPixels, 4>& sums) {
    using V = hn::Vec<D>;
    const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), least = hn::Set(d, 1e-30f);
    const auto visible_at = [&](std::size_t n) {
        return hn::Ge(hn::Load(d, passed.data() + n), hn::Set(d, kDarkTransmittance));
    };
    // Light of the slab alone, where layers before let any pass.
    for (std::size_t n = 0; n < kCellPixels; n += hn::Lanes(d)) {
        for (std::size_t c = 0; c < 3; ++c) hn::Store(zero, d, cell.seen[c].data() + n);
        hn::Store(hn::IfThenElseZero(visible_at(n), one), d, cell.seen[3].data() + n);
    }
    composite_slab(d, light, slab, view, cell);
    for (std::size_t n = 0; n < kCellPixels; n += hn::Lanes(d)) {
        const V through = hn::Load(d, cell.seen[3].data() + n), absorbed = hn::Sub(one, through);
        const auto some = hn::And(hn::Gt(absorbed, zero), visible_at(n));
        if (hn::AllFalse(d, some)) continue;
        const V tau = hn::IfThenElseZero(some, hn::Neg(hn::Log(d, hn::Max(through, least))));
        const V per = hn::Div(tau, hn::Max(absorbed, least));
        for (std::size_t c = 0; c < 3; ++c) {
            float* sum = sums[c].data() + n;
            hn::Store(hn::MulAdd(per, hn::Load(d, cell.seen[c].data() + n), hn::Load(d, sum)), d,
                      sum);
        }
        float* sum = sums[3].data() + n;
        hn::Store(hn::Add(tau, hn::Load(d, sum)), d, sum);
    }
}

/// Composites the sums of a slab behind those before.
/// returns  whether all pixels are dark
template <class D>
bool composite_sums(D d, const std::array<CellPixels, 4>& sums, std::array<CellPixels, 4>& seen) {
    using V = hn::Vec<D>;
    const V one = hn::Set(d, 1.0f), dark = hn::Set(d, kDarkTransmittance);
    bool hidden = true;
    for (std::size_t n = 0; n < kCellPixels; n += hn::Lanes(d)) {
        const V tau = hn::Load(d, sums[3].data() + n), before = hn::Load(d, seen[3].data() + n);
        // 1 - e^{-tau}, by a series where the difference cancels
        const V series = hn::Mul(tau, hn::MulAdd(tau, hn::Set(d, -0.5f), one));
        const V absorbed = hn::IfThenElse(hn::Lt(tau, hn::Set(d, 1e-3f)), series,
                                          hn::Sub(one, hn::Exp(d, hn::Neg(tau))));
        const V weight = hn::Mul(before, hn::Div(absorbed, hn::Max(tau, hn::Set(d, 1e-30f))));
        for (std::size_t c = 0; c < 3; ++c) {
            float* to = seen[c].data() + n;
            hn::Store(hn::MulAdd(weight, hn::Load(d, sums[c].data() + n), hn::Load(d, to)), d, to);
        }
        const V through = hn::NegMulAdd(before, absorbed, before);
        hn::Store(through, d, seen[3].data() + n);
        hidden = hidden && hn::AllTrue(d, hn::Lt(through, dark));
    }
    return hidden;
}

/// Composites the surfaces of a slab and what lies in front of them; leaves the sums behind.
/// surfaces  of the slab
/// sums      of models
inline void composite_surfaces(std::span<const SlabSurface> surfaces,
                               std::array<CellPixels, 4>& sums, std::array<CellPixels, 4>& seen) {
    float before = 0;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const SlabSurface& surface = surfaces[n];
        const std::uint32_t p = surface.pixel;
        if (n == 0 || surfaces[n - 1].pixel != p) before = 0;
        const float part = before < 1 ? (surface.share - before) / (1 - before) : 0;
        before = surface.share;
        const float tau = part * sums[3][p] + surface.front[3];
        const float weight = seen[3][p] * (tau > 1e-6f ? -std::expm1(-tau) / tau : 1);
        const float through = seen[3][p] * std::exp(-tau);
        for (std::size_t c = 0; c < 3; ++c) {
            seen[c][p] += weight * (part * sums[c][p] + surface.front[c]) +
                          through * surface.opacity * surface.color[c];
            sums[c][p] *= 1 - part;
        }
        sums[3][p] *= 1 - part;
        seen[3][p] = through * (1 - surface.opacity);
    }
}

template <class Tags>
void composite_layers(std::span<const LayerCell> layers, std::span<const SlabSurface> surfaces,
                      std::array<CellPixels, 4>& seen) {
    const typename Tags::Floats d;
    std::vector<CellView> views(layers.size());
    int lowest = kMostSlabs, highest = -1;
    for (std::size_t n = 0; n < layers.size(); ++n) {
        SlabCell& cell = *layers[n].cell;
        lowest = std::min(lowest, cell.lowest), highest = std::max(highest, cell.highest);
        if (layers[n].light) begin_cell(d, layers[n].light->frame, cell, views[n]);
    }
    seen = {};
    seen[3].fill(1);
    alignas(64) std::array<CellPixels, 4> sums;
    for (int slab = lowest; slab <= highest; ++slab) {
        sums = {};
        const auto meets = [&](const LayerCell& layer) {
            return slab >= layer.cell->lowest && slab <= layer.cell->highest;
        };
        for (std::size_t n = 0; n < layers.size(); ++n)
            if (layers[n].light && meets(layers[n]))
                add_slab(d, *layers[n].light, slab, views[n], *layers[n].cell, seen[3], sums);
        const auto behind = std::ranges::find_if(
            surfaces, [&](const SlabSurface& surface) { return surface.slab > slab; });
        const auto here = static_cast<std::size_t>(behind - surfaces.begin());
        composite_surfaces(surfaces.first(here), sums, seen);
        surfaces = surfaces.subspan(here);
        for (const LayerCell& layer : layers)
            for (std::size_t c = 0; c < 4 && !layer.light && meets(layer); ++c)
                for (std::size_t p = 0; p < kCellPixels; ++p)
                    sums[c][p] += layer.cell->slab(slab)[c].pixel[p];
        if (composite_sums(d, sums, seen)) return;
    }
}
