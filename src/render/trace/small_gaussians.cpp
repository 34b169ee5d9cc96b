// small_gaussians.cpp: Projection of a whole model by the device code, and splats row by row.
#include "render/trace/small_gaussians.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/clipping/clipped_gaussians.h"
#include "render/shown_field.h"

namespace vog::trace {

namespace {

constexpr std::size_t kChunk = 4096;  ///< Gaussians a task

struct Chunk {
    std::vector<device::TileSplat> splats;
    std::vector<std::uint32_t> index;
    bool all_whole = true;  ///< every share is 1
};

}  // namespace

SmallGaussians small_gaussians(const TraceModel& model, const device::Camera& camera) {
    SmallGaussians small;
    if (model.boxed) return small;
    const std::size_t size = model.gaussians.size();
    small.shares.resize(size);
    std::vector<Chunk> chunks((size + kChunk - 1) / kChunk);
    vog::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t n) {
        Chunk& chunk = chunks[n];
        for (std::size_t i = n * kChunk; i < std::min(size, (n + 1) * kChunk); ++i) {
            device::TileSplat splat;
            const device::SplatSource source = device::source_of(model.gaussians[i]);
            const bool drawn = device::project(source, camera, model.kernel, splat);
            small.shares[i] = splat.widened ? 0.0f : splat.share;
            if (drawn && splat.widened) {
                chunk.splats.push_back(splat);
                chunk.index.push_back(static_cast<std::uint32_t>(i));
            }
            chunk.all_whole = chunk.all_whole && small.shares[i] == 1;
        }
    });
    bool all_whole = true;
    for (const Chunk& chunk : chunks) {
        small.splats.insert(small.splats.end(), chunk.splats.begin(), chunk.splats.end());
        small.index.insert(small.index.end(), chunk.index.begin(), chunk.index.end());
        all_whole = all_whole && chunk.all_whole;
    }
    if (all_whole) small.shares.clear();
    return small;
}

void clip_splats(const TraceModel& model, const Clipping& clip, const CameraFrame& frame,
                 SmallGaussians& small) {
    if (clip.empty()) return;
    vog::parallel_for(std::size_t{0}, small.splats.size(), [&](std::size_t n) {
        const device::Gaussian& g = model.gaussians[small.index[n]];
        Mat3 whitening;
        for (std::size_t row = 0; row < 3; ++row)
            whitening.row[row] = (1 / model.unit) * vec(device::to_double(g.w[row]));
        const Vec3d mean = model.unit * vec(device::to_double(g.mean));
        small.splats[n].weight *= static_cast<float>(
            clipping::share_at_mean(clip, mean, whitening, model.kernel.cutoff, frame));
    });
}

bool clip_ray(const TraceModel& model, const Clipping& clip, device::Ray& ray) {
    if (clip.empty()) return true;
    const RayInterval seen = clipped_ray(clip, model.unit * vec(ray.origin), vec(ray.direction));
    const double first = seen.first / model.unit, last = seen.last / model.unit;
    const double length = double{ray.length};
    if (!(first < last) || first > length) return false;
    if (first > 0) device::set_ray(ray.origin + first * ray.direction, ray.direction, ray);
    ray.length = static_cast<float>(std::min(last, length) - first);
    if (last < length) ray.end = last - first;
    return true;
}

void draw_splats(const std::vector<device::TileSplat>& splats, const device::Kernel& kernel,
                 const device::Camera& camera, DepthImage& image) {
    if (splats.empty()) return;
    std::vector<double> sums(image.depth.size());
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
               static_cast<std::size_t>(x);
    };
    for_each_splat_pixel(
        splats, kernel, image.height,
        [&](std::uint32_t, int x, int y, double depth) { sums[at(x, y)] += depth; });
    vog::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const double sum = sums[at(x, y)];
            if (sum == 0) continue;
            const device::Double3 d =
                camera.corner + double(x) * camera.step_x + double(y) * camera.step_y;
            image.at(x, y) += static_cast<float>(sum * std::sqrt(device::dot(d, d)));
        }
    });
}

}  // namespace vog::trace
