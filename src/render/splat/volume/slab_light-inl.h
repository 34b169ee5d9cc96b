// slab_light-inl.h: Rays of a cell's pixels, and light that reaches points on them, one SIMD vector of pixels at a time.
// Included once per SIMD target by slab_kernels.cpp, before slab_finish-inl.h.

/// Columns and rows from a cell's first pixel: of all its pixels, and of its nodes, every fifth pixel of every fifth row.
template <std::size_t kCount>
using CellNumbers = std::array<float, kCount>;
template <std::size_t kAcross, std::size_t kStep>
struct CellPoints {
    static constexpr std::size_t kCount = kAcross * kAcross;
    alignas(64) CellNumbers<kCount> x{}, y{};
    constexpr CellPoints() {
        for (std::size_t n = 0; n < kCount; ++n) {
            x[n] = static_cast<float>(kStep * (n % kAcross));
            y[n] = static_cast<float>(kStep * (n / kAcross));
        }
    }
};
constexpr std::size_t kNodesAcross = 4, kNodeStep = 5;
static_assert(kCellWidth == kCellHeight && kCellWidth == (kNodesAcross - 1) * kNodeStep + 1);
constexpr CellPoints<kCellWidth, 1> kPixelsOfCell;
constexpr CellPoints<kNodesAcross, kNodeStep> kNodesOfCell;

/// Rays through points of a cell.
template <std::size_t kCount>
struct Rays {
    /// |D|, and slopes of D right and down; forward 1.
    alignas(64) CellNumbers<kCount> length, right, down;
    alignas(64) CellNumbers<kCount> side_right, side_down;  ///< of parallel rays, from the axis
};
using CellRays = Rays<kCellPixels>;
using NodeRays = Rays<kNodesAcross * kNodesAcross>;

/// |D|² = 1 + slope_x² + slope_y²; parallel rays have no slope.
template <class D, std::size_t kAcross, std::size_t kStep, std::size_t kCount>
void begin_rays(D d, const CameraFrame& frame, const SlabCell& cell,
                const CellPoints<kAcross, kStep>& points, Rays<kCount>& rays) {
    static_assert(kCount == CellPoints<kAcross, kStep>::kCount);
    const double pixel = 1 / frame.pixels_per_unit;
    const AxisPixel axis = axis_pixel(frame);
    const auto left = hn::Set(d, static_cast<float>((cell.column - axis.column) * pixel));
    const auto top = hn::Set(d, static_cast<float>((cell.row - axis.row) * pixel));
    const auto step = hn::Set(d, static_cast<float>(pixel)), zero = hn::Zero(d);
    for (std::size_t n = 0; n < kCount; n += hn::Lanes(d)) {
        const auto across = hn::MulAdd(hn::Load(d, points.x.data() + n), step, left);
        const auto along = hn::MulAdd(hn::Load(d, points.y.data() + n), step, top);
        const auto x = frame.orthographic ? zero : across, y = frame.orthographic ? zero : along;
        hn::Store(x, d, rays.right.data() + n);
        hn::Store(y, d, rays.down.data() + n);
        hn::Store(hn::Sub(across, x), d, rays.side_right.data() + n);
        hn::Store(hn::Sub(along, y), d, rays.side_down.data() + n);
        hn::Store(hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Set(d, 1.0f)))), d,
                  rays.length.data() + n);
    }
}

/// Light per unit of tau: red, green and blue times extinction, and extinction.
template <class V>
struct LightLanes {
    V c[4];
};

using device::kMostLights;

/// Shares of light that reach a point in every lane.
template <class V>
struct ReachedLanes {
    V direct[kMostLights], ambient;  ///< direct: of as many lights as there are
};
/// Sets lights; those without values arrive.
template <class V>
HWY_INLINE void set_all(const SlabLight& of, V share, V (&direct)[kMostLights]) {
    for (int k = 0; k < of.look.lights; ++k) direct[k] = share;
}
/// A place in the lattice, and how far it lies from its cell's centre.
template <class D>
struct PlaceLanes {
    hn::Vec<hn::RebindToSigned<D>> at;
    hn::Vec<D> beyond[3];
};
/// depth    from the slabs' depth 0
/// towards  cells towards a light
/// light    direction of that
template <class D, std::size_t kCount, class V = hn::Vec<D>>
HWY_INLINE PlaceLanes<D> place_at(D d, const SlabLight& of, const Rays<kCount>& rays, std::size_t n,
                                  V depth, V towards, const device::Double3& light) {
    const device::LightLattice& lattice = of.lattice;
    const hn::RebindToSigned<D> di;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const V far = hn::Add(depth, set(of.depth));
    const auto side = [&](const CellNumbers<kCount>& slope, const CellNumbers<kCount>& shift) {
        return hn::MulAdd(far, hn::Load(d, slope.data() + n), hn::Load(d, shift.data() + n));
    };
    const V right = side(rays.right, rays.side_right), down = side(rays.down, rays.side_down);
    PlaceLanes<D> out;
    out.at = hn::Zero(di);
    std::int32_t stride = 1;
    const auto place = [&](int axis, float middle, float by_right, float by_down, float by_depth,
                           double by_light) {
        const V ahead =
            hn::MulAdd(depth, set(by_depth),
                       hn::MulAdd(towards, set(static_cast<float>(by_light)), set(middle)));
        const V along = hn::MulAdd(right, set(by_right), hn::MulAdd(down, set(by_down), ahead));
        const V within =
            hn::Min(hn::Max(along, hn::Zero(d)), set(static_cast<float>(lattice.size[axis] - 1)));
        const auto cell = hn::Min(hn::ConvertTo(di, within), hn::Set(di, lattice.size[axis] - 2));
        out.beyond[axis] = hn::Sub(within, hn::ConvertTo(d, cell));
        out.at = hn::Add(out.at, hn::Mul(cell, hn::Set(di, stride)));
        stride *= lattice.size[axis];
    };
    place(0, of.middle.x, of.right.x, of.down.x, of.forward.x, light.x);
    place(1, of.middle.y, of.right.y, of.down.y, of.forward.y, light.y);
    place(2, of.middle.z, of.right.z, of.down.z, of.forward.z, light.z);
    return out;
}
/// LightLattice::between; all 1 without values.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V between(D d, const device::LightLattice& lattice, const float* values,
                     const PlaceLanes<D>& place) {
    if (!values) return hn::Set(d, 1.0f);
    const hn::RebindToSigned<D> di;
    const std::int32_t row = lattice.size[0], layer = row * lattice.size[1];
    const auto mixed = [&](int axis, V low, V high) {
        return hn::MulAdd(place.beyond[axis], hn::Sub(high, low), low);
    };
    const auto in_row = [&](std::int32_t offset) {
        const auto index = hn::Add(place.at, hn::Set(di, offset));
        return mixed(0, hn::GatherIndex(d, values, index), hn::GatherIndex(d, values + 1, index));
    };
    const auto in_layer = [&](std::int32_t offset) {
        return mixed(1, in_row(offset), in_row(offset + row));
    };
    return mixed(2, in_layer(0), in_layer(layer));
}
/// device::reached_at.
/// depth  from the slabs' depth 0
template <class D, std::size_t kCount, class V = hn::Vec<D>>
HWY_NOINLINE ReachedLanes<V> reached_at(D d, const SlabLight& of, const Rays<kCount>& rays,
                                        std::size_t n, V depth) {
    using Lattice = device::LightLattice;
    const Lattice& lattice = of.lattice;
    const V zero = hn::Zero(d);
    const PlaceLanes<D> here = place_at(d, of, rays, n, depth, zero, lattice.middle);
    const int lights = lattice.direct ? of.look.lights : 0;
    ReachedLanes<V> out;
    if (!lattice.direct) set_all(of, hn::Set(d, 1.0f), out.direct);
    if (!lattice.opaque) {
        for (int k = 0; k < lights; ++k)
            out.direct[k] = between(d, lattice, lattice.direct + k * lattice.cells(), here);
        out.ambient = between(d, lattice, lattice.ambient, here);
        return out;
    }
    const V opaque = between(d, lattice, lattice.opaque, here);
    const V edge = hn::Set(d, static_cast<float>(Lattice::kTowardsEye / lattice.per_edge));
    const V shift = hn::Div(hn::Mul(opaque, edge), hn::Load(d, rays.length.data() + n));
    const V before = hn::Sub(depth, shift);
    const V away = hn::Mul(opaque, hn::Set(d, Lattice::kTowardsLight)), one = hn::Set(d, 1.0f);
    const V inside = hn::Set(d, static_cast<float>(lattice.inside));
    const V left = hn::Div(one, hn::MulAdd(opaque, inside, one));
    PlaceLanes<D> place;
    for (int k = 0; k < lights; ++k) {
        place = place_at(d, of, rays, n, before, away, lattice.towards[k]);
        out.direct[k] =
            hn::Mul(left, between(d, lattice, lattice.direct + k * lattice.cells(), place));
    }
    // One light has its own middle.
    if (lattice.ambient && lights != 1)
        place = place_at(d, of, rays, n, before, away, lattice.middle);
    out.ambient = between(d, lattice, lattice.ambient, place);
    if (lattice.ambient) out.ambient = hn::Mul(left, out.ambient);
    return out;
}

/// Light at one depth across a cell: of rows of nodes, [node][pixel].
struct NodeLight {
    int slab = -1;  ///< whose front this is
    using Rows = CellNumbers<kNodesAcross * kCellWidth>;
    alignas(64) Rows direct[kMostLights];
    alignas(64) Rows ambient;
};
template <class D>
HWY_NOINLINE void find_node_light(D d, const SlabLight& of, const NodeRays& nodes, float depth,
                                  NodeLight& light) {
    using Nodes = CellNumbers<kNodesAcross * kNodesAcross>;
    alignas(64) Nodes direct[kMostLights];
    alignas(64) Nodes ambient;
    for (std::size_t n = 0; n < ambient.size(); n += hn::Lanes(d)) {
        const auto reached = reached_at(d, of, nodes, n, hn::Set(d, depth));
        for (int k = 0; k < of.look.lights; ++k)
            hn::Store(reached.direct[k], d, direct[k].data() + n);
        hn::Store(reached.ambient, d, ambient.data() + n);
    }
    const auto in_rows = [](const Nodes& of_nodes, NodeLight::Rows& rows) {
        for (std::size_t n = 0; n < rows.size(); ++n) {
            const std::size_t x = n % kCellWidth, left = std::min(x / kNodeStep, kNodesAcross - 2);
            const std::size_t node = n / kCellWidth * kNodesAcross + left;
            const float beyond = static_cast<float>(x - left * kNodeStep) / kNodeStep;
            rows[n] = of_nodes[node] + beyond * (of_nodes[node + 1] - of_nodes[node]);
        }
    };
    for (int k = 0; k < of.look.lights; ++k) in_rows(direct[k], light.direct[k]);
    in_rows(ambient, light.ambient);
}

/// Rays of a cell, and the light that reaches its slabs.
struct CellView {
    CellRays pixels;
    NodeRays nodes;
    NodeLight fronts[2];  ///< of even and odd slabs

    /// reached_at(), linear between nodes, and from a slab's front to its back, where nodes are closer than cells of the lattice.
    /// share  0 at the front of the slab, 1 at its back
    template <class D, class V = hn::Vec<D>>
    HWY_INLINE ReachedLanes<V> reached(D d, const SlabLight& of, const SlabDepths& depths, int slab,
                                       std::size_t n, V share) {
        constexpr double kFarthest = 0.6;  // cells from node to node
        const float front = depths.first + static_cast<float>(slab) * depths.thickness;
        const double far = of.frame.orthographic ? 1 : double{of.depth} + double{front};
        if (kNodeStep * far * of.lattice.per_edge > kFarthest * of.frame.pixels_per_unit)
            return reached_at(d, of, pixels, n,
                              hn::MulAdd(share, hn::Set(d, depths.thickness), hn::Set(d, front)));
        for (int k = slab; k < slab + 2; ++k)
            if (fronts[k % 2].slab != k) {
                const float depth = depths.first + static_cast<float>(k) * depths.thickness;
                find_node_light(d, of, nodes, depth, fronts[k % 2]);
                fronts[k % 2].slab = k;
            }
        const NodeLight &near = fronts[slab % 2], &back = fronts[(slab + 1) % 2];
        const std::size_t y = n / kCellWidth, above = std::min(y / kNodeStep, kNodesAcross - 2);
        const std::size_t upper = above * kCellWidth + n % kCellWidth, lower = upper + kCellWidth;
        const V down = hn::Set(d, static_cast<float>(y - above * kNodeStep) / kNodeStep);
        const auto between = [&](const auto& near_rows, const auto& back_rows) {
            const auto in_depth = [&](std::size_t at) {
                const V a = hn::Load(d, near_rows.data() + at);
                return hn::MulAdd(share, hn::Sub(hn::Load(d, back_rows.data() + at), a), a);
            };
            const V a = in_depth(upper);
            return hn::MulAdd(down, hn::Sub(in_depth(lower), a), a);
        };
        ReachedLanes<V> out;
        for (int k = 0; k < of.look.lights; ++k)
            out.direct[k] = between(near.direct[k], back.direct[k]);
        out.ambient = between(near.ambient, back.ambient);
        return out;
    }
};

template <class D>
void begin_cell(D d, const CameraFrame& frame, SlabCell& cell, CellView& view) {
    begin_rays(d, frame, cell, kPixelsOfCell, view.pixels);
    begin_rays(d, frame, cell, kNodesOfCell, view.nodes);
    for (std::size_t channel = 0; channel < 4; ++channel)
        cell.seen[channel].fill(channel == 3 ? 1.0f : 0.0f);
}

/// BlinnPhong::spread: no surfaces; the colours at most what is absorbed.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void spread(D d, const device::BlinnPhong& look, const CellRays& rays, std::size_t n,
                       const ReachedLanes<V>& reached, LightLanes<V>& light) {
    const double whole = look.ambient + look.diffuse;
    if (!(whole > 0)) return;
    const auto set = [&](double v) { return hn::Set(d, static_cast<float>(v)); };
    V body = hn::Mul(set(look.ambient / whole), reached.ambient);
    for (int k = 0; k < look.lights; ++k) {
        const auto& [to, strength] = look.light[k];
        V direct = hn::Mul(set(strength * look.diffuse / whole), reached.direct[k]);
        if (look.asymmetry != 0) {
            // BlinnPhong::phase
            const double g = look.asymmetry;
            const V along =
                hn::MulAdd(set(to.x), hn::Load(d, rays.right.data() + n),
                           hn::MulAdd(set(to.y), hn::Load(d, rays.down.data() + n), set(to.z)));
            const bool head = !(dot(to, to) > 0);
            const V cosine = head ? set(-1) : hn::Div(along, hn::Load(d, rays.length.data() + n));
            const V gap = hn::NegMulAdd(set(2 * g), cosine, set(1 + g * g));
            direct = hn::Mul(direct, hn::Div(set(1 - g * g), hn::Mul(gap, hn::Sqrt(gap))));
        }
        body = hn::Add(body, direct);
    }
    for (int c = 0; c < 3; ++c) light.c[c] = hn::Min(hn::Mul(light.c[c], body), light.c[3]);
}

/// x^power, 0 < x <= 1; by products where the power is a small integer, to 1e-9.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V power_of(D d, V x, double power) {
    auto left = static_cast<unsigned>(std::min(power, 255.0));
    if (static_cast<double>(left) != power)
        return hn::Exp(d, hn::Mul(hn::Set(d, static_cast<float>(power)), hn::Log(d, x)));
    // Without numbers so small that arithmetic is slow.
    const V least = hn::Set(d, 1e-9f);
    V product = hn::Set(d, 1.0f);
    for (; left != 0; left >>= 1, x = hn::Max(hn::Mul(x, x), least))
        if (left % 2 != 0) product = hn::Mul(product, x);
    return product;
}

/// BlinnPhong::shading, with the colours at most what is absorbed.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void shade(D d, const device::BlinnPhong& look, const V* gradient, const CellRays& rays,
                      std::size_t n, const ReachedLanes<V>& reached, LightLanes<V>& light) {
    const auto set = [&](double v) { return hn::Set(d, static_cast<float>(v)); };
    const auto dot3 = [&](const V* a, const V* b) {
        return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
    };
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), least = hn::Set(d, 1e-30f);
    const V per = hn::Div(hn::Set(d, -1.0f), hn::Load(d, rays.length.data() + n));
    const V eye[3] = {hn::Mul(per, hn::Load(d, rays.right.data() + n)),
                      hn::Mul(per, hn::Load(d, rays.down.data() + n)), per};
    const V steep2 = dot3(gradient, gradient);
    const auto any = hn::Gt(steep2, least);
    const V per_steep = hn::Div(one, hn::Sqrt(hn::Max(steep2, least)));
    const V turn = hn::CopySign(per_steep, dot3(gradient, eye));
    V body = hn::Mul(set(look.ambient), reached.ambient), shine = zero;
    for (int k = 0; k < look.lights; ++k) {
        const auto& [towards, strength] = look.light[k];
        V to[3] = {set(towards.x), set(towards.y), set(towards.z)};
        if (!(dot(towards, towards) > 0))
            for (int c = 0; c < 3; ++c) to[c] = eye[c];
        const V facing = hn::Max(hn::Mul(turn, dot3(gradient, to)), zero);
        V between[3];
        for (int c = 0; c < 3; ++c) between[c] = hn::Add(to[c], eye[c]);
        const V length_between = hn::Sqrt(hn::Max(dot3(between, between), least));
        const V mirrored =
            hn::Min(hn::Mul(turn, hn::Div(dot3(gradient, between), length_between)), one);
        body = hn::MulAdd(hn::Mul(set(strength * look.diffuse), facing), reached.direct[k], body);
        const V power = power_of(d, hn::Max(mirrored, set(1e-6)), look.power);
        const V more = hn::Mul(hn::Mul(set(strength * look.specular), power), reached.direct[k]);
        shine = hn::Add(
            shine, hn::IfThenElseZero(hn::And(hn::Gt(mirrored, zero), hn::Gt(facing, zero)), more));
    }
    LightLanes<V> plain = light;
    if (!hn::AllTrue(d, any)) spread(d, look, rays, n, reached, plain);
    for (int c = 0; c < 3; ++c) {
        const V shaded = hn::MulAdd(body, light.c[c], hn::Mul(shine, light.c[3]));
        light.c[c] = hn::IfThenElse(any, hn::Min(shaded, light.c[3]), plain.c[c]);
    }
}
