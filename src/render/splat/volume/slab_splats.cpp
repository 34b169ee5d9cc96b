// slab_splats.cpp: Coefficients of SlabSplat, in double precision.
#include "render/splat/volume/slab_splats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/fields/field_limits.h"
#include "render/by_value/slab_moments.h"
#include "render/splat/fields/projected_mean.h"

namespace vog::splat {

namespace {

float as_float(double number) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(number, -kMost, kMost));
}

/// Gradient of the share of the field's range, per world unit.
Vec3d share_gradient(const SlabView& view, std::size_t i) {
    return (1 / (view.range.upper - view.range.lower)) * vec_cast<double>(view.field.gradient[i]);
}

/// A gradient along right, down and forward, per SlabView::length.
void set_gradient(const SlabView& view, Vec3d g, float out[3]) {
    const Vec3d axis[3] = {view.frame.right, -view.frame.up, view.frame.forward};
    for (int n = 0; n < 3; ++n) out[n] = as_float(view.length * dot(g, axis[n]));
}

/// Standard deviation along the view, of all rays together.
double view_deviation(const SlabView& view, std::size_t i) {
    return std::sqrt(variance_along(view.gaussians, i, view.frame.forward));
}

double mean_depth(const SlabView& view, std::size_t i) {
    return dot(vec_cast<double>(view.gaussians.mean[i]) - view.frame.eye, view.frame.forward);
}

}  // namespace

DepthRange depths_of(const SlabView& view, std::size_t i) {
    const double depth = mean_depth(view, i), reach = view.cutoff * view_deviation(view, i);
    return {static_cast<float>(std::max(depth - reach, 0.0) - view.depth),
            static_cast<float>(std::max(depth + reach, 0.0) - view.depth)};
}

SlabSplat slab_splat(const SlabView& view, const SplatOrigin& origin, const FarSplat& splat) {
    const std::size_t i = origin.index;
    SlabSplat out;
    const ShownMean at = shown_mean(view.gaussians, i, splat, view.frame, out);
    const double depth = mean_depth(view, i), deviation = view_deviation(view, i);
    out.depth = static_cast<float>(depth - view.depth);
    out.forward = static_cast<float>(depth);
    out.near = static_cast<float>(depth - view.cutoff * deviation - view.depth);
    out.far = static_cast<float>(depth + view.cutoff * deviation - view.depth);
    const Vec3d own = share_gradient(view, i);
    set_gradient(view, own, out.gradient);
    const by_value::Residual within =
        origin.widened ? point_residual(view.gaussians, view.field, view.range, i, view.share)
                       : residual_of(view.field, view.range, i);
    out.value = as_float(view.range.share(double{view.field.value[i]}));
    out.variance = as_float(within.variance), out.third = as_float(within.third);
    const Vec3d g = origin.widened ? Vec3d{} : own;
    double x = at.forward * dot(g, at.step_x), y = at.forward * dot(g, at.step_y);
    const double root_e02 = std::sqrt(double{splat.e02});
    if (view.frame.orthographic) {
        const ParallelNearest nearest = parallel_nearest(view.gaussians, i, view.frame, at);
        const double along = dot(g, view.frame.forward);
        x += along * nearest.depth_x;
        y += along * nearest.depth_y;
        out.along = static_cast<float>(along);
        out.depth_x = static_cast<float>(nearest.depth_x);
        out.depth_y = static_cast<float>(nearest.depth_y);
        out.per_root = static_cast<float>(root_e02 * std::sqrt(nearest.variance));
    } else {
        out.along = static_cast<float>(dot(g, at.from_eye));
        // |W D| is least where it is 1 / deviation, and C is e02 there.
        out.per_root = static_cast<float>(root_e02 * deviation);
    }
    out.x = static_cast<float>(x);
    out.y = static_cast<float>(y);
    return out;
}

void set_clip(const SlabView& view, SlabCell& cell) {
    constexpr float kMost = std::numeric_limits<float>::max();
    cell.clipped = !view.clip.empty();
    if (!cell.clipped) {
        // Loops that are not unrolled clip in any case.
        cell.clip_near.fill(-kMost), cell.clip_far.fill(kMost);
        return;
    }
    for (std::size_t n = 0; n < kCellPixels; ++n) {
        const double column = cell.column + static_cast<int>(n) % kCellWidth;
        const double row = cell.row + static_cast<int>(n) / kCellWidth;
        const RayInterval seen = clipped_ray(view.clip, view.frame.origin(column, row),
                                             view.frame.direction(column, row));
        const bool any = seen.first < seen.last;
        cell.clip_near[n] = any ? static_cast<float>(seen.first - view.depth) : kMost;
        cell.clip_far[n] =
            any ? static_cast<float>(std::min(seen.last - view.depth, double{kMost})) : kMost;
    }
}

void add_near_splat(const SlabView& view, const NearSplat& s, SlabCell& cell) {
    const std::size_t i = s.index;
    const int x0 = std::max(s.bounds.x0 - cell.column, 0), y0 = std::max(s.bounds.y0 - cell.row, 0);
    const int x1 = std::min(s.bounds.x1 - cell.column, kCellWidth - 1);
    const int y1 = std::min(s.bounds.y1 - cell.row, kCellHeight - 1);
    if (y0 > y1 || x0 > x1) return;
    const DepthRange depths = depths_of(view, i);
    const int lowest = cell.slab_at(depths.near), highest = cell.slab_at(depths.far);
    cell.touch(lowest, highest);
    const by_value::Residual within = residual_of(view.field, view.range, i);
    const Vec3d gradient = share_gradient(view, i), mean = vec_cast<double>(view.gaussians.mean[i]);
    float along[3];
    set_gradient(view, gradient, along);
    const double value = view.range.share(double{view.field.value[i]});
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double column = cell.column + x, row = cell.row + y;
            const Vec3d e = s.e + column * s.shift_x + row * s.shift_y;
            const Vec3d d = s.corner + column * s.step_x + row * s.step_y;
            const double c = dot(d, d), root = std::sqrt(c);
            const Vec3d offset = cross(e, d);
            const double m2 = dot(offset, offset) / c, reach2 = view.cutoff * view.cutoff - m2;
            if (!(reach2 > 0)) continue;
            const double nearest = dot(e, d) / c, half = std::sqrt(reach2) / root;
            double start = std::max(nearest - half, 0.0), end = nearest + half;
            if (cell.clipped) {
                const auto at = static_cast<std::size_t>(y * kCellWidth + x);
                start = std::max(start, view.depth + double{cell.clip_near[at]});
                end = std::min(end, view.depth + double{cell.clip_far[at]});
            }
            if (!(start < end)) continue;
            const Vec3d towards = view.frame.direction(column, row);
            const Vec3d from_mean = view.frame.origin(column, row) - mean;
            const double z0 = value + dot(gradient, from_mean), z_step = dot(gradient, towards);
            const double whole =
                s.density * std::exp(-0.5 * m2) * std::sqrt(0.5 * std::numbers::pi) / root;
            const auto part_at = [&](double t) {
                return std::erf((t - nearest) * root / std::numbers::sqrt2);
            };
            const int first =
                std::max(cell.slab_at(static_cast<float>(start - view.depth)), lowest);
            const int last = std::min(cell.slab_at(static_cast<float>(end - view.depth)), highest);
            double from = start;
            for (int slab = first; slab <= last; ++slab) {
                const double back = view.depth + double{cell.depths.first} +
                                    (slab + 1) * double{cell.depths.thickness};
                const double to = slab == last ? end : std::clamp(back, from, end);
                const double tau = whole * (part_at(to) - part_at(from));
                by_value::MomentSums part;
                part.add(tau, z0 + 0.5 * (from + to) * z_step, within);
                const double sums[kLitChannels] = {part.tau,
                                                   part.first,
                                                   part.second,
                                                   part.third,
                                                   tau * double{along[0]},
                                                   tau * double{along[1]},
                                                   tau * double{along[2]}};
                SlabPlane* const planes = cell.slab(slab);
                for (int n = 0; n < cell.channels; ++n)
                    planes[n].pixel[static_cast<std::size_t>(y * kCellWidth + x)] +=
                        as_float(sums[n]);
                from = to;
            }
        }
}

}  // namespace vog::splat
