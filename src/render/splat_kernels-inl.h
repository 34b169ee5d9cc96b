// splat_kernels-inl.h: the loops themselves, for any vector width: included once per SIMD target by
// splat_kernels.cpp, inside its namespace. Lanes are Gaussians when projecting, pixels when adding.

constexpr double kSlackPixels =
    1e-4;  // a hair wider than exact; what lies outside adds zero anyway

/// First and last pixel centre at or beyond an image-plane position, in [0, size) or empty.
inline std::int32_t first_pixel(double low, int size) {
    return static_cast<std::int32_t>(std::ceil(std::clamp(low - kSlackPixels, 0.0, double(size))));
}
inline std::int32_t last_pixel(double high, int size) {
    return static_cast<std::int32_t>(std::floor(std::clamp(high + kSlackPixels, -1.0, size - 1.0)));
}

/// The exact segment form of Gaussian i; rare, so one at a time and over the whole image.
NearSplat near_splat(const Gaussians& gaussians, std::size_t i, const CameraFrame& frame) {
    const Mat3 w = whitening(gaussians, i);
    return {{0, frame.width - 1, 0, frame.height - 1},
            w * (vec_cast<double>(gaussians.mean[i]) - frame.eye),
            w * frame.corner,
            w * frame.step_x,
            w * frame.step_y,
            gaussians.density[i]};
}

/// Tags of the two loops: as wide as the target, or one lane.
struct WideLanes {
    using Doubles = hn::ScalableTag<double>;
    using Floats = hn::CappedTag<float, TilePixels::kMaxLanes>;
};
struct OneLane {
    using Doubles = hn::CappedTag<double, 1>;
    using Floats = hn::CappedTag<float, 1>;
};

/// One vector per component.
template <class V>
struct Lanes3 {
    V x, y, z;
};
template <class V>
HWY_INLINE V dot(const Lanes3<V>& a, const Lanes3<V>& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
template <class V>
HWY_INLINE Lanes3<V> times(const Lanes3<V>& a, const Lanes3<V>& b) {
    return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}

/// What projection takes from the model, one array per field so that lanes load at once.
template <int kLanes>
struct ProjectionInput {
    alignas(64) double mean[3][kLanes], scale[3][kLanes], rotation[4][kLanes], density[kLanes];
};

/// What it gives, in image order of the fields of FarSplat.
template <int kLanes>
struct ProjectionOutput {
    alignas(64) double x_low[kLanes], x_high[kLanes], y_low[kLanes], y_high[kLanes];
    alignas(64) double mean_x[kLanes], mean_y[kLanes];
    alignas(64) double ax[kLanes], ay[kLanes], by2[kLanes];
    alignas(64) double c0[kLanes], cx[kLanes], cy[kLanes], d0[kLanes], dy[kLanes], e02[kLanes];
    alignas(64) double weight[kLanes];
    alignas(64) double state[kLanes];  ///< kFar, kNear, or 0 for neither
};
constexpr double kFar = 1, kNear = 2;

/// Own axes of the Gaussians along one world direction: rows of Rᵀ times it.
template <class V>
struct OwnAxes {
    Lanes3<V> row[3];
    template <class D>
    HWY_INLINE Lanes3<V> operator()(D d, Vec3d world) const {
        const V x = hn::Set(d, world.x), y = hn::Set(d, world.y), z = hn::Set(d, world.z);
        const Lanes3<V> w{x, y, z};
        return {dot(row[0], w), dot(row[1], w), dot(row[2], w)};
    }
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE OwnAxes<V> own_axes(D d, V w, V x, V y, V z) {
    // The columns of matrix_from_quat, for a quaternion of any length.
    const V one = hn::Set(d, 1.0);
    const V norm2 = hn::MulAdd(w, w, hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
    const V s = hn::Div(hn::Set(d, 2.0), norm2);
    const V xs = hn::Mul(x, s), ys = hn::Mul(y, s), zs = hn::Mul(z, s);
    const V xx = hn::Mul(x, xs), yy = hn::Mul(y, ys), zz = hn::Mul(z, zs);
    const V xy = hn::Mul(x, ys), xz = hn::Mul(x, zs), yz = hn::Mul(y, zs);
    const V wx = hn::Mul(w, xs), wy = hn::Mul(w, ys), wz = hn::Mul(w, zs);
    return {{{hn::Sub(one, hn::Add(yy, zz)), hn::Add(xy, wz), hn::Sub(xz, wy)},
             {hn::Sub(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Add(yz, wx)},
             {hn::Add(xz, wy), hn::Sub(yz, wx), hn::Sub(one, hn::Add(xx, yy))}}};
}

/// Projects one vector of Gaussians.
template <class D, int kLanes>
HWY_INLINE void project_lanes(D d, const ProjectionInput<kLanes>& in, bool rotated, double cutoff,
                              const CameraFrame& frame, ProjectionOutput<kLanes>& out) {
    using V = hn::Vec<D>;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const Lanes3<V> scale{hn::Load(d, in.scale[0]), hn::Load(d, in.scale[1]),
                          hn::Load(d, in.scale[2])};
    const Lanes3<V> inverse_scale{hn::Div(one, scale.x), hn::Div(one, scale.y),
                                  hn::Div(one, scale.z)};
    const Lanes3<V> p{hn::Sub(hn::Load(d, in.mean[0]), hn::Set(d, frame.eye.x)),
                      hn::Sub(hn::Load(d, in.mean[1]), hn::Set(d, frame.eye.y)),
                      hn::Sub(hn::Load(d, in.mean[2]), hn::Set(d, frame.eye.z))};
    const auto along = [&](Vec3d axis) {
        return dot(p, Lanes3<V>{hn::Set(d, axis.x), hn::Set(d, axis.y), hn::Set(d, axis.z)});
    };
    const V right = along(frame.right), up = along(frame.up), forward = along(frame.forward);

    // Camera axes in the Gaussians' own axes: times the scales their dot products are covariances,
    // divided by the scales they are whitened.
    Lanes3<V> axis_r, axis_u, axis_f;
    if (rotated) {
        const OwnAxes<V> own = own_axes(d, hn::Load(d, in.rotation[0]), hn::Load(d, in.rotation[1]),
                                        hn::Load(d, in.rotation[2]), hn::Load(d, in.rotation[3]));
        axis_r = own(d, frame.right), axis_u = own(d, frame.up), axis_f = own(d, frame.forward);
    } else {
        const auto set = [&](Vec3d v) {
            return Lanes3<V>{hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
        };
        axis_r = set(frame.right), axis_u = set(frame.up), axis_f = set(frame.forward);
    }
    const V k2 = hn::Set(d, cutoff * cutoff);
    const Lanes3<V> spread_r = times(axis_r, scale), spread_u = times(axis_u, scale),
                    spread_f = times(axis_f, scale);
    const V rr = hn::Mul(k2, dot(spread_r, spread_r)), uu = hn::Mul(k2, dot(spread_u, spread_u));
    const V ff = hn::Mul(k2, dot(spread_f, spread_f));
    const V rf = hn::Mul(k2, dot(spread_r, spread_f)), uf = hn::Mul(k2, dot(spread_u, spread_f));

    // Outside: behind the eye plane, or beyond one of the four sides of the view: the plane
    // slope · forward - sign · across = 0, and the support's reach along its normal.
    const V reach = hn::Sqrt(ff);
    auto outside = hn::Le(hn::Add(forward, reach), zero);
    const auto beyond = [&](double slope, V across, V aa, V af, double sign) {
        const V s = hn::Set(d, slope);
        const V distance = hn::NegMulAdd(hn::Set(d, sign), across, hn::Mul(s, forward));
        const V reach2 = hn::MulAdd(s, hn::NegMulAdd(hn::Set(d, 2 * sign), af, hn::Mul(s, ff)), aa);
        return hn::And(hn::Lt(distance, zero), hn::Gt(hn::Mul(distance, distance), reach2));
    };
    const double side_x = 0.5 * frame.width / frame.pixels_per_unit;
    const double side_y = 0.5 * frame.height / frame.pixels_per_unit;
    outside = hn::Or(outside,
                     hn::Or(beyond(side_x, right, rr, rf, 1), beyond(side_x, right, rr, rf, -1)));
    outside =
        hn::Or(outside, hn::Or(beyond(side_y, up, uu, uf, 1), beyond(side_y, up, uu, uf, -1)));

    // Exact screen bounds: the slopes s of planes through the eye that touch the ellipsoid solve
    // s² (p_f² - ff) - 2 s (p_a p_f - af) + (p_a² - aa) = 0.
    const V ppu = hn::Set(d, frame.pixels_per_unit);
    const V leading = hn::Sub(hn::Mul(forward, forward), ff);
    const V pixels_over_leading = hn::Div(ppu, leading);
    const auto tangents = [&](V across, V aa, V af, V& center, V& half) {
        const V b = hn::Sub(hn::Mul(across, forward), af);
        const V c = hn::Sub(hn::Mul(across, across), aa);
        const V root = hn::Sqrt(hn::Max(zero, hn::NegMulAdd(leading, c, hn::Mul(b, b))));
        center = hn::Mul(b, pixels_over_leading);
        half = hn::Mul(root, pixels_over_leading);
    };
    const V middle_x = hn::Set(d, 0.5 * (frame.width - 1)),
            middle_y = hn::Set(d, 0.5 * (frame.height - 1));
    V center, half;
    tangents(right, rr, rf, center, half);
    hn::Store(hn::Add(middle_x, hn::Sub(center, half)), d, out.x_low);
    hn::Store(hn::Add(middle_x, hn::Add(center, half)), d, out.x_high);
    tangents(up, uu, uf, center, half);  // rows grow downwards
    hn::Store(hn::Sub(middle_y, hn::Add(center, half)), d, out.y_low);
    hn::Store(hn::Sub(middle_y, hn::Sub(center, half)), d, out.y_high);

    const V inverse_forward = hn::Div(one, forward);
    const V mean_x = hn::MulAdd(ppu, hn::Mul(right, inverse_forward), middle_x);
    const V mean_y = hn::NegMulAdd(ppu, hn::Mul(up, inverse_forward), middle_y);
    hn::Store(mean_x, d, out.mean_x);
    hn::Store(mean_y, d, out.mean_y);

    // Far enough: clear of the eye plane, so that the slopes stay finite, and a pixel position.
    constexpr double kInFront = 1.01, kMaxPixel = 1e8;
    const V max_pixel = hn::Set(d, kMaxPixel);
    const auto is_far =
        hn::And(hn::Ge(forward, hn::Mul(hn::Set(d, kInFront), reach)),
                hn::And(hn::Lt(hn::Abs(mean_x), max_pixel), hn::Lt(hn::Abs(mean_y), max_pixel)));
    const V state = hn::IfThenElse(is_far, hn::Set(d, kFar), hn::Set(d, kNear));
    hn::Store(hn::IfThenElseZero(hn::Not(outside), state), d, out.state);

    // Gram matrix of the whitened steps of one pixel and the direction c through the mean.
    const double pixel = 1 / frame.pixels_per_unit;
    const Lanes3<V> step_x{hn::Set(d, pixel), hn::Set(d, pixel), hn::Set(d, pixel)};
    const Lanes3<V> step_y{hn::Set(d, -pixel), hn::Set(d, -pixel), hn::Set(d, -pixel)};
    const Lanes3<V> x = times(times(axis_r, inverse_scale), step_x);
    const Lanes3<V> y = times(times(axis_u, inverse_scale), step_y);
    const V sx = hn::Mul(right, inverse_forward), sy = hn::Mul(up, inverse_forward);
    const auto direction = [&](V r, V u, V f, V inverse) {
        return hn::Mul(hn::MulAdd(sx, r, hn::MulAdd(sy, u, f)), inverse);
    };
    const Lanes3<V> c{direction(axis_r.x, axis_u.x, axis_f.x, inverse_scale.x),
                      direction(axis_r.y, axis_u.y, axis_f.y, inverse_scale.y),
                      direction(axis_r.z, axis_u.z, axis_f.z, inverse_scale.z)};
    const V cc = dot(c, c), inverse_cc = hn::Div(one, cc);
    // Scaled to |c| = 1.
    const V norm = hn::Sqrt(inverse_cc);
    const V xx = hn::Mul(dot(x, x), inverse_cc), xy = hn::Mul(dot(x, y), inverse_cc);
    const V yy = hn::Mul(dot(y, y), inverse_cc);
    const V xc = hn::Mul(dot(x, c), inverse_cc), yc = hn::Mul(dot(y, c), inverse_cc);

    // m² C: |e|² times the Gram matrix of the steps' parts across c, in triangular form.
    const V e2 = hn::Mul(hn::Mul(forward, forward), cc);
    const V across_xx = hn::NegMulAdd(xc, xc, xx), across_xy = hn::NegMulAdd(xc, yc, xy);
    const V across_yy = hn::NegMulAdd(yc, yc, yy);
    const V slope = hn::Div(across_xy, across_xx);
    const V ax = hn::Sqrt(hn::Mul(e2, across_xx));
    hn::Store(ax, d, out.ax);
    hn::Store(hn::Mul(ax, slope), d, out.ay);
    hn::Store(hn::Max(zero, hn::Mul(e2, hn::NegMulAdd(slope, across_xy, across_yy))), d, out.by2);

    // C: Cholesky of the Gram matrix of (x, y, c).
    const V cx = hn::Sqrt(xx), inverse_cx = hn::Div(one, cx);
    const V cy = hn::Mul(xy, inverse_cx), c0 = hn::Mul(xc, inverse_cx);
    const V dy = hn::Sqrt(hn::NegMulAdd(cy, cy, yy));
    const V d0 = hn::Div(hn::NegMulAdd(cy, c0, yc), dy);
    hn::Store(cx, d, out.cx);
    hn::Store(cy, d, out.cy);
    hn::Store(c0, d, out.c0);
    hn::Store(dy, d, out.dy);
    hn::Store(d0, d, out.d0);
    hn::Store(hn::Max(zero, hn::NegMulAdd(d0, d0, hn::NegMulAdd(c0, c0, one))), d, out.e02);
    hn::Store(hn::Mul(hn::Load(d, in.density), norm), d, out.weight);
}

template <class Tags>
void project(const Gaussians& gaussians, std::size_t first, std::size_t last,
             const CameraFrame& frame, Splats& splats) {
    const typename Tags::Doubles d;
    constexpr int kLanes = TilePixels::kMaxLanes / 2;  // doubles in the widest vector
    ProjectionInput<kLanes> in;
    ProjectionOutput<kLanes> out;
    const bool rotated = !gaussians.axis_aligned();
    const auto lanes = hn::Lanes(d);
    for (std::size_t block = first; block < last; block += lanes) {
        // The last block repeats its last Gaussian in the spare lanes.
        for (std::size_t n = 0; n < lanes; ++n) {
            const std::size_t i = std::min(block + n, last - 1);
            for (int axis = 0; axis < 3; ++axis) {
                in.mean[axis][n] = gaussians.mean[i][axis];
                in.scale[axis][n] = gaussians.scale[i][axis];
            }
            if (rotated) {
                const Quat q = gaussians.rotation[i];
                in.rotation[0][n] = q.w, in.rotation[1][n] = q.x, in.rotation[2][n] = q.y,
                in.rotation[3][n] = q.z;
            }
            in.density[n] = gaussians.density[i];
        }
        project_lanes(d, in, rotated, gaussians.cutoff, frame, out);
        for (std::size_t n = 0; n < std::min<std::size_t>(lanes, last - block); ++n) {
            if (out.state[n] == kNear)
                splats.near.push_back(near_splat(gaussians, block + n, frame));
            if (out.state[n] != kFar) continue;
            FarSplat s;
            s.bounds.x0 = first_pixel(out.x_low[n], frame.width);
            s.bounds.x1 = last_pixel(out.x_high[n], frame.width);
            s.bounds.y0 = first_pixel(out.y_low[n], frame.height);
            s.bounds.y1 = last_pixel(out.y_high[n], frame.height);
            if (s.bounds.empty()) continue;
            // The projected mean as whole pixel and rest: offsets keep full precision anywhere.
            s.column = static_cast<std::int32_t>(std::floor(out.mean_x[n] + 0.5));
            s.row = static_cast<std::int32_t>(std::floor(out.mean_y[n] + 0.5));
            s.offset_x = static_cast<float>(out.mean_x[n] - s.column);
            s.offset_y = static_cast<float>(out.mean_y[n] - s.row);
            s.ax = static_cast<float>(out.ax[n]);
            s.ay = static_cast<float>(out.ay[n]);
            s.by2 = static_cast<float>(out.by2[n]);
            s.c0 = static_cast<float>(out.c0[n]);
            s.cx = static_cast<float>(out.cx[n]);
            s.cy = static_cast<float>(out.cy[n]);
            s.d0 = static_cast<float>(out.d0[n]);
            s.dy = static_cast<float>(out.dy[n]);
            s.e02 = static_cast<float>(out.e02[n]);
            s.weight = static_cast<float>(out.weight[n]);
            splats.far.push_back(s);
        }
    }
}

/// One row of one splat: pixels x0 ... x1 of `depth`, in vectors that may run past x1: there m² >=
/// k² and nothing is added. kDegree < 0: any degree, read from the kernel.
template <int kDegree, class D>
HWY_INLINE void add_row(D d, const FarSplat& s, const KernelPolynomial& kernel, float x_first,
                        float y, int x0, int x1, const float* HWY_RESTRICT slant2,
                        float* HWY_RESTRICT depth) {
    using V = hn::Vec<D>;
    // m² C = (ax x + q)² + r and C = (cx x + p)² + n along this row.
    const V q = hn::Set(d, s.ay * y), r = hn::Set(d, s.by2 * y * y);
    const float across = s.d0 + s.dy * y;
    const V p = hn::Set(d, s.c0 + s.cy * y), n = hn::Set(d, across * across + s.e02);
    const V ax = hn::Set(d, s.ax), cx = hn::Set(d, s.cx);
    const V k2 = hn::Set(d, kernel.cutoff2), to_v = hn::Set(d, -2 / kernel.cutoff2);
    const V one = hn::Set(d, 1.0f), weight = hn::Set(d, s.weight);
    const auto lanes = static_cast<int>(hn::Lanes(d));
    V x = hn::Add(hn::Iota(d, static_cast<float>(x0)), hn::Set(d, x_first));
    const V step = hn::Set(d, static_cast<float>(lanes));
    for (int column = x0; column <= x1; column += lanes) {
        const V a = hn::MulAdd(ax, x, q), c = hn::MulAdd(cx, x, p);
        const V inverse_c = hn::Div(one, hn::MulAdd(c, c, n));
        const V m2 = hn::Min(k2, hn::Mul(hn::MulAdd(a, a, r), inverse_c));
        const V v = hn::MulAdd(m2, to_v, one);
        const int degree = kDegree < 0 ? static_cast<int>(kernel.coefficient.size()) - 1 : kDegree;
        V sum = hn::Set(d, kernel.coefficient[static_cast<std::size_t>(degree)]);
        for (int power = degree - 1; power >= 0; --power)
            sum =
                hn::MulAdd(sum, v, hn::Set(d, kernel.coefficient[static_cast<std::size_t>(power)]));
        const V root =
            hn::Sqrt(hn::Mul(hn::Mul(hn::Sub(k2, m2), inverse_c), hn::LoadU(d, slant2 + column)));
        // The fit's error must not make T negative.
        const V tau = hn::Mul(hn::Mul(weight, root), hn::Max(sum, hn::Zero(d)));
        hn::StoreU(hn::Add(hn::LoadU(d, depth + column), tau), d, depth + column);
        x = hn::Add(x, step);
    }
}

template <int kDegree, class Tags>
void add_far_degree(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
                    const KernelPolynomial& kernel, TilePixels& tile) {
    const typename Tags::Floats d;
    constexpr std::size_t kAhead = 8;  // splats of a tile lie apart in memory
    for (std::size_t n = 0; n < count; ++n) {
        if (n + kAhead < count) {
            const char* ahead = reinterpret_cast<const char*>(splats + index[n + kAhead]);
            hwy::Prefetch(ahead);
            hwy::Prefetch(ahead + 64);
        }
        const FarSplat& s = splats[index[n]];
        const int y0 = std::max(s.bounds.y0 - tile.row, 0);
        const int y1 = std::min(s.bounds.y1 - tile.row, kTileHeight - 1);
        const int x0 = std::max(s.bounds.x0 - tile.column, 0);
        const int x1 = std::min(s.bounds.x1 - tile.column, kTileWidth - 1);
        const float x_first = static_cast<float>(tile.column - s.column) - s.offset_x;
        for (int y = y0; y <= y1; ++y)
            add_row<kDegree>(d, s, kernel, x_first,
                             static_cast<float>(tile.row + y - s.row) - s.offset_y, x0, x1,
                             tile.slant2[y], tile.depth[y]);
    }
}

template <class Tags>
void add_far(const FarSplat* splats, const std::uint32_t* index, std::size_t count,
             const KernelPolynomial& kernel, TilePixels& tile) {
    // The degrees of the default cutoff and the paper's are unrolled.
    switch (kernel.coefficient.size() - 1) {
        case 6:
            return add_far_degree<6, Tags>(splats, index, count, kernel, tile);
        case 8:
            return add_far_degree<8, Tags>(splats, index, count, kernel, tile);
        default:
            return add_far_degree<-1, Tags>(splats, index, count, kernel, tile);
    }
}

const SplatKernels& wide_kernels() {
    static const SplatKernels kernels{HWY_TARGET, project<WideLanes>, add_far<WideLanes>};
    return kernels;
}

const SplatKernels& one_lane_kernels() {
    static const SplatKernels kernels{0, project<OneLane>, add_far<OneLane>};
    return kernels;
}
