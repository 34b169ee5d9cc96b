// near_splats.cpp: Splats that a clip leaves, hides and cuts.
#include "render/splat/near/near_splats.h"

#include <cmath>

#include "render/splat/fields/projected_mean.h"

namespace vog::splat {

using clipping::Kept;

namespace {

/// Scales the T of a splat.
/// returns  false where nothing is left, or its forms leave the range of floats
bool scale_depth(FarSplat& splat, double share) {
    constexpr double kLeast = 1e-6;
    if (!(share > kLeast)) return false;
    const auto by = static_cast<float>(1 / share);
    for (float* form : {&splat.ax, &splat.ay, &splat.a0, &splat.by, &splat.b0, &splat.cx, &splat.cy,
                        &splat.c0, &splat.dy, &splat.d0})
        *form *= by;
    splat.f0 *= by * by;
    splat.e02 *= by * by;
    return std::isfinite(splat.f0) && std::isfinite(splat.e02);
}

/// Peak of a splat that is not widened, in SplatModel::unit. Small ones have another than their Gaussian's, for their sum
/// over pixels (splat_widen-inl.h). e02 is 1 / (spread peak)², spread along the view; of parallel rays |W f|² / peak².
double peak_of(const FarSplat& splat, const Gaussians& gaussians, std::size_t i,
               const CameraFrame& frame) {
    const Vec3d scale = vec_cast<double>(gaussians.scale[i]);
    const Vec3d own = own_forward(gaussians, i, frame);
    const double root = std::sqrt(double{splat.e02});
    return frame.orthographic ? length(over(own, scale)) / root
                              : 1 / (length(times(own, scale)) * root);
}

}  // namespace

bool SplatClip::keep(const SplatOrigin& origin, FarSplat& splat,
                     std::vector<NearSplat>& near) const {
    const std::size_t i = origin.index;
    const Kept kept = clip.of(i);
    if (kept != Kept::part) return kept == Kept::all;
    if (origin.widened) return scale_depth(splat, clip.share_at_mean(i, frame));
    const Gaussians& gaussians = *model.gaussians;
    NearSplat& cut = near.emplace_back(near_splat(model, i, frame, whitening(gaussians, i)));
    cut.bounds = splat.bounds;
    cut.density = peak_of(splat, gaussians, i, frame);
    cut.clipped = true;
    return false;
}

void SplatClip::keep(std::vector<NearSplat>& near) const {
    std::size_t count = 0;
    for (NearSplat& splat : near) {
        const Kept kept = clip.of(splat.index);
        if (kept == Kept::none) continue;
        splat.clipped = kept == Kept::part;
        near[count++] = splat;
    }
    near.resize(count);
}

void SplatClip::keep(ProjectedSplats& splats, SplatChunk& chunk) const {
    keep(chunk.near);
    std::size_t kept = chunk.slot;
    for (std::size_t n = chunk.slot; n < chunk.slot + chunk.count; ++n) {
        if (!keep(splats.origin[n], splats.far[n], chunk.near)) continue;
        if (kept != n) {
            splats.far[kept] = splats.far[n];
            splats.bounds[kept] = splats.bounds[n];
            splats.origin[kept] = splats.origin[n];
        }
        ++kept;
    }
    chunk.count = kept - chunk.slot;
}

void SplatClip::find(int column, int row, TileRays& rays) const {
    for (int y = 0; y < kTileHeight; ++y)
        for (int x = 0; x < kTileWidth; ++x)
            rays.kept[y][x] =
                clip.ray(frame.origin(column + x, row + y), frame.direction(column + x, row + y));
}

}  // namespace vog::splat
