// volume_trace.cpp: Volume rendering of a model by ray tracing: the Gaussians on a ray are collected, moments of their
// values summed in the order of depth by steps finer than the thinnest of them, and classified.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/fields/field_limits.h"
#include "render/by_value/lighting.h"
#include "render/by_value/slab_moments.h"
#include "render/by_value/volume_field.h"
#include "render/light/illumination.h"
#include "render/pixel_tiles.h"
#include "render/shown_field.h"
#include "render/trace/small_gaussians.h"
#include "render/trace/trace.h"
#include "render/trace/trace_bvh.h"
#include "render/trace/trace_options.h"

namespace vog {

using namespace by_value;
using namespace trace;

namespace {

/// A Gaussian on a ray, t in scene units.
struct OnRay {
    double start, end;     ///< chord in front of the eye
    double nearest;        ///< t*
    double per_deviation;  ///< standard deviations per scene unit
    double whole;          ///< density e^{-m²/2} sqrt(pi/2) / per_deviation, units of depth
    double share, step;    ///< of the field's range at t = 0, and its change with t
    Residual residual;
    Vec3d gradient;  ///< of the share, per world unit
};

/// A Gaussian that is drawn as a splat, at one pixel.
struct Splatted {
    int column;
    std::uint32_t index;
    double depth;  ///< tau, units of depth
};

/// Ray of a pixel, world units relative to the model's origin.
struct WorldRay {
    Vec3d origin, direction;  ///< direction of unit length
};

/// Sums of equal steps along a ray; empty: nothing is on it.
struct RaySteps {
    std::vector<MomentSums> sums;
    double first = 0,
           length = 0;  ///< start of the first step along the ray, and length of each, world units
};

/// What all rays of a picture share.
struct VolumeRays {
    const Gaussians& gaussians;
    const ScalarField& field;
    const ValueRange& range;
    const TraceModel& model;
    const TraceBvh& bvh;
    const float* shares;   ///< SmallGaussians::shares, or null
    const Clipping& clip;  ///< relative to the model's origin

    void collect(const device::Ray& ray, const RayInterval& seen, std::vector<OnRay>& hits) const;
    Vec3d gradient(std::uint32_t i) const {
        return (1 / (range.upper - range.lower)) * vec_cast<double>(field.gradient[i]);
    }
    double depth_of(const Splatted& point, const device::Ray& ray) const;
    RayInterval seen(const device::Ray& ray) const;
    RaySteps steps(const device::Ray& ray, std::span<const OnRay> hits,
                   std::span<const Splatted> points) const;
};

/// t of the mean.
double VolumeRays::depth_of(const Splatted& point, const device::Ray& ray) const {
    const device::Double3 mean = device::to_double(model.gaussians[point.index].mean);
    return std::max(dot(mean - ray.origin, ray.direction), 0.0);
}

/// The part of a ray that the clip leaves.
RayInterval VolumeRays::seen(const device::Ray& ray) const {
    RayInterval seen = clipped_ray(clip, model.unit * vec(ray.origin), vec(ray.direction));
    return {seen.first / model.unit, seen.last / model.unit};
}

void VolumeRays::collect(const device::Ray& ray, const RayInterval& seen,
                         std::vector<OnRay>& hits) const {
    hits.clear();
    device::HitList list;
    list.capacity = device::kMaxHitsPerSlab;
    device::CollectedHit last{};
    for (bool more = true, first = true; more; first = false) {
        device::begin_slab(list, first ? nullptr : &last);
        bvh.collect(ray, shares, list);
        more = list.count == list.capacity;
        if (list.count == 0) break;
        device::sort_by_entry(list);
        last = list.hit[list.count - 1];
        for (int n = 0; n < list.count; ++n) {
            const std::uint32_t i = list.hit[n].index;
            const device::Gaussian& g_of = model.gaussians[i];
            const device::Double3 to_mean = device::to_double(g_of.mean) - ray.origin;
            const device::Double3 w[3] = {device::to_double(g_of.w[0]),
                                          device::to_double(g_of.w[1]),
                                          device::to_double(g_of.w[2])};
            const device::Double3 e{dot(w[0], to_mean), dot(w[1], to_mean), dot(w[2], to_mean)};
            const device::Double3 d{dot(w[0], ray.direction), dot(w[1], ray.direction),
                                    dot(w[2], ray.direction)};
            const double c = dot(d, d), root = std::sqrt(c), nearest = dot(e, d) / c;
            const device::Double3 offset = cross(e, d);
            const double m2 = dot(offset, offset) / c, reach2 = double{model.cutoff2} - m2;
            if (!(reach2 > 0)) continue;
            const double half = std::sqrt(reach2) / root;
            const double start = std::max(nearest - half, seen.first),
                         end = std::min(nearest + half, seen.last);
            if (!(start < end)) continue;
            const Vec3d g = gradient(i);
            const double share = shares ? double{shares[i]} : 1;
            hits.push_back({start, end, nearest, root,
                            share * double{g_of.density} * std::exp(-0.5 * m2) *
                                std::sqrt(0.5 * std::numbers::pi) / root,
                            range.share(double{field.value[i]}) - model.unit * dot(g, vec(to_mean)),
                            model.unit * dot(g, vec(ray.direction)), residual_of(field, range, i),
                            g});
        }
    }
}

RaySteps VolumeRays::steps(const device::Ray& ray, std::span<const OnRay> hits,
                           std::span<const Splatted> points) const {
    double start = std::numeric_limits<double>::infinity(), end = 0, thinnest = start;
    for (const OnRay& hit : hits) {
        start = std::min(start, hit.start);
        end = std::max(end, hit.end);
        thinnest = std::min(thinnest, 1 / hit.per_deviation);
    }
    for (const Splatted& point : points) {
        start = std::min(start, depth_of(point, ray));
        end = std::max(end, depth_of(point, ray));
    }
    if (!(start <= end)) return {};
    // An eighth of the thinnest Gaussian; few colours change within that.
    constexpr double kLeastSteps = 64, kMostSteps = 8192;
    const double extent = std::max(end - start, 1e-300);
    const auto steps =
        static_cast<std::size_t>(std::clamp(8 * extent / thinnest, kLeastSteps, kMostSteps));
    const double length = extent / double(steps), unit = model.depth_unit;
    std::vector<MomentSums> sums(steps);
    const auto step_of = [&](double t) {
        return std::min(static_cast<std::size_t>(std::max((t - start) / length, 0.0)), steps - 1);
    };
    const auto add = [&](std::size_t step, double tau, double share, const Residual& within,
                         const Vec3d& g) {
        sums[step].add(tau * unit, share, within);
        sums[step].gradient = sums[step].gradient + (tau * unit) * g;
    };
    for (const OnRay& hit : hits) {
        const auto part_at = [&](double t) {
            return std::erf((t - hit.nearest) * hit.per_deviation / std::numbers::sqrt2);
        };
        double from = hit.start, before = part_at(from);
        const std::size_t last = step_of(hit.end);
        for (std::size_t step = step_of(hit.start); step <= last; ++step) {
            const double to = step == last
                                  ? hit.end
                                  : std::clamp(start + double(step + 1) * length, from, hit.end);
            const double after = part_at(to);
            add(step, hit.whole * (after - before), hit.share + 0.5 * (from + to) * hit.step,
                hit.residual, hit.gradient);
            from = to, before = after;
        }
    }
    for (const Splatted& point : points) {
        const Residual within =
            point_residual(gaussians, field, range, point.index, double{model.kernel.variance});
        add(step_of(depth_of(point, ray)), point.depth,
            range.share(double{field.value[point.index]}), within, gradient(point.index));
    }
    return {std::move(sums), start * model.unit, length * model.unit};
}

/// Depth of a cell of a picture (device::kDepthCells), world units.
double cell_depth(const Gaussians& gaussians, const CameraFrame& frame, double cutoff) {
    double near = std::numeric_limits<double>::infinity(), far = 0;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const double depth = dot(vec_cast<double>(gaussians.mean[i]) - frame.eye, frame.forward);
        const double reach = cutoff * std::sqrt(variance_along(gaussians, i, frame.forward));
        near = std::min(near, std::max(depth - reach, 0.0));
        far = std::max(far, depth + reach);
    }
    return std::max(far - near, 0.0) / device::kDepthCells;
}

/// Emission and absorption, front to back, by the closed form of mean light.
/// cell  length of a cell on the ray, world units
Rgba composited(const RaySteps& steps, device::MeanLight light, const device::BlinnPhong& look,
                const device::LightLattice& lattice, double cell, const WorldRay& ray) {
    device::SeenLight seen{{0, 0, 0}, 1};
    device::LitRay lit{
        &look, &lattice, plain(-ray.direction), {}, plain(steps.length * ray.direction)};
    if (steps.length > 0) light.parts_per_cell = static_cast<float>(cell / steps.length);
    for (std::size_t n = 0; n < steps.sums.size(); ++n) {
        if (!(steps.sums[n].tau > 0)) continue;
        device::ValueMoments moments = steps.sums[n].moments();
        if (light.gradient.any()) moments.gradient = moments.tau * moments.gradient;
        const double at = steps.first + (double(n) + 0.5) * steps.length;
        float color[4];
        lit.middle = plain(ray.origin + at * ray.direction);
        lit.light_of(light, moments, 0, 1, color);
        device::composite(color, moments.tau, seen);
    }
    return {seen.color[0], seen.color[1], seen.color[2], 1 - seen.passed};
}

/// Largest mean of the steps' values where there is density enough, as a share of the field's range; negative: none.
/// most  largest share per density
double largest_share(const RaySteps& steps, double most) {
    double densest = 0, largest = -1;
    for (const MomentSums& sum : steps.sums) densest = std::max(densest, sum.tau);
    for (const MomentSums& sum : steps.sums)
        if (sum.tau > 0 && sum.tau >= kLeastDensityShare * densest)
            largest = std::max(largest, std::clamp(sum.first / sum.tau, 0.0,
                                                   std::min(most * sum.tau / steps.length, 1.0)));
    return largest;
}

/// Size of a picture and how it is traced.
struct TracedPicture {
    const Camera& camera;
    int width, height;
    const TraceOptions& options;
    const TraceSceneOptions& scene;
    const VolumeLook& look;
};

/// Calls draw(pixel, steps, ray) for each pixel with something on its ray.
template <class Draw>
void trace_sums(const Gaussians& gaussians, const ScalarField& values, const TracedPicture& picture,
                const Draw& draw) {
    const auto& [camera, width, height, options, scene, look] = picture;
    check_trace_options(options);
    validate(look);
    const TraceModel model = trace_model(gaussians, scene.aabb_sigma, scene.kappa);
    const CameraFrame frame = relative_to(frame_of(camera, width, height), model.origin);
    const ValueRange range = value_range(values);
    if (model.gaussians.empty()) return;
    const TraceBvh bvh(model);
    const device::Camera rays = scene_camera(frame, model.unit);
    const SmallGaussians small = small_gaussians(model, rays);
    const Clipping clip = relative_to(look.clip, model.origin);
    const VolumeRays all{gaussians, values, range,
                         model,     bvh,    small.shares.empty() ? nullptr : small.shares.data(),
                         clip};
    // Bands of rows are drawn side by side, a row by one thread.
    std::vector<std::vector<Splatted>> rows(static_cast<std::size_t>(height));
    for_each_splat_pixel(
        small.splats, model.kernel.kernel, height,
        [&](std::uint32_t n, int x, int y, double depth) {
            const double far = length(frame.direction(x, y));
            rows[static_cast<std::size_t>(y)].push_back({x, small.index[n], depth * far});
        });
    for (std::vector<Splatted>& row : rows) std::ranges::stable_sort(row, {}, &Splatted::column);
    const int columns = width;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        const auto points = std::ranges::equal_range(rows[static_cast<std::size_t>(row)], column,
                                                     {}, &Splatted::column);
        device::Ray ray;
        std::vector<OnRay> hits;
        const bool meets = device::camera_ray(rays, model.bounds, column, row, ray);
        if (!meets) {
            if (points.empty()) return;
            // Beside the bounds a pixel can still have a share of a splat.
            const Vec3d direction = normalized(frame.direction(column, row));
            const Vec3d origin = (1 / model.unit) * frame.origin(column, row);
            device::set_ray(plain(origin), plain(direction), ray);
        }
        const RayInterval seen = all.seen(ray);
        if (!(seen.first < seen.last)) return;
        if (meets) all.collect(ray, seen, hits);
        std::vector<Splatted> shown;
        for (const Splatted& point : points)
            if (const double depth = all.depth_of(point, ray);
                depth >= seen.first && depth <= seen.last)
                shown.push_back(point);
        draw(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column),
             all.steps(ray, hits, shown), {model.unit * vec(ray.origin), vec(ray.direction)});
    });
}

}  // namespace

VolumeImage render_volume_trace(const Gaussians& gaussians, const std::string& field,
                                const ValueTransfer& transfer, const Camera& camera, int width,
                                int height, const TraceOptions& options,
                                const TraceSceneOptions& scene, const VolumeLook& look) {
    const ScalarField& values = volume_field(gaussians, field);
    const CameraFrame frame = relative_to(frame_of(camera, width, height), gaussians.origin);
    VolumeImage image{width, height, {}};
    image.pixel.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                       Rgba{0, 0, 0, 0});
    const LightOfMoments made(transfer, value_range(values), values.is_measure);
    device::MeanLight light = made.mean_light();
    light.table = nullptr;
    const device::BlinnPhong shading = blinn_phong(look);
    const lights::Illumination reached =
        lights::illumination({gaussians, values, made}, look, frame.forward);
    const device::LightLattice lattice = reached.lattice(gaussians.origin);
    const double cell = cell_depth(gaussians, frame, double{gaussians.cutoff});
    trace_sums(gaussians, values, {camera, width, height, options, scene, look},
               [&](std::size_t pixel, const RaySteps& steps, const WorldRay& ray) {
                   image.pixel[pixel] = composited(steps, light, shading, lattice,
                                                   cell / dot(ray.direction, frame.forward), ray);
               });
    return image;
}

ValueMap render_maximum_trace(const Gaussians& gaussians, const std::string& field,
                              const Camera& camera, int width, int height,
                              const TraceOptions& options, const TraceSceneOptions& scene,
                              const Clipping& clip) {
    const ScalarField& values = volume_field(gaussians, field);
    VolumeLook look;
    look.clip = clip;
    (void)frame_of(camera, width, height);  // checks the size
    ValueMap map{width, height, {}};
    map.value.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                     std::numeric_limits<float>::quiet_NaN());
    trace_sums(gaussians, values, {camera, width, height, options, scene, look},
               [&](std::size_t pixel, const RaySteps& steps, const WorldRay&) {
                   if (const double share = largest_share(steps, most_share_per_density(values));
                       share >= 0)
                       map.value[pixel] = value_of_share(values, share);
               });
    return map;
}

}  // namespace vog
