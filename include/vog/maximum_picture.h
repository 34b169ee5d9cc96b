// vog/maximum_picture.h: options of pictures by depth slabs.
#pragma once

#include <string>

#include "vog/volume_picture.h"

namespace vog {

struct Collective;

/// Options of a SlabRenderer.
struct SlabOptions {
    int slabs = kVolumeSlabs;   ///< depth slabs a tile, 1 to 1024
    std::string simd_target{};  ///< one of splat_targets(); empty: the best
    double kappa = 0;           ///< as SplatOptions::kappa
    VolumeLook look{};
    /// Processes that each hold a part of the model and make the same calls (vog-mpi); pictures are complete on the
    /// root. Null: this process has all of it.
    const Collective* collective = nullptr;
};

}  // namespace vog
