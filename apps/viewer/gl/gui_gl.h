// gui_gl.h: renders Dear ImGui's draw lists in the viewer's OpenGL context. ImGui's own OpenGL
// backend loads libGL by itself, for the context of a window only.
#pragma once

#include "gl/gl_objects.h"

struct ImDrawData;

namespace vog::viewer {

class GuiGl {
  public:
    GuiGl();
    /// Uploads the font atlas; needed again after each change of it.
    void upload_fonts();
    /// Draws over the contents of the bound framebuffer.
    void draw(const ImDrawData& data) const;

  private:
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer vertices_, indices_;
    GlTexture font_;
};

}  // namespace vog::viewer
