// launch.h: Launch parameters of the OptiX programs, and the names of their entry points, by which
// the host finds the programs in the compiled module.
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

namespace vog::device {

constexpr int kPayloadWords = 2;    ///< a pointer to the ray's own data
constexpr int kAttributeWords = 4;  ///< Hit

/// Output of a launch, for both pipelines.
struct Film {
    float* depth;          ///< [height * width] T at extinction 1 through pixel centres
    Float4* accumulation;  ///< [height * width] colours summed over subframes, or null
    double depth_unit;     ///< T of one unit of a ray's depth
    uint32_t subframe;     ///< 0: rays through pixel centres; > 0: through other points of pixels
    ColorTable colors;
};

/// Work of one ray, for reports.
struct RayCounts {
    uint32_t hits, slabs;
};

/// Launch parameters of both pipelines.
struct Launch {
    uint64_t traversable;
    Camera camera;
    Bounds bounds;
    Film film;

    // The Gaussian pipeline.
    const Gaussian* gaussians;
    const float* shares;    ///< of the Gaussians, or null: share_of()
    const float* splatted;  ///< [height * width] T of the Gaussians of share 0, or null
    Double3 center;         ///< origin of the hierarchy's coordinates, scene units
    Bounds scene;           ///< TraceModel::scene
    SumRounding rounding;
    double stop_depth;  ///< in film.depth_unit, as all depths of the Gaussian pipeline
    float cutoff2;
    int32_t boxed;
    int32_t hits_per_slab;
    RayCounts* counts;  ///< [height * width], or null

    // The SciVis pipeline.
    const void* grid;     ///< nanovdb::NanoGrid<float>
    Camera index_camera;  ///< in index space plus 1/2: the same t as `camera`
};

/// Sample point of a subframe in its pixel, [-1/2, 1/2]²: the centre, then the low-discrepancy R2
/// sequence (M. Roberts, 2018).
VOG_HD void pixel_point(uint32_t subframe, double& x, double& y) {
    const double step_x = 0.7548776662466927, step_y = 0.5698402909980532;
    x = 0.5 + subframe * step_x, y = 0.5 + subframe * step_y;
    x = x - floor(x) - 0.5, y = y - floor(y) - 0.5;
}

/// Writes T of one ray, and adds its colour to the progressive sum.
/// depth  in film.depth_unit
VOG_HD void expose(const Film& film, uint32_t pixel, double depth) {
    const float total = static_cast<float>(depth * film.depth_unit);
    film.depth[pixel] = total;
    if (!film.accumulation) return;
    const Float4 color = shade(film.colors, total);
    const Float4 sum = film.subframe ? film.accumulation[pixel] : Float4{0, 0, 0, 0};
    film.accumulation[pixel] = {sum.x + color.x, sum.y + color.y, sum.z + color.z, sum.w + color.w};
}

}  // namespace vog::device
