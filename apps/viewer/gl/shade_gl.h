// shade_gl.h: shading of sums in OpenGL, one full-screen pass; the result of vog::shade, shade_map and over.
#pragma once

#include "gl/gl_objects.h"
#include "quantity/look.h"
#include "quantity/quantity.h"

namespace vog::viewer {

/// Image of accumulated sums in the device's memory.
struct GlDepth {
    const GlTarget* target = nullptr;
    double subframes = 1;  ///< number of sub-frames in the sum
};

/// Rectangle of the bound framebuffer that a picture fills.
struct Viewport {
    int x = 0, y = 0, width = 0, height = 0;  ///< pixels, y from the bottom
};

struct ShadeView {
    Show show = Show::depth;
    ColorScale scale{ColorScale::Kind::linear, 0, 1};  ///< of column, mean and deviation
    FieldUnit unit{};                                  ///< of the field in the sums
    float least_column = 0;                            ///< maps of a field show nothing below
    float split = 1;          ///< fraction of the width: A to the left, B to the right; 1: A only
    bool difference = false;  ///< shows V of A minus V of B
    float difference_limit =
        0.05f;  ///< at the ends of its colours: |V - V'|, a share of the scale, of colours
                ///< the mean of red, green and blue
    bool checker = true;  ///< checkerboard behind a transparent background
};

class GlShade {
  public:
    GlShade();
    /// Sets the look of later draws, whose range is of visibility alone. Its transfer function is sampled at 4096 values of V: steps in
    /// it move by up to 1/2048.
    void set_look(const Look& look);
    /// b  second image; may be `a` where only that is shown
    void draw(const GlDepth& a, const GlDepth& b, const ShadeView& view, const Viewport& to) const;

  private:
    GlProgram program_;
    GlVertexArray no_vertices_;
    GlTexture transfer_, map_;  ///< of visibility; of maps, whose range is their scale
    Look look_;
};

/// Values of a transfer function at V = (i / (count - 1))²: denser near 0, where gammas below 1 are
/// steep.
std::vector<Rgba> sampled(const TransferFunction& tf, std::size_t count);

}  // namespace vog::viewer
