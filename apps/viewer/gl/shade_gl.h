// shade_gl.h: T to colour in OpenGL, as vog::shade does it, in one pass over the pixels.
#pragma once

#include "gl/gl_objects.h"
#include "session/look.h"

namespace vog::viewer {

/// An image of T on the device.
struct GlDepth {
    const GlTarget* target = nullptr;
    double subframes = 1;  ///< how many were added up in it
};

/// Where a picture goes in the framebuffer that is bound.
struct Viewport {
    int x = 0, y = 0, width = 0, height = 0;  ///< pixels, y from the bottom
};

struct ShadeView {
    float split = 1;                 ///< of the width: image A left of it, B right; 1: A alone
    bool difference = false;         ///< V of A minus V of B instead
    float difference_limit = 0.05f;  ///< |V - V'| at the ends of its scale
    bool checker = true;             ///< a clear background shows as chequered
};

class GlShade {
  public:
    GlShade();
    /// From now on. Sampled at 4096 places: steps of the map are moved by up to 1/2048 of V.
    void set_look(const Look& look);
    /// b  may be a, where nothing of it is shown
    void draw(const GlDepth& a, const GlDepth& b, const ShadeView& view, const Viewport& to) const;

  private:
    GlProgram program_;
    GlVertexArray no_vertices_;
    GlTexture transfer_;
    Look look_;
};

/// Values of a transfer function at V = (i / (count - 1))²: finer where a gamma below 1 is steep.
std::vector<Rgba> sampled(const TransferFunction& tf, std::size_t count);

}  // namespace vog::viewer
