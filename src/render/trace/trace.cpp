// trace.cpp: Ray tracing of a model, one ray a pixel, as the OptiX programs do.
#include "render/trace/trace.h"

#include <algorithm>
#include <utility>

#include "render/clipping/clipped_gaussians.h"
#include "render/pixel_tiles.h"
#include "render/shown_field.h"
#include "render/trace/small_gaussians.h"
#include "render/trace/trace_bvh.h"
#include "render/trace/trace_options.h"

namespace vog {

using namespace trace;

struct TraceScene::Data {
    TraceModel model;
    TraceBvh bvh;

    explicit Data(TraceModel&& packed) : model(std::move(packed)), bvh(model) {}
};

namespace {

/// __raygen__ of collect: T of one ray, slab by slab, until a slab is not full.
/// opaque  T at which the ray ends
double collected_depth(const TraceScene::Data& scene, const device::Ray& ray, const float* shares,
                       const TraceOptions& options, double opaque, TraceReport& report) {
    device::HitList list;
    list.capacity = options.hits_per_slab;
    device::CollectedHit last;
    device::DepthSum sum{};
    int slabs = 0;
    for (bool more = true; more;) {
        device::begin_slab(list, slabs ? &last : nullptr);
        scene.bvh.collect(ray, shares, list);
        if (list.count == 0) break;
        ++slabs;
        device::sort_by_entry(list);
        last = list.hit[list.count - 1];
        report.hits += static_cast<std::uint64_t>(list.count);
        more = device::integrate(list, scene.model.gaussians.data(), shares, ray,
                                 scene.model.cutoff2, opaque, scene.model.rounding, sum);
    }
    report.slabs += static_cast<std::uint64_t>(slabs);
    report.most_slabs = std::max(report.most_slabs, slabs);
    return sum.depth();
}

}  // namespace

std::size_t TraceScene::size() const { return data_->model.gaussians.size(); }

TraceScene trace_scene(const Gaussians& gaussians, const TraceSceneOptions& options) {
    return TraceScene(std::make_shared<TraceScene::Data>(
        trace_model(gaussians, options.aabb_sigma, options.kappa)));
}

DepthImage render_trace(const TraceScene& scene, const Camera& camera, int width, int height,
                        const TraceOptions& options, TraceReport* report,
                        const Clipping& world_clip) {
    check_trace_options(options);
    validate(world_clip);
    const TraceScene::Data& data = scene.data();
    const CameraFrame view = relative_to(frame_of(camera, width, height), data.model.origin);
    const device::Bounds& bounds = data.model.bounds;
    const Clipping clip = clipping::cutting(
        relative_to(world_clip, data.model.origin),
        {data.model.unit * vec(bounds.lower), data.model.unit * vec(bounds.upper)});
    const device::Camera frame = scene_camera(view, data.model.unit);
    DepthImage image(width, height);
    TraceReport total;
    if (data.model.gaussians.empty()) {
        if (report) *report = total;
        return image;
    }
    SmallGaussians small = small_gaussians(data.model, frame);
    clip_splats(data.model, clip, view, small);
    const float* shares = small.shares.empty() ? nullptr : small.shares.data();
    draw_splats(small.splats, data.model.kernel.kernel, frame, image);
    const double opaque = stop_depth(options) / data.model.depth_unit;
    const auto draw = [&](int column, int row, TraceReport& part) {
        device::Ray ray;
        if (!device::camera_ray(frame, data.model.bounds, column, row, ray) ||
            !clip_ray(data.model, clip, ray))
            return;
        double depth = 0;
        if (options.anyhit == AnyHit::accumulate) {
            device::DepthSum sum{};
            part.hits += data.bvh.accumulate(ray, shares, sum);
            depth = sum.depth();
        } else {
            // A ray ends where its own T and that of the splats are opaque.
            const double splatted = double{image.at(column, row)};
            if (splatted >= opaque) return;
            depth = collected_depth(data, ray, shares, options, opaque - splatted, part);
        }
        image.at(column, row) += static_cast<float>(depth);
    };
    const auto add = [&](const TraceReport& part) {
        total.hits += part.hits;
        total.slabs += part.slabs;
        total.most_slabs = std::max(total.most_slabs, part.most_slabs);
    };
    for_each_pixel<TraceReport>(width, height, options.progress, draw, add);
    for (float& depth : image.depth)
        depth = static_cast<float>(double{depth} * data.model.depth_unit);
    if (report) *report = total;
    return image;
}

}  // namespace vog
