// slab_layers.h: Pictures of several layers, models, voxels and surfaces, by depth slabs that they share.
#pragma once

#include <memory>
#include <span>

#include "render/by_value/volume_image.h"
#include "render/light/illumination.h"
#include "render/reference/fields/ray_light.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/camera.h"
#include "vog/clip.h"

namespace vog::layers {

/// Draws layers that share their space: in each slab extinctions add up, and colours by their extinctions.
/// Surfaces hide what lies behind them: exactly of voxels, of models by the share of a slab.
/// models   at least one, each with `slabs` slabs
/// rays     voxels and surfaces, as of render_layers_reference; of models in parts surfaces alone, the same in each process
/// box      holds the voxels, world units; may be empty
/// clip     of the rays; models have theirs
/// reached    light that reaches points of the world
/// processes  that hold parts of the models; null: this one alone
/// picture    receives the result, the same bytes for any number of threads; complete on the root
void draw_slabs(std::span<SlabRenderer* const> models,
                std::span<const std::unique_ptr<reference::LitRays>> rays, const Box& box,
                const Camera& camera, int slabs, const Clipping& clip,
                const lights::Illumination& reached, const Collective* processes,
                VolumeImage& picture);

}  // namespace vog::layers
