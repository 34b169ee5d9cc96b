// slab_splats.h: A field along the pixels and the depths of a projected Gaussian.
#pragma once

#include "render/by_value/slab_moments.h"
#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

/// A field of a model in one picture.
struct SlabView {
    const Gaussians& gaussians;
    const ScalarField& field;
    const by_value::ValueRange& range;
    const CameraFrame& frame;  ///< relative to Gaussians::origin
    const Clipping& clip;      ///< likewise
    double cutoff = 0;         ///< k
    double share = 0;          ///< variance_within(k)
    double length = 1;         ///< of gradients: shares of the range over it, world units
    double depth = 0;  ///< along the view, subtracted from all depths: they keep their digits
};

/// A Gaussian that is drawn wider than it is has its mean value at each of its pixels.
SlabSplat slab_splat(const SlabView& view, const SplatOrigin& origin, const FarSplat& splat);

/// Range of a Gaussian's depths in front of the eye.
struct DepthRange {
    float near, far;
    void include(const DepthRange& other) {
        near = std::min(near, other.near);
        far = std::max(far, other.far);
    }
    bool empty() const { return !(near <= far); }
};
DepthRange depths_of(const SlabView& view, std::size_t i);

/// Sets the part of each ray that the clip leaves.
void set_clip(const SlabView& view, SlabCell& cell);

/// Adds a near splat to the pixels of a cell, by the closed form.
void add_near_splat(const SlabView& view, const NearSplat& splat, SlabCell& cell);

}  // namespace vog::splat
