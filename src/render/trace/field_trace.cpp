// field_trace.cpp: Maps of a field by ray tracing, one ray a pixel.
#include "render/pixel_tiles.h"
#include "render/shown_field.h"
#include "render/trace/small_gaussians.h"
#include "render/trace/trace.h"
#include "render/trace/trace_bvh.h"
#include "render/trace/trace_options.h"
#include "vog/error.h"

namespace vog {

using namespace trace;

namespace {

/// Sums of the Gaussians that are drawn as splats, whose fields are constant.
std::vector<RaySums> splatted_sums(const Gaussians& gaussians, const ShownField& shown,
                                   const SmallGaussians& small, const TraceModel& model,
                                   const CameraFrame& frame) {
    std::vector<RaySums> sums(static_cast<std::size_t>(frame.width) *
                              static_cast<std::size_t>(frame.height));
    const double share = model.kernel.variance;
    // Planes of scalars are the same at all pixels.
    std::vector<device::FieldPlane> planes(shown.along_rays ? 0 : small.splats.size());
    vog::parallel_for(std::size_t{0}, planes.size(), [&](std::size_t n) {
        const std::size_t i = small.index[n];
        planes[n] = constant_plane(shown.plane(i), gaussians, i, share);
    });
    for_each_splat_pixel(
        small.splats, model.kernel.kernel, frame.height,
        [&](std::uint32_t n, int x, int y, double depth) {
            const Vec3d direction = frame.direction(x, y);
            const double far = length(direction);
            const std::size_t i = small.index[n];
            const device::FieldPlane plane =
                shown.along_rays ? constant_plane(shown.plane_along(i, (1 / far) * direction),
                                                  gaussians, i, share)
                                 : planes[n];
            RaySums& sum =
                sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) +
                     static_cast<std::size_t>(x)];
            const double tau = depth * far;
            sum.column += tau;
            sum.first += tau * plane.value;
            sum.second += tau * (plane.value * plane.value + plane.variance);
        });
    return sums;
}

}  // namespace

FieldMaps render_field_trace(const Gaussians& gaussians, const FieldChoice& choice,
                             const Camera& camera, int width, int height,
                             const TraceOptions& options, const TraceSceneOptions& scene,
                             const Clipping& world_clip) {
    if (choice.part == FieldPart::magnitude)
        return magnitude_maps(options.progress, [&](FieldPart part, const Progress& progress) {
            TraceOptions own = options;
            own.progress = progress;
            return render_field_trace(gaussians, {choice.field, part}, camera, width, height, own,
                                      scene, world_clip);
        });
    check_trace_options(options);
    if (options.anyhit == AnyHit::collect)
        throw Error("trace: any-hit collect with a field, expected accumulate: its maps are sums");
    const TraceModel model = trace_model(gaussians, scene.aabb_sigma, scene.kappa);
    FieldMaps maps = empty_maps(width, height);
    const CameraFrame frame = relative_to(frame_of(camera, width, height), model.origin);
    const ShownField shown =
        shown_field(gaussians, choice, frame, std::sqrt(double{model.cutoff2}));
    validate(world_clip);
    const Clipping clip = relative_to(world_clip, model.origin);
    if (model.gaussians.empty()) return maps;
    const TraceBvh bvh(model);
    const TraceField field = trace_field(shown, model.gaussians.size(), model.unit);
    const device::Camera rays = scene_camera(frame, model.unit);
    SmallGaussians small = small_gaussians(model, rays);
    clip_splats(model, clip, frame, small);
    const float* shares = small.shares.empty() ? nullptr : small.shares.data();
    const std::vector<RaySums> splatted = splatted_sums(gaussians, shown, small, model, frame);
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        const std::size_t n = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column);
        RaySums sums = splatted[n];
        device::Ray ray;
        if (device::camera_ray(rays, model.bounds, column, row, ray) &&
            clip_ray(model, clip, ray)) {
            const FieldDepths depths = bvh.accumulate(ray, shares, field);
            sums.column += depths.column.depth();
            sums.first += depths.first.depth();
            sums.second += depths.second.depth();
        }
        set_pixel(maps, n, sums, sums.column * model.depth_unit,
                  shown.reference_along(vec(ray.direction)), shown.unit);
    });
    return maps;
}

}  // namespace vog
