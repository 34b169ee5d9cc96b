// chord_picture.h: A picture of chords on a GPU: what the rays of CUDA's splat and of OptiX add up, and where it is written.
#pragma once

#include "render/device/chord.h"
#include "render/device/slab_sums.h"

namespace vog::device {

/// Data of all rays, in GPU memory.
struct ChordPicture {
    ChordView view;
    Bounds bounds;
    Camera camera;
    Kernel kernel;
    float within;       ///< SplatKernel::variance
    double depth_unit;  ///< TraceModel::depth_unit
    const Gaussian* gaussians;

    // Projected Gaussians of the tiles, CUDA: all, OptiX: those that rays leave out. OptiX with boxes: none, null.
    const float* shares;  ///< share_of()
    const TileSplat* splats;
    const SplatDepth* depths;
    const uint64_t* first;  ///< entries of tile t: first[t] ... first[t + 1] - 1
    const uint32_t* entry;  ///< Gaussians
    int64_t near_first,
        near_last;  ///< entries of Gaussians at the plane of the eye, which all tiles have
    int32_t tile_columns;

    // Sums of a field; neither array: of the column alone.
    const ScalarPlane* scalar;
    const VectorPlane* vector;
    float* column;            ///< [height * width] T at extinction 1
    float *mean, *deviation;  ///< [height * width], or null

    SlabPicture slabs;
};

/// The field in Gaussian i along a ray.
VOG_HD ScalarPlane plane_of(const ChordPicture& p, uint32_t i, Float3 direction) {
    if (p.scalar) return along(p.scalar[i], direction);
    if (p.vector) return along(p.vector[i], direction);
    return {0, {0, 0, 0}, 0};
}
VOG_HD ScalarPlane widened_plane(const ChordPicture& p, uint32_t i, const Gaussian& g,
                                 Float3 direction) {
    return constant(plane_of(p, i, direction), g, p.within);
}

/// Writes the sums of a pixel.
VOG_HD void write_sums(const ChordPicture& p, uint32_t pixel, double tau, double first,
                       double second) {
    float mean, deviation;
    finish_sums(tau, first, second, p.depth_unit, p.column + pixel, &mean, &deviation);
    if (!p.mean) return;
    p.mean[pixel] = mean;
    p.deviation[pixel] = deviation;
}

}  // namespace vog::device
