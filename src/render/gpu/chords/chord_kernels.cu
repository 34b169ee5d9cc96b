// chord_kernels.cu: CUDA kernels of pictures of chords: projection, then one block a tile and one thread a pixel. A
// thread intersects its ray with the Gaussians of the tile as a ray tracer does, so that clips, fields and depth slabs
// have the exact chord; those drawn wider than they are have that of their splat.
#include <cuda_runtime.h>

#include "render/gpu/chords/chord_kernels.h"
#include "render/gpu/kernel_start.h"

namespace vog::gpu {

namespace {

using device::Chord;
using device::ChordPicture;

/// Widens the range of depths of the picture.
__device__ void include_depths(std::uint32_t* range, const device::SplatDepth& depth) {
    // Most lie within what others have set: no need to wait for them.
    const std::uint32_t near = device::order_of(-depth.near), far = device::order_of(depth.far);
    if (range[0] < near) atomicMax(range, near);
    if (range[1] < far) atomicMax(range + 1, far);
}

__global__ void project_chords_kernel(ChordProjection p) {
    const std::int64_t i = thread_index();
    if (i >= p.count) return;
    p.touched[i] = 0;
    p.shares[i] = 0;
    const device::Gaussian g = p.picture.gaussians[i];
    const device::SplatSource source = device::source_of(g);
    const device::Camera& camera = p.picture.camera;
    device::TileSplat splat;
    bool visible = device::project(source, camera, p.kernel, splat);
    p.shares[i] = p.boxed ? 1.0f : splat.widened ? 0.0f : splat.share;
    if (visible && splat.near)
        visible = device::may_meet(
            g, device::frustum_of(camera, {0, camera.width - 1, 0, camera.height - 1}),
            p.picture.kernel.cutoff2);
    if (!visible) return;
    const device::SplatDepth depth =
        device::splat_depth(source, camera, p.picture.view, p.kernel.cutoff, splat);
    if (p.range) include_depths(p.range, depth);
    if (p.boxed || (!p.all && !splat.widened)) return;
    p.splats[i] = splat;
    p.depths[i] = depth;
    p.touched[i] = splat.near ? 1 : static_cast<std::uint64_t>(device::tile_count(splat));
    if (splat.near) atomicAdd(p.near, 1u);
}

/// Gaussians of a tile as its threads share them: 32 of about 250 bytes.
struct ChordBatch {
    static constexpr int kCount = 32;
    device::Gaussian gaussian[kCount];
    device::TileSplat splat[kCount];
    device::SplatDepth depth[kCount];
    device::SplatValue value[kCount];  ///< of slabs
    std::uint32_t index[kCount];
    int used[kCount];  ///< 0: left out
    device::TilePlanes planes;
};

/// Entries of a tile, of which those of its own come first and those at the plane of the eye last.
struct TileEntries {
    std::int64_t own, own_count, near, count;
    __device__ std::int64_t at(std::int64_t n) const {
        return n < own_count ? own + n : near + (n - own_count);
    }
};
__device__ TileEntries entries_of(const ChordPicture& p, std::int32_t tile) {
    const auto own = static_cast<std::int64_t>(p.first[tile]);
    const std::int64_t own_count = static_cast<std::int64_t>(p.first[tile + 1]) - own;
    return {own, own_count, p.near_first, own_count + p.near_last - p.near_first};
}

/// Sets the planes of a tile, by one thread.
__device__ void set_planes(const ChordPicture& p, const TilePlace& at, ChordBatch& batch) {
    if (at.thread > 0) return;
    const device::Frustum frustum =
        device::frustum_of(p.camera, device::pixels_of(at.tile, p.tile_columns));
    for (int n = 0; n < 4; ++n) device::set_plane(frustum, n, batch.planes);
}

/// Loads Gaussian n of a batch, by one thread, after set_planes and a barrier.
__device__ void load(const ChordPicture& p, std::uint32_t i, int n, ChordBatch& batch) {
    batch.used[n] = 1;
    batch.index[n] = i;
    batch.gaussian[n] = p.gaussians[i];
    batch.splat[n] = p.splats[i];
    batch.depth[n] = p.depths[i];
    if (batch.splat[n].near)
        batch.used[n] = device::may_reach(batch.gaussian[n], batch.planes, p.kernel.cutoff2);
}

/// The chord of a pixel through Gaussian n of a batch.
/// returns  false if there is none
__device__ bool chord_at(const ChordPicture& p, const ChordBatch& batch, int n,
                         const device::ChordRay& ray, const TilePlace& at, Chord& chord) {
    const device::TileSplat& splat = batch.splat[n];
    if (splat.widened)
        return device::widened_chord(splat, batch.depth[n], p.kernel, ray, at.column, at.row,
                                     chord);
    device::Hit hit;
    return ray.meets && device::intersect(batch.gaussian[n], ray.ray, p.kernel.cutoff2, hit) &&
           device::chord_of(batch.gaussian[n], ray.ray, hit, ray.ends, splat.share, chord);
}

__device__ bool in_picture(const ChordPicture& p, const TilePlace& at) {
    return at.column < p.camera.width && at.row < p.camera.height;
}
__device__ std::uint32_t pixel_of(const ChordPicture& p, const TilePlace& at) {
    return static_cast<std::uint32_t>(at.row) * static_cast<std::uint32_t>(p.camera.width) +
           static_cast<std::uint32_t>(at.column);
}

__global__ void __launch_bounds__(kBlock) chord_sums_kernel(ChordPicture p) {
    __shared__ ChordBatch batch;
    const TilePlace at = place_in(p.tile_columns);
    set_planes(p, at, batch);
    const device::ChordRay ray = device::chord_ray(p.camera, p.bounds, p.view, at.column, at.row);
    const device::Float3 direction = device::to_float(ray.ray.direction);
    const TileEntries entries = entries_of(p, at.tile);
    double tau = 0, first = 0, second = 0;
    for (std::int64_t begin = 0; begin < entries.count; begin += ChordBatch::kCount) {
        const std::int64_t left = entries.count - begin;
        const int filled = left < ChordBatch::kCount ? static_cast<int>(left) : ChordBatch::kCount;
        __syncthreads();
        if (at.thread < filled) load(p, p.entry[entries.at(begin + at.thread)], at.thread, batch);
        __syncthreads();
        // Sums of a batch in single precision, of all in double: rounding as of one batch.
        device::ChordSums sums{0, 0, 0};
        for (int n = 0; n < filled; ++n) {
            Chord chord;
            if (!batch.used[n] || !chord_at(p, batch, n, ray, at, chord)) continue;
            const std::uint32_t i = batch.index[n];
            const device::ScalarPlane plane =
                batch.splat[n].widened ? widened_plane(p, i, batch.gaussian[n], direction)
                                       : plane_of(p, i, direction);
            const device::ChordSums one = device::sums_over(chord, plane, direction);
            sums.tau += one.tau;
            sums.first += one.first;
            sums.second += one.second;
        }
        tau += static_cast<double>(sums.tau);
        first += static_cast<double>(sums.first);
        second += static_cast<double>(sums.second);
    }
    if (in_picture(p, at)) device::write_sums(p, pixel_of(p, at), tau, first, second);
}

/// Slabs that a thread adds up at once, in its registers; a tile's Gaussians are read once for each such group.
template <int kChannels>
constexpr int kSlabGroup = kChannels == device::kMaximumChannels ? 16
                           : kChannels == device::kUnlitChannels ? 8
                                                                 : 4;

/// Sums of a group of slabs.
template <int kChannels>
__device__ void add_group(const ChordPicture& p, const TileEntries& entries, const TilePlace& at,
                          const device::ChordRay& ray, const device::RaySlabs& slabs,
                          device::Float3 direction, int group, ChordBatch& batch, float* sums) {
    const bool is_first = group == 0, is_last = group + kSlabGroup<kChannels> >= slabs.count;
    // Depths of the group's front and back.
    const float front = slabs.first + static_cast<float>(group) * slabs.depth;
    const float back = front + static_cast<float>(kSlabGroup<kChannels>) * slabs.depth;
    const float margin = 1e-3f * slabs.depth;  // more than the rounding of depths
    for (std::int64_t begin = 0; begin < entries.count; begin += ChordBatch::kCount) {
        const std::int64_t left = entries.count - begin;
        const int filled = left < ChordBatch::kCount ? static_cast<int>(left) : ChordBatch::kCount;
        __syncthreads();
        if (at.thread < filled) {
            const std::uint32_t i = p.entry[entries.at(begin + at.thread)];
            batch.used[at.thread] = 0;
            const float near = p.depths[i].near, far = p.depths[i].far;
            if ((is_first || far >= front - margin) && (is_last || near <= back + margin)) {
                load(p, i, at.thread, batch);
                batch.value[at.thread] = p.slabs.values[i];
            }
        }
        __syncthreads();
        for (int n = 0; n < filled; ++n) {
            Chord chord;
            if (!batch.used[n] || !chord_at(p, batch, n, ray, at, chord)) continue;
            const device::SplatValue& value = batch.value[n];
            const device::ValueAlong along =
                batch.splat[n].widened ? device::widened_value(value, batch.gaussian[n], p.within)
                                       : device::value_along(value, chord, direction);
            device::add_parts<kChannels>(chord, value, along, slabs, group, 0,
                                         kSlabGroup<kChannels>, sums);
        }
    }
}

template <int kChannels>
__global__ void __launch_bounds__(kBlock) slabs_kernel(ChordPicture p) {
    __shared__ ChordBatch batch;
    const TilePlace at = place_in(p.tile_columns);
    set_planes(p, at, batch);
    const device::ChordRay ray = device::chord_ray(p.camera, p.bounds, p.view, at.column, at.row);
    const device::Float3 direction = device::to_float(ray.ray.direction);
    const TileEntries entries = entries_of(p, at.tile);
    device::SlabsOfRay of_ray = device::slabs_of_ray(p.slabs, ray);
    const bool inside = in_picture(p, at);
    for (int sweep = 0; sweep < of_ray.sweeps(p.slabs); ++sweep)
        for (int group = 0; group < of_ray.slabs.count; group += kSlabGroup<kChannels>) {
            if (!__syncthreads_or(inside && !of_ray.dark())) break;
            float sums[kSlabGroup<kChannels> * kChannels] = {};
            add_group<kChannels>(p, entries, at, ray, of_ray.slabs, direction, group, batch, sums);
            VOG_UNROLL
            for (int n = 0; n < kSlabGroup<kChannels>; ++n)
                of_ray.add(p.slabs, sums + n * kChannels, sweep);
        }
    if (inside) of_ray.write(p.slabs, pixel_of(p, at));
}

}  // namespace

void launch_project_chords(const ChordProjection& projection) {
    start("projecting", project_chords_kernel, projection.count, projection);
}

void launch_chord_sums(const device::ChordPicture& picture, std::int64_t tiles) {
    start("adding up fields", chord_sums_kernel, tiles * kBlock, picture);
}

void launch_slabs(const device::ChordPicture& picture, std::int64_t tiles) {
    const auto add_up = [&](void (*kernel)(ChordPicture)) {
        start("adding up slabs", kernel, tiles * kBlock, picture);
    };
    switch (picture.slabs.channels) {
        case device::kMaximumChannels:
            return add_up(slabs_kernel<device::kMaximumChannels>);
        case device::kUnlitChannels:
            return add_up(slabs_kernel<device::kUnlitChannels>);
        default:
            return add_up(slabs_kernel<device::kLitChannels>);
    }
}

}  // namespace vog::gpu
