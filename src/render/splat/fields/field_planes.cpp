// field_planes.cpp: Coefficients of PlaneSplat and ViewSplat, in double precision.
#include "render/splat/fields/field_planes.h"

#include "render/splat/fields/projected_mean.h"

namespace vog::splat {

namespace {

using device::FieldPlane;
using device::VectorPlane;

/// e02 = 1 / (S_ff peak²), and per_c 1 / (t0 peak)².
float pinhole_per_c(const Gaussians& gaussians, std::size_t i, const FarSplat& splat,
                    const CameraFrame& frame, double forward) {
    const Vec3d spread =
        times(own_forward(gaussians, i, frame), vec_cast<double>(gaussians.scale[i]));
    return static_cast<float>(double{splat.e02} * dot(spread, spread) / (forward * forward));
}

double product(const VectorPlane& plane, Vec3d along, Vec3d by) {
    // alongᵀ G by, rows of G the components' gradients
    const device::Double3 to = plain(by);
    return along.x * dot(device::to_double(plane.gradient[0]), to) +
           along.y * dot(device::to_double(plane.gradient[1]), to) +
           along.z * dot(device::to_double(plane.gradient[2]), to);
}

/// R, and for a point R + G C Gᵀ.
std::array<double, 6> whole_covariance(const VectorPlane& plane, const Gaussians& gaussians,
                                       std::size_t i, double share) {
    std::array<double, 6> all;
    for (std::size_t n = 0; n < 6; ++n) all[n] = double{plane.covariance[n]};
    if (share == 0) return all;
    const Mat3 own_from_world =
        gaussians.axis_aligned() ? Mat3{} : transpose(matrix_from_quat(gaussians.rotation[i]));
    const Vec3d scale = vec_cast<double>(gaussians.scale[i]);
    Vec3d g[3];
    for (std::size_t c = 0; c < 3; ++c)
        g[c] = times(own_from_world * vec(device::to_double(plane.gradient[c])), scale);
    std::size_t n = 0;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = a; b < 3; ++b) all[n++] += share * dot(g[a], g[b]);
    return all;
}
double quadratic(const std::array<double, 6>& r, Vec3d a, Vec3d b) {
    return a.x * (r[0] * b.x + r[1] * b.y + r[2] * b.z) +
           a.y * (r[1] * b.x + r[3] * b.y + r[4] * b.z) +
           a.z * (r[2] * b.x + r[4] * b.y + r[5] * b.z);
}

}  // namespace

PlaneSplat plane_splat(const ShownField& shown, const Gaussians& gaussians,
                       const SplatOrigin& origin, const FarSplat& splat, const CameraFrame& frame,
                       double share) {
    const std::size_t i = origin.index;
    PlaneSplat out;
    const ShownMean at = shown_mean(gaussians, i, splat, frame, out);
    FieldPlane plane = shown.plane(i);
    if (origin.widened) plane = constant_plane(plane, gaussians, i, share);
    out.value = static_cast<float>(plane.value);
    out.variance = static_cast<float>(plane.variance);
    if (origin.widened) return out;
    const Vec3d g = vec(plane.gradient);
    double x = at.forward * dot(g, at.step_x), y = at.forward * dot(g, at.step_y);
    if (frame.orthographic) {
        const ParallelNearest nearest = parallel_nearest(gaussians, i, frame, at);
        const double along = dot(g, frame.forward);
        x += along * nearest.depth_x;
        y += along * nearest.depth_y;
        out.along = static_cast<float>(along);
        out.per_c = static_cast<float>(double{splat.e02} * nearest.variance);
    } else {
        out.along = static_cast<float>(dot(g, at.from_eye));
        out.per_c = pinhole_per_c(gaussians, i, splat, frame, at.forward);
    }
    out.x = static_cast<float>(x);
    out.y = static_cast<float>(y);
    return out;
}

ViewSplat view_splat(const ShownField& shown, const Gaussians& gaussians, const SplatOrigin& origin,
                     const FarSplat& splat, const CameraFrame& frame, double share) {
    const std::size_t i = origin.index;
    ViewSplat out;
    const ShownMean at = shown_mean(gaussians, i, splat, frame, out);
    const VectorPlane plane = shown.vector_plane(i);
    const Vec3d center = (1 / at.forward) * at.from_eye;  // D0
    const Vec3d axis[3] = {center, at.step_x, at.step_y};
    const Vec3d value = vec(device::to_double(plane.value));
    const auto r = whole_covariance(plane, gaussians, i, origin.widened ? share : 0);
    for (std::size_t n = 0; n < 3; ++n) out.value[n] = static_cast<float>(dot(axis[n], value));
    const double squares[6] = {
        quadratic(r, center, center),           2 * quadratic(r, center, at.step_x),
        2 * quadratic(r, center, at.step_y),    quadratic(r, at.step_x, at.step_x),
        2 * quadratic(r, at.step_x, at.step_y), quadratic(r, at.step_y, at.step_y)};
    for (std::size_t n = 0; n < 6; ++n) out.variance[n] = static_cast<float>(squares[n]);
    if (origin.widened) return out;
    out.per_c = pinhole_per_c(gaussians, i, splat, frame, at.forward);
    for (std::size_t n = 0; n < 3; ++n)
        out.along[n] = static_cast<float>(product(plane, axis[n], at.from_eye));
    const double across[5] = {
        product(plane, center, at.step_x), product(plane, center, at.step_y),
        product(plane, at.step_x, at.step_x),
        product(plane, at.step_x, at.step_y) + product(plane, at.step_y, at.step_x),
        product(plane, at.step_y, at.step_y)};
    for (std::size_t n = 0; n < 5; ++n) out.across[n] = static_cast<float>(at.forward * across[n]);
    return out;
}

void add_near_field(const NearSplat& s, const ShownField& shown, const Gaussians& gaussians,
                    const CameraFrame& frame, double cutoff, const TileRays& rays,
                    FieldTile& tile) {
    const TileRange range = range_in(tile.sum[0], s.bounds);
    if (range.y0 > range.y1 || range.x0 > range.x1) return;
    const Vec3d mean = vec_cast<double>(gaussians.mean[s.index]);
    VectorPlane vector{};
    FieldPlane plane{};
    if (shown.along_rays)
        vector = shown.vector_plane(s.index);
    else
        plane = shown.plane(s.index);
    for (int y = range.y0; y <= range.y1; ++y)
        for (int x = range.x0; x <= range.x1; ++x) {
            const double column = tile.sum[0].column + x, row = tile.sum[0].row + y;
            const Vec3d e = s.e + column * s.shift_x + row * s.shift_y;
            const Vec3d d = s.corner + column * s.step_x + row * s.step_y;
            device::RayPart part;
            if (s.clipped) part = {rays.kept[y][x].first, rays.kept[y][x].last};
            const device::SegmentMoments moments =
                device::segment_moments(plain(e), plain(d), cutoff * cutoff, part);
            if (!(moments.zeroth > 0)) continue;
            const Vec3d towards = frame.direction(column, row);
            const Vec3d from_mean = frame.origin(column, row) + moments.nearest * towards - mean;
            if (shown.along_rays) plane = device::plane_along(vector, plain(towards));
            const device::FieldMean field =
                device::mean_along(plane, plain(from_mean), plain(towards), moments);
            const double tau = s.density * moments.zeroth;
            tile.sum[0].depth[y][x] += static_cast<float>(tau);
            tile.sum[1].depth[y][x] += static_cast<float>(tau * field.first);
            tile.sum[2].depth[y][x] += static_cast<float>(tau * field.second);
        }
}

}  // namespace vog::splat
