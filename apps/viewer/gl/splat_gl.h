// splat_gl.h: splatting in OpenGL: one quad per Gaussian with its exact projected bounds, the exact
// line integral per fragment, additive blending. T is a sum, so there is no sorting and no depth
// buffer.
#pragma once

#include "gl/gl_objects.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"

namespace vog::viewer {

/// Model in the device's memory.
class GlModel {
  public:
    /// Uploads a model, with positions relative to its box's centre (subtracted in double
    /// precision) and lengths in units of the box's radius, so that floats suffice anywhere in the
    /// world.
    explicit GlModel(const Gaussians& gaussians);

    std::size_t size() const { return size_; }
    GLuint vertex_array() const { return array_; }
    /// Binds the buffer to the attributes of the bound vertex array, one set an instance.
    void set_attributes() const;
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

/// Offset of a ray from its pixel's centre, right and down, pixels.
struct Jitter {
    double x = 0, y = 0;
};
/// Offset of sub-frame n: 0 is the centre, then the low-discrepancy sequence R2. Source: M.
/// Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018).
Jitter jitter_of(int subframe);

/// Sets the uniforms of a camera in splat.vert and the fragments that follow it; the program is in use.
/// clip  a box and up to ten planes
/// throws  vog::Error for more planes
void set_view(const GlProgram& program, const GlModel& model, const CameraFrame& frame,
              Jitter jitter, const Clipping& clip = {});
/// Draws the instances of a vertex array into the bound framebuffer, added up.
/// equation  GL_FUNC_ADD or GL_MAX
void draw_gaussians(GLuint vertex_array, std::size_t count, GLenum equation = GL_FUNC_ADD);
/// Binds numbers of the bound buffer to an attribute of the bound vertex array.
/// floats, offset  of one Gaussian's set; of the attribute in it
void set_attribute(GLuint place, GLint count, std::size_t floats, std::size_t offset);

class GlSplat {
  public:
    GlSplat();
    /// Adds T of the model at extinction 1 to `target` (R32F, rows from the top).
    void add(const GlModel& model, const Camera& camera, Jitter jitter,
             const GlTarget& target) const;

  private:
    GlProgram program_;
};

/// T of a model as Renderer::splat draws it, rendered by OpenGL: one call for one image.
DepthImage render_gl(const Gaussians& gaussians, const Camera& camera, int width, int height,
                     int subframes = 1);

}  // namespace vog::viewer
