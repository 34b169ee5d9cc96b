// chord_kernels.h: Passes of pictures of chords on the GPU: fields, values, clipped T. The kernels are compiled by nvcc
// (chord_kernels.cu); this interface has plain pointers only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/device/chord_picture.h"

namespace vog::gpu {

/// Arguments of the projection of a model for a picture of chords.
struct ChordProjection {
    device::ChordPicture picture;  ///< gaussians, camera, view
    device::SplatKernel kernel;
    std::int32_t count;  ///< Gaussians
    std::int32_t all;    ///< 1: all that are visible, 0: those that rays leave out
    std::int32_t
        boxed;      ///< 1: with the paper's boxes, where rays leave out none; for the range alone
    float* shares;  ///< [count] receives share_of()
    device::TileSplat* splats;   ///< [count]
    device::SplatDepth* depths;  ///< [count]
    std::uint64_t* touched;      ///< [count] receives the number of tiles
    std::uint32_t* near;         ///< number of Gaussians at the plane of the eye is added to it
    std::uint32_t* range;        ///< SlabPicture::range, cleared; null: a picture of sums
};
void launch_project_chords(const ChordProjection& projection);

/// Adds up the sums of a field in all tiles.
/// tiles  number of them
void launch_chord_sums(const device::ChordPicture& picture, std::int64_t tiles);
/// Adds up and composites the slabs of all tiles.
void launch_slabs(const device::ChordPicture& picture, std::int64_t tiles);

}  // namespace vog::gpu
