// splat_gl.h: the splat renderer in OpenGL: each Gaussian one quad of its exact projected bounds,
// the exact line integral in the fragment, additive blending. T is a sum: no sorting, no depth
// buffer.
#pragma once

#include "gl/gl_objects.h"
#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog::viewer {

/// A model in the device's memory.
class GlModel {
  public:
    /// Positions are taken from the box's centre in double precision, lengths in units of its
    /// radius, so that floats serve any place and size in the world.
    explicit GlModel(const Gaussians& gaussians);

    std::size_t size() const { return size_; }
    GLuint vertex_array() const { return array_; }
    Vec3d center() const { return center_; }
    double unit() const { return unit_; }  ///< world units per unit of the buffer
    float cutoff() const { return cutoff_; }

  private:
    std::size_t size_ = 0;
    Vec3d center_;
    double unit_ = 1;
    float cutoff_ = 0;
    GlVertexArray array_;
    GlBuffer buffer_;
};

/// Where in its pixel a ray passes, from the centre, rightwards and downwards, in pixels.
struct Jitter {
    double x = 0, y = 0;
};
/// Of sub-frame n: the centre first, then a sequence that fills the pixel evenly however many are
/// taken: R2, M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018).
Jitter jitter_of(int subframe);

class GlSplat {
  public:
    GlSplat();
    /// Adds the model's T at extinction 1 to `target` (R32F, rows from the top).
    void add(const GlModel& model, const Camera& camera, Jitter jitter,
             const GlTarget& target) const;

  private:
    GlProgram program_;
};

/// Everything at once, for one picture: what render_splat gives, drawn by OpenGL.
DepthImage render_gl(const Gaussians& gaussians, const Camera& camera, int width, int height,
                     int subframes = 1);

}  // namespace vog::viewer
