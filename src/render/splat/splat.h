// splat.h: Splatting of Gaussians on the CPU: optical depth T per pixel, in object order.
// T is a plain sum over Gaussians: independent of their order, without a limit on hits, and the T
// of a union of models is the sum of their Ts.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/renderer.h"

namespace vog {

/// Optical depth of Gaussian i along o + t r, t >= 0, in double precision by the closed form
///   tau = a exp(-m^2/2) sqrt(pi/(2C)) [erf((t1-t*) sqrt(C/2)) - erf((t0-t*) sqrt(C/2))]
/// of the truncated kernel (docs/method.md, "One Gaussian along a ray"). Every renderer is tested
/// against this function.
/// direction  of any length > 0; tau does not depend on its length
double optical_depth(const Gaussians& gaussians, std::size_t i, Vec3d origin, Vec3d direction);

/// Options of a SplatRenderer.
struct SplatOptions {
    std::string simd_target{};  ///< one of splat_targets(); empty: the best
    Progress progress{};        ///< called with the finished fraction of each picture
    /// Half edges of the paper's bounding boxes, in its radii (scale sqrt(2)): a ray counts a
    /// Gaussian only if it meets the Gaussian's box, clipped to the model's box. >= 0; 0: no boxes.
    double aabb_sigma = 0;
    /// Cuts each kernel where it has fallen to this share of its peak, k = sqrt(-2 ln kappa), in
    /// place of the model's own cutoff. [1.3e-14, 1), or 0: the model's.
    double kappa = 0;
    /// Hierarchy of the model, which must outlive the renderer: each picture draws a cut through
    /// it. Null: all Gaussians. Excludes aabb_sigma.
    const Hierarchy* hierarchy = nullptr;
    CutOptions cut{};  ///< level of detail of the cuts; unused without a hierarchy
};

/// Renderer of one model from any number of cameras. Exact: each Gaussian's line integral at every
/// pixel centre that its projected support covers, in perspective; the camera may be near, inside
/// or behind Gaussians. Buffers are kept, so that a picture like the one before allocates no memory
/// (except with aabb_sigma). Not for two threads at once; each picture uses all threads.
class SplatRenderer {
  public:
    /// gaussians  must outlive the renderer, unchanged; validated once, here
    /// throws     vog::Error for a model or a hierarchy that validate() refuses, an unknown SIMD
    ///            target, a negative aabb_sigma, one beside a hierarchy, or a kappa out of range
    explicit SplatRenderer(const Gaussians& gaussians, const SplatOptions& options = {});
    ~SplatRenderer();
    SplatRenderer(SplatRenderer&&) noexcept;
    SplatRenderer& operator=(SplatRenderer&&) noexcept;

    /// image     T per pixel at extinction 1; the same bytes for any number of threads
    /// progress  of this picture, in place of SplatOptions::progress
    /// throws    vog::Error for an unusable camera or size, or more than 65536 pixels a side
    /// cost      O(Gaussians drawn + covered pixel rows + pixels) time, bounded extra memory
    void render(const Camera& camera, int width, int height, DepthImage& image,
                const Progress& progress = {});
    [[nodiscard]] DepthImage render(const Camera& camera, int width, int height);
    /// Level of detail of the next pictures.
    void set_cut(const CutOptions& cut);
    /// Space that counts in the next pictures: chords are cut exactly. A Gaussian smaller than a pixel counts by the share of
    /// the chord through its mean that stays. throws vog::Error as validate(Clipping) does
    void set_clip(const Clipping& clip);
    /// Cut of the last picture; without a hierarchy: all Gaussians of the model.
    CutReport cut_report() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture by a SplatRenderer. throws vog::Error as SplatRenderer does
[[nodiscard]] DepthImage render_splat(const Gaussians& gaussians, const Camera& camera, int width,
                                      int height, const SplatOptions& options = {});

}  // namespace vog
