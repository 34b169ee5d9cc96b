// gui_gl.h: draws what Dear ImGui has laid out. Its own OpenGL backend looks for libGL by itself
// and for a window's context only; this one goes where the rest of the viewer draws.
#pragma once

#include "gl/gl_objects.h"

struct ImDrawData;

namespace vog::viewer {

class GuiGl {
  public:
    GuiGl();
    /// Uploads the font atlas; again after it has changed.
    void upload_fonts();
    /// Over what is in the framebuffer that is bound.
    void draw(const ImDrawData& data) const;

  private:
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer vertices_, indices_;
    GlTexture font_;
};

}  // namespace vog::viewer
