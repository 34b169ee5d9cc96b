// vog/splat.h: Gaussians and a camera in, optical depth out. T is a plain sum over Gaussians, so
// no order, no hit limit, no seams: the T of a union is the sum of the Ts.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/progress.h"

namespace vog {

/// Optical depth of Gaussian i along o + t r, t >= 0, in double precision by the closed form
///   tau = a exp(-m^2/2) sqrt(pi/(2C)) [erf((t1-t*) sqrt(C/2)) - erf((t0-t*) sqrt(C/2))]
/// of the truncated kernel (docs/method.md, "One Gaussian along a ray"). What every renderer is
/// tested against. direction need not have unit length; tau is per world unit of length all the
/// same.
double optical_depth(const Gaussians& gaussians, std::size_t i, Vec3d origin, Vec3d direction);

struct SplatOptions {
    std::string simd_target{};  ///< one of splat_targets(); empty: the best
    Progress progress{};
    /// The paper's bounding boxes: a ray counts a Gaussian only if it meets the box of this many
    /// times the paper's radii (scale sqrt(2)) around its mean, within the model's box. 0: no
    /// boxes.
    double aabb_sigma = 0;
    /// Cuts each kernel where it has fallen to this share of its peak, k = sqrt(-2 ln kappa), in
    /// place of the model's own cutoff. [1.3e-14, 1), or 0: the model's.
    double kappa = 0;
    /// Of the model, which it must outlive as the model does: each picture draws a cut through it.
    /// Null: all Gaussians. Does not go with aabb_sigma.
    const Hierarchy* hierarchy = nullptr;
    CutOptions cut{};
};

/// SIMD targets of the splat renderer that this machine can run, best first: "AVX2", ..., "scalar".
std::vector<std::string> splat_targets();

/// Object order and exact: each Gaussian's line integral at every pixel centre its projected
/// support covers, perspective included; the camera may be near, inside or behind Gaussians. Made
/// for many pictures of one model: its buffers last, so that a frame like the one before allocates
/// nothing (but with aabb_sigma). Not for two threads at once; each picture uses all of them.
class SplatRenderer {
  public:
    /// gaussians  must outlive the renderer and stay as they are
    /// throws     vog::Error for a model or a hierarchy that validate() refuses, an unknown SIMD
    ///            target, a negative aabb_sigma, one beside a hierarchy, or a kappa out of range
    explicit SplatRenderer(const Gaussians& gaussians, const SplatOptions& options = {});
    ~SplatRenderer();
    SplatRenderer(SplatRenderer&&) noexcept;
    SplatRenderer& operator=(SplatRenderer&&) noexcept;

    /// image   T per pixel at extinction 1; the same bytes for any number of threads
    /// throws  vog::Error for an unusable camera or size, or more than 65536 pixels a side
    /// progress  of this picture, instead of SplatOptions::progress
    /// cost    O(Gaussians drawn + covered pixel rows + pixels), bounded extra memory
    void render(const Camera& camera, int width, int height, DepthImage& image,
                const Progress& progress = {});
    [[nodiscard]] DepthImage render(const Camera& camera, int width, int height);
    /// How much of the next pictures' hierarchy is drawn.
    void set_cut(const CutOptions& cut);
    /// Of the last picture; all leaves where there is no hierarchy.
    CutReport cut_report() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture by a SplatRenderer. throws vog::Error as it does
[[nodiscard]] DepthImage render_splat(const Gaussians& gaussians, const Camera& camera, int width,
                                      int height, const SplatOptions& options = {});

}  // namespace vog
