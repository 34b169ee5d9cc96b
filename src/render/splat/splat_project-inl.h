// splat_project-inl.h: Projection of Gaussians to splats, one SIMD vector of Gaussians at a time, in
// double precision. Included once per SIMD target by splat_kernels.cpp, inside its namespace.
//
// With the camera's axes r, u, f, p the mean seen from the eye and S the covariance, a plane
// through the eye is tangent to the support when p pᵀ - k² S vanishes on its normal: the dual conic
// of the outline. Its centre and shape in slopes (x along r, y along u):
//   L       = p_f² - k² S_ff                                    > 0: clear of the eye plane
//   centre  = (p_r p_f - k² S_rf, p_u p_f - k² S_uf) / L
//   shape   = [k² T_xᵀ S T_y - (k² S_xy k² S_ff - k² S_xf k² S_yf)] / L²,  T_x = p_f r - p_r f, ...
// Parallel rays are the limit of a far eye, with slopes times its distance as world units: L = 1, centre
// (p_r, p_u), shape k² S_xy, and (|e|² - k²) / L becomes C, the same for all pixels.
// in which the large terms of the textbook form have been cancelled by hand. The determinant of the
// shape is k⁴ det(S) (|e|² - k²) / L³, and F at the centre is k² (|e|² - k²) / L.

/// Margin of the pixel bounds, pixels; pixels outside the support add 0.
constexpr double kSlackPixels = 1e-4;
/// Limits of a far splat: depth over extent, so that slopes stay finite, and pixel coordinate.
constexpr double kInFront = 1.01, kMaxPixel = 1e8;
/// Smallest T of a splat, in units of the model: below, C leaves the range of float.
constexpr double kFaintest = 1e-15;

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
/// a s + b t
template <class V>
HWY_INLINE Lanes3<V> combine(const Lanes3<V>& a, V s, const Lanes3<V>& b, V t) {
    return {hn::MulAdd(a.x, s, hn::Mul(b.x, t)), hn::MulAdd(a.y, s, hn::Mul(b.y, t)),
            hn::MulAdd(a.z, s, hn::Mul(b.z, t))};
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE Lanes3<V> set3(D d, Vec3d v) {
    return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

/// Own axes of the Gaussians along one world direction: rows of Rᵀ times it.
template <class V>
struct OwnAxes {
    Lanes3<V> row[3];
    template <class D>
    HWY_INLINE Lanes3<V> operator()(D d, Vec3d world) const {
        const Lanes3<V> w = set3(d, world);
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

/// The camera's axes in the Gaussians' own axes.
template <class V>
struct CameraAxes {
    Lanes3<V> right, up, forward;
};

/// A mask as bits, lane 0 lowest.
template <class D, class M = hn::Mask<D>>
HWY_INLINE std::size_t lane_bits(D d, M mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return bits[0];  // at most 8 doubles
}

/// First of the fields of one vector of Gaussians; scalars as the model stores them.
struct ProjectionInput {
    const float *mean, *scale, *rotation, *density;  ///< rotation: nullptr if axis-aligned
};

template <class D, class DF = hn::Rebind<float, D>, class V = hn::Vec<D>>
HWY_INLINE Lanes3<V> load3(D d, const float* from) {
    const DF df;
    hn::Vec<DF> x, y, z;
    hn::LoadInterleaved3(df, from, x, y, z);
    return {hn::PromoteTo(d, x), hn::PromoteTo(d, y), hn::PromoteTo(d, z)};
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE CameraAxes<V> camera_axes(D d, const ProjectionInput& in, const CameraFrame& frame) {
    if (in.rotation == nullptr)
        return {set3(d, frame.right), set3(d, frame.up), set3(d, frame.forward)};
    const hn::Rebind<float, D> df;
    hn::Vec<decltype(df)> w, x, y, z;
    hn::LoadInterleaved4(df, in.rotation, w, x, y, z);
    const OwnAxes<V> own = own_axes(d, hn::PromoteTo(d, w), hn::PromoteTo(d, x),
                                    hn::PromoteTo(d, y), hn::PromoteTo(d, z));
    return {own(d, frame.right), own(d, frame.up), own(d, frame.forward)};
}

/// Gaussians as the forms need them. Spreads, of which dot products are covariances, and whitened
/// directions are in the Gaussians' own axes.
template <class V>
struct Shape {
    Lanes3<V> spread_r, spread_u, spread_f;       ///< camera's axes times the scales
    Lanes3<V> right_over, up_over, forward_over;  ///< over the scales and the peak
    V peak, volume;                               ///< in SplatModel::unit; product of scales
    V inverse_peak_volume;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE Shape<V> shape_of(D d, const CameraAxes<V>& axes, const Lanes3<V>& scale, V peak) {
    const V volume = hn::Mul(scale.x, hn::Mul(scale.y, scale.z));
    const V inverse_peak_volume = hn::Div(hn::Set(d, 1.0), hn::Mul(peak, volume));
    const Lanes3<V> whiten{hn::Mul(hn::Mul(scale.y, scale.z), inverse_peak_volume),
                           hn::Mul(hn::Mul(scale.x, scale.z), inverse_peak_volume),
                           hn::Mul(hn::Mul(scale.x, scale.y), inverse_peak_volume)};
    return {times(axes.right, scale),
            times(axes.up, scale),
            times(axes.forward, scale),
            times(axes.right, whiten),
            times(axes.up, whiten),
            times(axes.forward, whiten),
            peak,
            volume,
            inverse_peak_volume};
}

#include "render/splat/splat_widen-inl.h"

/// The splats of one vector of Gaussians, each as four groups of four 32-bit fields: what a
/// FarSplat's 64 bytes are.
template <std::size_t kLanes>
struct ProjectionOutput {
    alignas(64) float group[4][4 * kLanes];
    std::size_t far = 0, other = 0;  ///< bit n: Gaussian n is a far splat; may be a near splat
    std::size_t widened = 0;         ///< bit n: Gaussian n is drawn wider than it is
};

/// Pixel bounds of intervals, as two 16-bit halves of 32 bits; `some` marks those with a pixel.
template <class D, class V, class DI = hn::Rebind<std::int32_t, D>>
HWY_INLINE hn::Vec<DI> pixel_interval(D d, V center, V half, int size, hn::Mask<D>& some) {
    const V slack = hn::Set(d, kSlackPixels), zero = hn::Zero(d);
    const V low = hn::Ceil(hn::Max(zero, hn::Sub(hn::Sub(center, half), slack)));
    const V high =
        hn::Floor(hn::Min(hn::Set(d, size - 1.0), hn::Add(hn::Add(center, half), slack)));
    some = hn::Le(low, high);
    // Empty intervals may exceed 16 bits; they are never read.
    const V last = hn::Set(d, size - 1.0);
    const DI di;
    const auto low16 = hn::DemoteTo(di, hn::Min(low, last));
    const auto high16 = hn::DemoteTo(di, hn::Max(high, zero));
    return hn::Or(low16, hn::ShiftLeft<16>(high16));
}

/// Projects one vector of Gaussians.
/// kParallel  for an orthographic camera
template <bool kParallel, class D, std::size_t kLanes>
HWY_INLINE void project_lanes(D d, const ProjectionInput& in, const SplatModel& model,
                              const CameraFrame& frame, ProjectionOutput<kLanes>& out) {
    using V = hn::Vec<D>;
    const double cutoff = model.cutoff, unit = model.unit;
    const hn::Rebind<float, D> df;
    const hn::Rebind<std::int32_t, D> di;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const V k2 = hn::Set(d, cutoff * cutoff), ppu = hn::Set(d, frame.pixels_per_unit);
    const V pixel = hn::Set(d, 1 / frame.pixels_per_unit);

    // The mean from the eye, the camera's axes times the scales: their dot products are
    // covariances.
    const Lanes3<V> mean = load3(d, in.mean), scale = load3(d, in.scale);
    const Lanes3<V> eye = set3(d, frame.eye);
    const Lanes3<V> p{hn::Sub(mean.x, eye.x), hn::Sub(mean.y, eye.y), hn::Sub(mean.z, eye.z)};
    const V right = dot(p, set3(d, frame.right)), up = dot(p, set3(d, frame.up));
    const V forward = dot(p, set3(d, frame.forward));
    const V density = hn::Mul(hn::PromoteTo(d, hn::LoadU(df, in.density)), hn::Set(d, 1 / unit));
    const CameraAxes<V> axes = camera_axes(d, in, frame);
    Shape<V> shape = shape_of(d, axes, scale, density);
    const V own_reach = hn::Mul(hn::Set(d, cutoff), hn::Sqrt(dot(shape.spread_f, shape.spread_f)));
    const V max_pixel = hn::Set(d, kMaxPixel);
    const auto in_front = hn::Ge(forward, hn::Mul(hn::Set(d, kInFront), own_reach));
    const MeanPoint<V> at =
        kParallel ? MeanPoint<V>{zero, zero, ppu, zero} : mean_point(d, right, up, forward, ppu);
    const V least_variance = widen(d, at, model.limits, in_front, axes, scale, shape);
    const auto& [spread_r, spread_u, spread_f, right_over, up_over, forward_over, peak, volume,
                 inverse_peak_volume] = shape;
    const V sff = dot(spread_f, spread_f), depth_spread = hn::Sqrt(sff);
    const V reach = hn::Mul(hn::Set(d, cutoff), depth_spread);
    const V rf = hn::Mul(k2, dot(spread_r, spread_f)), uf = hn::Mul(k2, dot(spread_u, spread_f));
    const V rr = hn::Mul(k2, dot(spread_r, spread_r)), uu = hn::Mul(k2, dot(spread_u, spread_u));
    const V ru = hn::Mul(k2, dot(spread_r, spread_u)), ff = hn::Mul(k2, sff);

    // Centre and shape of the outline. Parallel rays: the mean and k² S across the view, L = 1.
    V leading = one, inverse_leading = one, center_r = right, center_u = up;
    V shape_xx = rr, shape_xy = ru, shape_yy = uu;
    if constexpr (!kParallel) {
        leading = hn::NegMulAdd(ff, one, hn::Mul(forward, forward));
        inverse_leading = hn::Div(one, leading);
        center_r = hn::Mul(hn::MulSub(right, forward, rf), inverse_leading);
        center_u = hn::Mul(hn::MulSub(up, forward, uf), inverse_leading);
        const Lanes3<V> tx = combine(spread_r, forward, spread_f, hn::Neg(right));
        const Lanes3<V> ty = combine(spread_u, forward, spread_f, hn::Neg(up));
        shape_xx = hn::MulAdd(k2, dot(tx, tx), hn::MulSub(rf, rf, hn::Mul(rr, ff)));
        shape_xy = hn::MulAdd(k2, dot(tx, ty), hn::MulSub(rf, uf, hn::Mul(ru, ff)));
        shape_yy = hn::MulAdd(k2, dot(ty, ty), hn::MulSub(uf, uf, hn::Mul(uu, ff)));
    }
    const V to_pixels = hn::Mul(ppu, inverse_leading);
    const V root_yy = hn::Sqrt(shape_yy);
    const V half_x = hn::Mul(hn::Sqrt(shape_xx), to_pixels), half_y = hn::Mul(root_yy, to_pixels);
    const AxisPixel axis = axis_pixel(frame);
    const V center_x = hn::MulAdd(ppu, center_r, hn::Set(d, axis.column));
    const V center_y = hn::NegMulAdd(ppu, center_u, hn::Set(d, axis.row));
    hn::Mask<D> some_x, some_y;
    const auto x_bounds = pixel_interval(d, center_x, half_x, frame.width, some_x);
    const auto y_bounds = pixel_interval(d, center_y, half_y, frame.height, some_y);

    const V limit = hn::Max(hn::Abs(center_x), hn::Abs(center_y));
    const auto is_far = hn::And(in_front, hn::Lt(limit, max_pixel));
    // Along the ray through the mean: from the eye to the mean, or for parallel rays one world unit.
    const Lanes3<V> e =
        kParallel
            ? forward_over
            : Lanes3<V>{hn::MulAdd(right, right_over.x,
                                   hn::MulAdd(up, up_over.x, hn::Mul(forward, forward_over.x))),
                        hn::MulAdd(right, right_over.y,
                                   hn::MulAdd(up, up_over.y, hn::Mul(forward, forward_over.y))),
                        hn::MulAdd(right, right_over.z,
                                   hn::MulAdd(up, up_over.z, hn::Mul(forward, forward_over.z)))};
    const V inverse_peak = hn::Mul(inverse_peak_volume, volume);
    const V e2 = dot(e, e);  // |e|² / peak²
    // Over the peak and in the distance's unit: T at the mean is about peak forward / |e|.
    const V length = kParallel ? one : forward;
    const auto shows =
        hn::And(hn::Ge(hn::Mul(length, length), hn::Mul(hn::Set(d, kFaintest * kFaintest), e2)),
                hn::Gt(peak, zero));
    const auto seen = hn::And(hn::And(some_x, some_y), shows);
    out.far = lane_bits(d, hn::And(is_far, seen));
    const auto ahead = hn::Gt(hn::Add(forward, reach), zero);
    out.other = lane_bits(d, hn::AndNot(is_far, hn::And(ahead, hn::Gt(peak, zero))));
    if (out.far == 0) return;
    out.widened = lane_bits(d, hn::Le(least_variance, hn::Set(d, model.limits.least2)));

    // F: with everything over the peak squared.
    const V inverse_yy = hn::Div(one, shape_yy);
    // |e|² - k²; for parallel rays C.
    const V outside = kParallel ? e2 : hn::NegMulAdd(k2, hn::Mul(inverse_peak, inverse_peak), e2);
    const V f0 = hn::Mul(hn::Mul(k2, outside), inverse_leading);
    const V inverse_k = hn::Set(d, 1 / cutoff);
    const V ax = hn::Mul(hn::Mul(root_yy, hn::Mul(inverse_k, pixel)), inverse_peak_volume);
    const V ay = hn::Mul(ax, hn::Mul(shape_xy, inverse_yy));  // rows grow down: -(-)
    const V by =
        hn::Mul(hn::Sqrt(hn::Mul(hn::Mul(k2, outside), hn::Mul(leading, inverse_yy))), pixel);

    // C, for parallel rays e02 alone: Gram-Schmidt on the steps of one pixel and the direction through the centre. The length of
    // the steps' cross product is spread_f over the volume.
    const V xx = dot(right_over, right_over), xy = dot(right_over, up_over);
    const V length_x = hn::Sqrt(xx), inverse_x = hn::Div(one, length_x);
    const Lanes3<V> c{
        hn::MulAdd(center_r, right_over.x, hn::MulAdd(center_u, up_over.x, forward_over.x)),
        hn::MulAdd(center_r, right_over.y, hn::MulAdd(center_u, up_over.y, forward_over.y)),
        hn::MulAdd(center_r, right_over.z, hn::MulAdd(center_u, up_over.z, forward_over.z))};
    const V along = hn::Mul(xy, inverse_x);  // up_over along right_over
    const V shear = hn::Neg(hn::Mul(along, inverse_x));
    const Lanes3<V> across = {hn::MulAdd(right_over.x, shear, up_over.x),
                              hn::MulAdd(right_over.y, shear, up_over.y),
                              hn::MulAdd(right_over.z, shear, up_over.z)};
    const V inverse_ff = hn::Div(one, sff);
    const V cross = hn::Mul(hn::Mul(depth_spread, inverse_peak_volume), inverse_peak);
    const V length_y = hn::Mul(cross, inverse_x);
    // 1 / length_y = length_x / cross, and 1 / cross = peak² volume / spread_f.
    const V inverse_cross =
        hn::Mul(hn::Mul(hn::Mul(peak, peak), volume), hn::Mul(depth_spread, inverse_ff));
    const V d_center = kParallel ? zero : hn::Mul(dot(c, across), hn::Mul(length_x, inverse_cross));
    const V e02 = kParallel ? e2 : hn::Mul(inverse_ff, hn::Mul(inverse_peak, inverse_peak));
    const V c_center = kParallel ? zero : hn::Mul(dot(c, right_over), inverse_x);
    const V cx = kParallel ? zero : hn::Mul(length_x, pixel);
    const V cy = kParallel ? zero : hn::Neg(hn::Mul(along, pixel));
    const V dy = kParallel ? zero : hn::Neg(hn::Mul(length_y, pixel));

    // The centre as whole pixel and rest: offsets keep full precision anywhere.
    const V half = hn::Set(d, 0.5);
    const V column =
        hn::Floor(hn::Add(hn::Min(hn::Max(center_x, hn::Neg(max_pixel)), max_pixel), half));
    const V row =
        hn::Floor(hn::Add(hn::Min(hn::Max(center_y, hn::Neg(max_pixel)), max_pixel), half));
    const V ox = hn::Sub(center_x, column), oy = hn::Sub(center_y, row);
    const V a0 = hn::Neg(hn::MulAdd(ax, ox, hn::Mul(ay, oy)));
    const V b0 = hn::Neg(hn::Mul(by, oy));
    const V c0 = hn::NegMulAdd(cx, ox, hn::NegMulAdd(cy, oy, c_center));
    const V d0 = hn::NegMulAdd(dy, oy, d_center);

    SplatForms<V> forms{ax, ay, a0, by, b0, f0, cx, cy, c0, dy, d0, e02};
    normalize_small(d, model, at, half_x, half_y, shape, least_variance, hn::And(is_far, seen),
                    forms);
    const auto f = [&](V v) { return hn::DemoteTo(df, v); };
    const auto bits = [&](V v) { return hn::BitCast(df, hn::DemoteTo(di, v)); };
    hn::StoreInterleaved4(bits(column), bits(row), f(forms.ax), f(forms.ay), df, out.group[0]);
    hn::StoreInterleaved4(f(forms.a0), f(forms.by), f(forms.b0), f(forms.f0), df, out.group[1]);
    hn::StoreInterleaved4(f(forms.cx), f(forms.cy), f(forms.c0), f(forms.dy), df, out.group[2]);
    hn::StoreInterleaved4(f(forms.d0), f(forms.e02), hn::BitCast(df, x_bounds),
                          hn::BitCast(df, y_bounds), df, out.group[3]);
}

/// True if a support lies beyond one of the four side planes of the view: slope · forward - sign ·
/// across = 0 through the eye; for parallel rays sign · across = half the image's width or height.
inline bool beside_the_view(const Mat3& w, const CameraFrame& frame, Vec3d p, double cutoff) {
    const double side_x = 0.5 * frame.width / frame.pixels_per_unit;
    const double side_y = 0.5 * frame.height / frame.pixels_per_unit;
    const double slope = frame.orthographic ? 0 : 1, margin = 1 - slope;
    const Mat3 scaled_axes = transpose(inverse(w));
    for (const double sign : {-1.0, 1.0})
        for (const bool horizontal : {true, false}) {
            const Vec3d across = horizontal ? frame.right : frame.up;
            const double side = horizontal ? side_x : side_y;
            const Vec3d normal = slope * side * frame.forward - sign * across;
            const double distance = dot(normal, p) + margin * side;
            if (distance >= 0) continue;
            const Vec3d reach = scaled_axes * normal;
            if (distance * distance > cutoff * cutoff * dot(reach, reach)) return true;
        }
    return false;
}

/// Appends Gaussian i as a near splat over the whole image, unless it lies beside the view.
inline void add_near_splat(const SplatModel& model, std::size_t i, const CameraFrame& frame,
                           std::vector<NearSplat>& near) {
    const Gaussians& gaussians = *model.gaussians;
    const Mat3 w = whitening(gaussians, i);
    const Vec3d p = vec_cast<double>(gaussians.mean[i]) - frame.eye;
    if (!beside_the_view(w, frame, p, model.cutoff)) near.push_back(near_splat(model, i, frame, w));
}

template <class Tags>
void project(const SplatModel& model, const CameraFrame& frame, std::size_t first, std::size_t last,
             SplatRun& run) {
    const typename Tags::Doubles d;
    constexpr std::size_t kLanes = TilePixels::kMaxLanes / 2;  // doubles in the widest vector
    const Gaussians& gaussians = *model.gaussians;
    const bool rotated = !gaussians.axis_aligned();
    const std::size_t lanes = hn::Lanes(d);
    // The last vector repeats its last Gaussian in the spare lanes.
    float mean[3 * kLanes], scale[3 * kLanes], rotation[4 * kLanes], density[kLanes];
    ProjectionOutput<kLanes> out;
    for (std::size_t block = first; block < last; block += lanes) {
        const std::size_t count = std::min(lanes, last - block);
        ProjectionInput in{&gaussians.mean[block].x, &gaussians.scale[block].x,
                           rotated ? &gaussians.rotation[block].w : nullptr,
                           &gaussians.density[block]};
        if (count < lanes) {
            for (std::size_t n = 0; n < lanes; ++n) {
                const std::size_t i = std::min(n, count - 1);
                std::copy_n(in.mean + 3 * i, 3, mean + 3 * n);
                std::copy_n(in.scale + 3 * i, 3, scale + 3 * n);
                if (rotated) std::copy_n(in.rotation + 4 * i, 4, rotation + 4 * n);
                density[n] = in.density[i];
            }
            in = {mean, scale, rotated ? rotation : nullptr, density};
        }
        if (frame.orthographic)
            project_lanes<true>(d, in, model, frame, out);
        else
            project_lanes<false>(d, in, model, frame, out);
        const std::size_t whole = (std::size_t{1} << count) - 1;
        for (std::size_t left = out.far & whole; left != 0; left &= left - 1) {
            const auto n = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(left));
            char* to = reinterpret_cast<char*>(run.far + run.count);
            for (std::size_t group = 0; group < 4; ++group)
                std::memcpy(to + 16 * group, out.group[group] + 4 * n, 16);
            run.bounds[run.count] = run.far[run.count].bounds;
            if (run.origin) run.origin[run.count] = {block + n, (out.widened >> n & 1) != 0};
            ++run.count;
        }
        for (std::size_t left = out.other & whole; left != 0; left &= left - 1)
            add_near_splat(model, block + hwy::Num0BitsBelowLS1Bit_Nonzero64(left), frame,
                           *run.near);
    }
}
