// optix_programs.cu: OptiX programs of the paper's Gaussian pipeline (its section 4.3) and SciVis
// renderer (4.4). Their computations are in render/device, which also runs and is tested on the CPU.
#include <optix.h>

#include "render/device/launch.h"
#include "render/device/voxels/voxel_sums.h"

using namespace vog::device;

extern "C" {
__constant__ Launch launch;
}

namespace {

/// Data of one ray; the two payload words are its address.
struct GaussianRay {
    Ray ray;
    DepthSum sum;
    unsigned hits;
    HitList* list;
};
struct VoxelData {
    VoxelRay ray;
    VoxelPixel pixel;
};

__device__ void pack(const void* data, unsigned& high, unsigned& low) {
    const auto address = reinterpret_cast<unsigned long long>(data);
    high = static_cast<unsigned>(address >> 32);
    low = static_cast<unsigned>(address);
}
template <class Data>
__device__ Data& payload() {
    const unsigned long long high = optixGetPayload_0();
    return *reinterpret_cast<Data*>(high << 32 | optixGetPayload_1());
}

/// Number of channels, known when compiled.
template <int kCount>
struct Channels {
    constexpr __device__ operator int() const { return kCount; }
};

/// Data of a ray of a picture of chords. The Ray comes first: intersections read nothing else.
struct ChordData {
    ChordRay chord;
    DepthSum tau, first, second;  ///< of a field
    SlabsOfRay of_ray;
    int32_t first_slab;  ///< of the sums
    float* sums;         ///< [kSlabsPerTraversal][channels] of slabs
};
/// Slabs that a ray adds up in one traversal, in its own memory: 896 bytes.
constexpr int kSlabsPerTraversal = 32;

/// data  payload, of which `ray` is the first member
template <class Data>
__device__ void trace(Data& data, const Ray& ray, float from) {
    const Float3 origin = to_float(ray.origin - launch.center);
    const Float3 direction = to_float(ray.direction);
    unsigned high, low;
    pack(&data, high, low);
    optixTrace(launch.traversable, make_float3(origin.x, origin.y, origin.z),
               make_float3(direction.x, direction.y, direction.z), from, ray.length + kRaySlack,
               0.0f, OptixVisibilityMask(255), OPTIX_RAY_FLAG_DISABLE_CLOSESTHIT, 0, 1, 0, high,
               low);
}

/// Sets the ray of this thread's pixel. returns false if it misses the bounds
__device__ bool pixel_ray(unsigned& pixel, Ray& ray) {
    const uint3 at = optixGetLaunchIndex();
    pixel = at.y * static_cast<unsigned>(launch.camera.width) + at.x;
    return camera_ray(launch.camera, launch.bounds, at.x + launch.film.x, at.y + launch.film.y,
                      ray);
}

/// T of the Gaussians that rays leave out.
__device__ double splatted_depth(unsigned pixel) {
    return launch.splatted ? static_cast<double>(launch.splatted[pixel]) : 0;
}

__device__ Hit reported_hit() {
    return {__uint_as_float(optixGetAttribute_0()), __uint_as_float(optixGetAttribute_1()),
            __uint_as_float(optixGetAttribute_2()), __uint_as_float(optixGetAttribute_3())};
}

/// The chord of the reported hit.
__device__ bool reported_chord(const ChordData& data, Chord& chord) {
    const unsigned i = optixGetPrimitiveIndex();
    const Gaussian g = launch.gaussians[i];  // whole: four loads
    return chord_of(g, data.chord.ray, reported_hit(), data.chord.ends, share_of(launch.shares, i),
                    chord);
}

__device__ ChordRay chord_ray_of_thread(unsigned& pixel, uint3& at) {
    at = optixGetLaunchIndex();
    pixel = at.y * static_cast<unsigned>(launch.camera.width) + at.x;
    return chord_ray(launch.camera, launch.bounds, launch.chords.view, at.x, at.y);
}

/// Calls add(Gaussian, chord) for the Gaussians that rays leave out.
template <class Add>
__device__ void each_widened(const ChordRay& ray, uint3 at, const Add& add) {
    const ChordPicture& p = launch.chords;
    if (!p.first) return;
    const auto column = static_cast<int32_t>(at.x), row = static_cast<int32_t>(at.y);
    const int32_t tile = row / kSplatTile * p.tile_columns + column / kSplatTile;
    for (uint64_t n = p.first[tile]; n < p.first[tile + 1]; ++n) {
        const uint32_t i = p.entry[n];
        Chord chord;
        if (widened_chord(p.splats[i], p.depths[i], p.kernel, ray, column, row, chord))
            add(i, chord);
    }
}

/// Adds a chord's sums, exactly in any order.
__device__ void add_sums(ChordData& data, const ChordSums& sums) {
    add_depth(data.tau, sums.tau, launch.rounding);
    add_signed(data.first, static_cast<double>(sums.first), launch.rounding);
    add_signed(data.second, static_cast<double>(sums.second), launch.rounding);
}

/// Adds a chord's moments to the slabs of the traversal.
__device__ void add_moments(ChordData& data, const SplatValue& value, const ValueAlong& at,
                            const Chord& chord) {
    const RaySlabs& slabs = data.of_ray.slabs;
    const SlabRun run = run_of(chord, slabs, data.first_slab, kSlabsPerTraversal);
    const auto add = [&](auto channels) {
        add_parts<channels>(chord, value, at, slabs, data.first_slab, run.begin, run.end,
                            data.sums);
    };
    switch (launch.chords.slabs.channels) {
        case kMaximumChannels:
            return add(Channels<kMaximumChannels>());
        case kUnlitChannels:
            return add(Channels<kUnlitChannels>());
        default:
            return add(Channels<kLitChannels>());
    }
}

/// Writes what a report asks for.
__device__ void count(unsigned pixel, unsigned hits, unsigned slabs) {
    if (!launch.counts) return;
    const RayCounts before = launch.film.earlier ? launch.counts[pixel] : RayCounts{0, 0, 0};
    launch.counts[pixel] = {before.hits + hits, before.slabs + slabs,
                            slabs > before.most_slabs ? slabs : before.most_slabs};
}

}  // namespace

extern "C" __global__ void __raygen__accumulate() {
    unsigned pixel;
    GaussianRay data{};
    if (pixel_ray(pixel, data.ray)) trace(data, data.ray, 0);
    count(pixel, data.hits, 0);
    expose(launch.film, pixel, splatted_depth(pixel) + data.sum.depth());
}

extern "C" __global__ void __raygen__collect() {
    unsigned pixel, slabs = 0;
    GaussianRay data{};
    HitList list;
    list.capacity = launch.hits_per_slab;
    data.list = &list;
    CollectedHit last{};
    const bool meets = pixel_ray(pixel, data.ray);
    // A ray ends where its own T and that of the splats are opaque.
    const double splatted = splatted_depth(pixel);
    for (bool more = meets && splatted < launch.stop_depth; more;) {
        begin_slab(list, slabs ? &last : nullptr);
        trace(data, data.ray, slab_start(list, launch.boxed));
        if (list.count == 0) break;
        ++slabs;
        sort_by_entry(list);
        last = list.hit[list.count - 1];
        data.hits += static_cast<unsigned>(list.count);
        more = integrate(list, launch.gaussians, launch.shares, data.ray, launch.cutoff2,
                         launch.stop_depth - splatted, launch.rounding, data.sum);
    }
    count(pixel, data.hits, slabs);
    expose(launch.film, pixel, splatted + data.sum.depth());
}

extern "C" __global__ void __intersection__gaussian() {
    const Ray& ray = payload<Ray>();
    if (share_of(launch.shares, optixGetPrimitiveIndex()) == 0) return;
    const Gaussian g = launch.gaussians[optixGetPrimitiveIndex()];
    Hit hit;
    if (!intersect(g, ray, launch.cutoff2, hit)) return;
    if (launch.boxed && !meets_box(g, ray, launch.scene)) return;
    optixReportIntersection(hit.entry(), 0, __float_as_uint(hit.nearest), __float_as_uint(hit.half),
                            __float_as_uint(hit.m2), __float_as_uint(hit.width));
}

extern "C" __global__ void __anyhit__accumulate() {
    GaussianRay& data = payload<GaussianRay>();
    const Hit hit = reported_hit();
    const Gaussian& g = launch.gaussians[optixGetPrimitiveIndex()];
    add_depth(data.sum, share_of(launch.shares, optixGetPrimitiveIndex()) * optical_depth(g, hit),
              launch.rounding);
    ++data.hits;
    optixIgnoreIntersection();
}

extern "C" __global__ void __anyhit__collect() {
    GaussianRay& data = payload<GaussianRay>();
    const bool room = collect(*data.list, {optixGetRayTmax(), optixGetPrimitiveIndex()});
    // A hit beyond a full list is accepted, which shortens the ray; all others are ignored.
    if (room || launch.boxed) optixIgnoreIntersection();
}

/// Called for every ray that a full list has not shortened. Empty: the result is in the payload, and
/// ray generation writes pixels of T = 0 as background.
extern "C" __global__ void __miss__gaussian() {}

extern "C" __global__ void __raygen__sums() {
    unsigned pixel;
    uint3 at;
    ChordData data{};
    data.chord = chord_ray_of_thread(pixel, at);
    const Float3 direction = to_float(data.chord.ray.direction);
    each_widened(data.chord, at, [&](uint32_t i, const Chord& chord) {
        add_sums(data,
                 sums_over(chord, widened_plane(launch.chords, i, launch.gaussians[i], direction),
                           direction));
    });
    if (data.chord.meets) trace(data, data.chord.ray, 0);
    write_sums(launch.chords, pixel, data.tau.depth(), data.first.depth(), data.second.depth());
}

extern "C" __global__ void __anyhit__sums() {
    ChordData& data = payload<ChordData>();
    Chord chord;
    if (reported_chord(data, chord)) {
        const Float3 direction = to_float(data.chord.ray.direction);
        add_sums(data,
                 sums_over(chord, plane_of(launch.chords, optixGetPrimitiveIndex(), direction),
                           direction));
    }
    optixIgnoreIntersection();
}

/// Depth slabs: moments are added to a slab in any order, so that no hit is kept, sorted or lost. Slabs beyond
/// kSlabsPerTraversal take another traversal, unless all before are opaque.
extern "C" __global__ void __raygen__slabs() {
    unsigned pixel;
    uint3 at;
    float sums[kSlabsPerTraversal * kLitChannels];
    ChordData data{};
    data.chord = chord_ray_of_thread(pixel, at);
    data.sums = sums;
    const SlabPicture& p = launch.chords.slabs;
    SlabsOfRay& of_ray = data.of_ray = slabs_of_ray(p, data.chord);
    for (int sweep = 0; sweep < of_ray.sweeps(p); ++sweep)
        for (int32_t group = 0; group < of_ray.slabs.count; group += kSlabsPerTraversal) {
            if (of_ray.dark()) break;
            for (float& sum : sums) sum = 0;
            data.first_slab = group;
            each_widened(data.chord, at, [&](uint32_t i, const Chord& chord) {
                add_moments(data, p.values[i],
                            widened_value(p.values[i], launch.gaussians[i], launch.chords.within),
                            chord);
            });
            if (data.chord.meets) trace(data, data.chord.ray, 0);
            for (int n = 0; n < kSlabsPerTraversal; ++n)
                of_ray.add(p, sums + n * p.channels, sweep);
        }
    of_ray.write(p, pixel);
}

extern "C" __global__ void __anyhit__slabs() {
    ChordData& data = payload<ChordData>();
    Chord chord;
    if (reported_chord(data, chord)) {
        const SplatValue value = launch.chords.slabs.values[optixGetPrimitiveIndex()];
        add_moments(data, value, value_along(value, chord, to_float(data.chord.ray.direction)),
                    chord);
    }
    optixIgnoreIntersection();
}

extern "C" __global__ void __raygen__voxels() {
    const uint3 at = optixGetLaunchIndex();
    const VoxelPicture& p = launch.voxels;
    VoxelData data{};
    for (int32_t n = 0; n < p.samples * p.samples; ++n) {
        const double x = at.x + ((n % p.samples + 0.5) / p.samples - 0.5);
        const double y = at.y + ((n / p.samples + 0.5) / p.samples - 0.5);
        Ray ray;
        if (!camera_ray(launch.camera, launch.bounds, x, y, ray)) continue;
        data.ray = voxel_ray(p, x, y);
        const Float3 origin = to_float(ray.origin - launch.center);
        const Float3 direction = to_float(ray.direction);
        unsigned high, low;
        pack(&data, high, low);
        optixTrace(launch.traversable, make_float3(origin.x, origin.y, origin.z),
                   make_float3(direction.x, direction.y, direction.z), 0.0f, ray.length + kRaySlack,
                   0.0f, OptixVisibilityMask(255), OPTIX_RAY_FLAG_DISABLE_ANYHIT, 0, 1, 0, high,
                   low);
    }
    write_pixel(p, at.y * static_cast<unsigned>(launch.camera.width) + at.x, data.pixel);
}

/// The only primitive is the box of the volumes; rays start on it or inside.
extern "C" __global__ void __intersection__voxels() {
    optixReportIntersection(optixGetRayTmin(), 0);
}

/// Adds up the voxels from the closest hit to the exit of the volumes.
extern "C" __global__ void __closesthit__voxels() {
    VoxelData& data = payload<VoxelData>();
    add_ray(launch.voxels, data.ray, data.pixel);
}
