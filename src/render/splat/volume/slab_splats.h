// slab_splats.h: Light along the pixels and the depths of a projected Gaussian.
#pragma once

#include "render/by_value/value_light.h"
#include "render/splat/volume/slab_kernels.h"

namespace vog::splat {

using by_value::Light;
using by_value::Lighting;
using by_value::LightQuadratic;

/// A field of a model under a transfer function, in one picture.
struct SlabView {
    const Gaussians& gaussians;
    const ScalarField& field;
    const std::vector<LightQuadratic>& light;
    const Lighting& lighting;
    const CameraFrame& frame;  ///< relative to Gaussians::origin
    const Clipping& clip;      ///< likewise
    double cutoff = 0;         ///< k
    double unit = 1;           ///< SplatModel::unit
    double share = 0;          ///< variance_within(k)
    double depth = 0;  ///< along the view, subtracted from all depths: they keep their digits
};

/// A Gaussian that is drawn wider than it is has its mean light at each of its pixels.
SlabSplat slab_splat(const SlabView& view, const SplatOrigin& origin, const FarSplat& splat);

/// Range of a Gaussian's depths in front of the eye.
struct DepthRange {
    float near, far;
};
DepthRange depths_of(const SlabView& view, std::size_t i);

/// Sets the part of each ray that the clip leaves.
void set_clip(const SlabView& view, SlabCell& cell);

/// Adds the light of a near splat to the pixels of a cell, by the closed form.
void add_near_light(const SlabView& view, const NearSplat& splat, SlabCell& cell);

}  // namespace vog::splat
