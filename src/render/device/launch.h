// device/launch.h: the launch parameters of the OptiX programs, and the names of their entry
// points: the host looks programs up by these, and a test looks for each in the compiled module.
#pragma once

#include "render/device/any_hit.h"
#include "render/device/camera_ray.h"
#include "render/device/color_table.h"
#include "render/device/gaussian_hit.h"

#define VOG_RAYGEN_ACCUMULATE "__raygen__accumulate"
#define VOG_RAYGEN_COLLECT "__raygen__collect"
#define VOG_INTERSECTION_GAUSSIAN "__intersection__gaussian"
#define VOG_ANYHIT_ACCUMULATE "__anyhit__accumulate"
#define VOG_ANYHIT_COLLECT "__anyhit__collect"
#define VOG_MISS_GAUSSIAN "__miss__gaussian"
#define VOG_RAYGEN_VOXELS "__raygen__voxels"
#define VOG_INTERSECTION_VOXELS "__intersection__voxels"
#define VOG_CLOSESTHIT_VOXELS "__closesthit__voxels"
#define VOG_MISS_VOXELS "__miss__voxels"

namespace vog::device {

constexpr int kPayloadWords = 2;    ///< a pointer to the ray's own data
constexpr int kAttributeWords = 4;  ///< Hit

/// What a launch writes, for either pipeline.
struct Film {
    float* depth;          ///< [height * width] T at extinction 1 through pixel centres
    Float4* accumulation;  ///< [height * width] colours summed over subframes, or null
    uint32_t subframe;     ///< 0: through pixel centres; later ones through other points of them
    ColorTable colors;
};

struct Launch {
    uint64_t traversable;
    Camera camera;
    Bounds bounds;
    Film film;

    // The Gaussian pipeline.
    const Gaussian* gaussians;
    Double3 center;  ///< the hierarchy's origin
    Bounds scene;
    SumRounding rounding;
    double stop_depth;
    float cutoff2;
    int32_t boxed;
    int32_t hits_per_slab;
    unsigned long long* hits;  ///< counters, or null
    unsigned long long* slabs;
    unsigned int* most_slabs;

    // The SciVis pipeline.
    const void* grid;     ///< nanovdb::NanoGrid<float>
    Camera index_camera;  ///< in index space plus a half: the same t as `camera`
};

/// Where in its pixel a subframe's ray passes: the centre, then the R2 sequence (M. Roberts, 2018),
/// the plane's most even one.
VOG_HD void pixel_point(uint32_t subframe, double& x, double& y) {
    const double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
    x = 0.5 + subframe * step_x, y = 0.5 + subframe * step_y;
    x = x - floor(x) - 0.5, y = y - floor(y) - 0.5;
}

/// Writes one ray's T, and its colour onto the progressive sum.
VOG_HD void expose(const Film& film, uint32_t pixel, double depth) {
    const float total = static_cast<float>(depth);
    film.depth[pixel] = total;
    if (!film.accumulation) return;
    const Float4 color = shade(film.colors, total);
    const Float4 sum = film.subframe ? film.accumulation[pixel] : Float4{0, 0, 0, 0};
    film.accumulation[pixel] = {sum.x + color.x, sum.y + color.y, sum.z + color.z, sum.w + color.w};
}

}  // namespace vog::device
