// optix_programs.cu: OptiX programs of the paper's Gaussian pipeline (its section 4.3) and SciVis
// renderer (4.4). Their computations are in render/device, which also runs and is tested on the CPU.
#include <optix.h>

#include "render/device/launch.h"
#include "render/device/voxel_walk.h"

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
struct VoxelRay {
    Double3 origin, direction;  ///< in index space plus 1/2
    double sum;
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

__device__ void trace(GaussianRay& data, float from) {
    const Float3 origin = to_float(data.ray.origin - launch.center);
    const Float3 direction = to_float(data.ray.direction);
    unsigned high, low;
    pack(&data, high, low);
    optixTrace(launch.traversable, make_float3(origin.x, origin.y, origin.z),
               make_float3(direction.x, direction.y, direction.z), from,
               data.ray.length + kRaySlack, 0.0f, OptixVisibilityMask(255),
               OPTIX_RAY_FLAG_DISABLE_CLOSESTHIT, 0, 1, 0, high, low);
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
    if (pixel_ray(pixel, data.ray)) trace(data, 0);
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
        trace(data, slab_start(list, launch.boxed));
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
    const GaussianRay& data = payload<GaussianRay>();
    if (share_of(launch.shares, optixGetPrimitiveIndex()) == 0) return;
    const Gaussian g = launch.gaussians[optixGetPrimitiveIndex()];
    Hit hit;
    if (!intersect(g, data.ray, launch.cutoff2, hit)) return;
    if (launch.boxed && !meets_box(g, data.ray, launch.scene)) return;
    optixReportIntersection(hit.entry(), 0, __float_as_uint(hit.nearest), __float_as_uint(hit.half),
                            __float_as_uint(hit.m2), __float_as_uint(hit.width));
}

extern "C" __global__ void __anyhit__accumulate() {
    GaussianRay& data = payload<GaussianRay>();
    const Hit hit{__uint_as_float(optixGetAttribute_0()), __uint_as_float(optixGetAttribute_1()),
                  __uint_as_float(optixGetAttribute_2()), __uint_as_float(optixGetAttribute_3())};
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

extern "C" __global__ void __raygen__voxels() {
    unsigned pixel;
    Ray ray;
    VoxelRay data{};
    if (pixel_ray(pixel, ray)) {
        const uint3 at = optixGetLaunchIndex();
        const double x = at.x + launch.film.x, y = at.y + launch.film.y;
        const Camera& camera = launch.index_camera;
        data.origin = camera.eye + x * camera.shift_x + y * camera.shift_y;
        data.direction = camera.corner + x * camera.step_x + y * camera.step_y;
        const Float3 origin = to_float(ray.origin - launch.center);
        const Float3 direction = to_float(ray.direction);
        unsigned high, low;
        pack(&data, high, low);
        optixTrace(launch.traversable, make_float3(origin.x, origin.y, origin.z),
                   make_float3(direction.x, direction.y, direction.z), 0.0f, ray.length + kRaySlack,
                   0.0f, OptixVisibilityMask(255), OPTIX_RAY_FLAG_DISABLE_ANYHIT, 0, 1, 0, high,
                   low);
        // A unit of t is |D| world units long, D the camera's direction of this pixel.
        const Double3 along =
            launch.camera.corner + x * launch.camera.step_x + y * launch.camera.step_y;
        data.sum *= sqrt(dot(along, along));
    }
    expose(launch.film, pixel, data.sum);
}

/// The only primitive is the box of the grid; rays start on it or inside.
extern "C" __global__ void __intersection__voxels() {
    optixReportIntersection(optixGetRayTmin(), 0);
}

/// Integrates the voxels from the closest hit to the exit of the volume.
extern "C" __global__ void __closesthit__voxels() {
    VoxelRay& data = payload<VoxelRay>();
    data.sum = walk_voxels(*static_cast<const nanovdb::NanoGrid<float>*>(launch.grid), data.origin,
                           data.direction);
}
