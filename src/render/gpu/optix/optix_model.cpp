// optix_model.cpp: OptixModel, the paper's Gaussian renderer.
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "render/gpu/cuda_passes.h"
#include "render/gpu/cuda_splat.h"
#include "render/gpu/gpu.h"
#include "render/gpu/optix/optix_film.h"
#include "render/gpu/optix/optix_pipeline.h"
#include "render/gpu/sums/sums_memory.h"
#include "render/trace/trace_options.h"
#include "vog/error.h"

namespace vog {

void gpu::require_primitives(const OptixDevice& device, std::size_t gaussians) {
    if (const std::size_t most = most_primitives(device); gaussians > most)
        throw Error(fmt::format("optix: {} Gaussians, expected at most {}", gaussians, most));
}

using namespace gpu;
using namespace trace;

struct OptixModel::State {
    TraceModel model;  ///< without its arrays, which are on the GPU
    std::size_t count = 0;
    std::shared_ptr<OptixDevice> device = optix_device();
    OptixRayPipeline accumulate{device, kAccumulateEntryPoints};
    OptixRayPipeline collect{device, kCollectEntryPoints};
    GpuArray<device::Gaussian> gaussians;
    SplatPasses passes;
    GpuArray<float> shares, splatted;  ///< of the current picture
    std::unique_ptr<OptixHierarchy> hierarchy;
    GpuArray<device::RayCounts> counts;  ///< of the last picture with a report
    GpuArray<CountTotals> totals;
    OptixFilm film;
    GpuTimer timer;

    device::Launch launch_for(const CameraFrame& frame, const TraceOptions& options) const;
    void draw_small(device::Launch& launch);
    /// T of a model that is not empty, on the film.
    void draw(const Camera& camera, int width, int height, const TraceOptions& options,
              TraceReport* report, int samples);
    void run(device::Launch launch, AnyHit anyhit) {
        draw_small(launch);
        (anyhit == AnyHit::collect ? collect : accumulate).run(launch);
    }
    /// Adds up the counts; not within the time of the picture.
    TraceReport report(std::int64_t pixels);
};

OptixModel::OptixModel(const Gaussians& gaussians, const TraceSceneOptions& options) {
    TraceModel model = trace_model(gaussians, options.aabb_sigma, options.kappa);
    state_ = std::make_unique<State>();
    State& s = *state_;
    s.model = std::move(model);
    s.count = s.model.gaussians.size();
    require_primitives(*s.device, s.count);
    s.film.set_depth_unit(s.model.depth_unit);
    s.gaussians = GpuArray(s.model.gaussians, "Gaussians");
    if (!s.model.boxed) {
        s.passes = SplatPasses(static_cast<std::int32_t>(s.count));
        s.shares = GpuArray<float>(s.count, "shares of Gaussians");
    }
    if (s.count > 0) s.hierarchy = std::make_unique<OptixHierarchy>(s.device, s.model.boxes);
    s.model.gaussians = {};
    s.model.boxes = {};
}

OptixModel::~OptixModel() = default;
OptixModel::OptixModel(OptixModel&&) noexcept = default;
OptixModel& OptixModel::operator=(OptixModel&&) noexcept = default;

double OptixModel::gpu_ms() const { return state_->timer.ms(); }

device::Launch OptixModel::State::launch_for(const CameraFrame& frame,
                                             const TraceOptions& options) const {
    device::Launch launch{};
    launch.traversable = hierarchy->handle();
    launch.camera = scene_camera(relative_to(frame, model.origin), model.unit);
    launch.bounds = model.bounds;
    launch.gaussians = gaussians.data();
    launch.center = model.center;
    launch.scene = model.scene;
    launch.rounding = model.rounding;
    launch.stop_depth = stop_depth(options) / model.depth_unit;
    launch.cutoff2 = model.cutoff2;
    launch.boxed = model.boxed ? 1 : 0;
    launch.hits_per_slab = options.hits_per_slab;
    return launch;
}

/// Splats the Gaussians smaller than a pixel (render/trace/small_gaussians.h) through the rays of the launch.
void OptixModel::State::draw_small(device::Launch& launch) {
    if (model.boxed) return;
    device::Camera camera = launch.camera;
    const double x = launch.film.x, y = launch.film.y;
    camera.corner = camera.corner + x * camera.step_x + y * camera.step_y;
    camera.eye = camera.eye + x * camera.shift_x + y * camera.shift_y;
    splatted.reserve(
        static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
        "the splatted picture");
    // Each launch has the whole mass of Gaussians below a pixel, and so their mean over the launches.
    passes.draw_small(gaussians.data(), model.kernel, camera, shares.data(), splatted.data());
    launch.shares = shares.data();
    launch.splatted = splatted.data();
}

TraceReport OptixModel::State::report(std::int64_t pixels) {
    totals.reserve(1, "counters");
    check_cuda(cudaMemset(totals.data(), 0, sizeof(CountTotals)), "clearing counters");
    launch_count(counts.data(), pixels, totals.data());
    CountTotals sum{};
    totals.copy_to(&sum, 1, "fetching counters");
    return {sum.hits, sum.slabs, static_cast<int>(sum.most_slabs)};
}

void OptixModel::State::draw(const Camera& camera, int width, int height,
                             const TraceOptions& options, TraceReport* report, int samples) {
    film.load(width, height, samples);
    device::Launch launch = launch_for(frame_of(camera, width, height), options);
    const std::int64_t pixels = std::int64_t{width} * height;
    if (report) {
        counts.reserve(static_cast<std::size_t>(pixels), "counts of rays");
        launch.counts = counts.data();
    }
    timer.start();
    for (int n = 0; n < film.launches(); ++n) {
        launch.film = film.film(n);
        run(launch, options.anyhit);
    }
    timer.stop();
    if (report) *report = this->report(pixels);
}

DepthImage OptixModel::render(const Camera& camera, int width, int height,
                              const TraceOptions& options, TraceReport* report, int samples) {
    check_trace_options(options);
    (void)frame_of(camera, width, height);  // its checks
    check_samples(samples);
    if (report) *report = {};
    if (state_->count == 0) return DepthImage(width, height);
    state_->draw(camera, width, height, options, report, samples);
    return state_->film.depth();
}

void OptixModel::render(const Camera& camera, const SumsSize& size, GpuSums& sums,
                        const TraceOptions& options) {
    check_trace_options(options);
    (void)frame_of(camera, size.width, size.height);
    check_samples(size.rays);
    SumsPass pass = sums.state().prepare(SumsKind::depth, {size.width, size.height, 1}, 1);
    if (state_->count == 0) return sums.state().clear();
    state_->draw(camera, size.width, size.height, options, nullptr, size.rays);
    pass.from = state_->film.device_depth();
    GpuSums::State::finish(pass);
}

}  // namespace vog
