// near_splats.h: Gaussians that the eye or a clip may cut, as they are integrated along each ray, and splats beside a clip.
#pragma once

#include <vector>

#include "render/clipping/clipped_gaussians.h"
#include "render/splat/projected_splats.h"

namespace vog::splat {

/// Gaussian i over the whole image.
/// w      its whitening
/// frame  relative to Gaussians::origin
inline NearSplat near_splat(const SplatModel& model, std::size_t i, const CameraFrame& frame,
                            const Mat3& w) {
    NearSplat s;
    s.bounds.x1 = static_cast<std::uint16_t>(frame.width - 1);
    s.bounds.y1 = static_cast<std::uint16_t>(frame.height - 1);
    s.e = w * (vec_cast<double>(model.gaussians->mean[i]) - frame.first_origin);
    s.shift_x = w * (-frame.shift_x);
    s.shift_y = w * (-frame.shift_y);
    s.corner = w * frame.corner;
    s.step_x = w * frame.step_x;
    s.step_y = w * frame.step_y;
    s.density = double{model.gaussians->density[i]} / model.unit;
    s.index = i;
    return s;
}

/// Clip of a picture's Gaussians: hidden ones are left out, and those that it cuts become near splats.
struct SplatClip {
    const clipping::GaussianClip& clip;
    const SplatModel& model;
    const CameraFrame& frame;  ///< relative to Gaussians::origin

    bool empty() const { return clip.empty(); }
    /// A far splat that the clip cuts is appended to `near`. A Gaussian that is drawn wider than it is stays far, with the share
    /// of the chord through its mean that stays.
    /// returns  whether it is still a far splat
    bool keep(const SplatOrigin& origin, FarSplat& splat, std::vector<NearSplat>& near) const;
    /// Removes hidden splats, and marks those that the clip may cut.
    void keep(std::vector<NearSplat>& near) const;
    /// Both, of a chunk with origins.
    void keep(ProjectedSplats& splats, SplatChunk& chunk) const;
    /// Rays of the tile whose first pixel is (column, row).
    void find(int column, int row, TileRays& rays) const;
};

/// Rays of a tile, found for the first splat that needs them.
class LazyRays {
  public:
    LazyRays(const SplatClip& clip, int column, int row, TileRays& rays)
        : clip_(clip), column_(column), row_(row), rays_(rays) {}
    const TileRays& of(const NearSplat& splat) {
        if (splat.clipped && !found_) {
            clip_.find(column_, row_, rays_);
            found_ = true;
        }
        return rays_;
    }

  private:
    const SplatClip& clip_;
    int column_, row_;
    TileRays& rays_;
    bool found_ = false;
};

}  // namespace vog::splat
