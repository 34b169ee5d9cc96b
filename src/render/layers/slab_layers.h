// slab_layers.h: Pictures of several layers, models and voxels, by depth slabs that they share.
#pragma once

#include <span>

#include "render/by_value/volume_image.h"
#include "render/light/illumination.h"
#include "render/reference/fields/ray_light.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/camera.h"
#include "vog/clip.h"

namespace vog::layers {

/// Voxels of a layer.
struct VoxelLayer {
    reference::VoxelRays rays;
    Box box;  ///< holds them, world units
};

/// Draws layers that share their space: in each slab extinctions add up, and colours by their extinctions.
/// models   at least one, each with `slabs` slabs
/// clip     of the voxels; models have theirs
/// reached  light that reaches points of the world
/// picture  receives the result, the same bytes for any number of threads
void draw_slabs(std::span<SlabRenderer* const> models, std::span<const VoxelLayer> voxels,
                const Camera& camera, int slabs, const Clipping& clip,
                const lights::Illumination& reached, VolumeImage& picture);

}  // namespace vog::layers
