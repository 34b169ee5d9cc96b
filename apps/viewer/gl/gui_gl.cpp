// gui_gl.cpp: textured triangles with scissor rectangles.
#include "gl/gui_gl.h"

#include <imgui.h>

#include <cstddef>
#include <cstdint>

namespace vog::viewer {

GuiGl::GuiGl()
    : program_("gui.vert", {"gui.frag"}),
      array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()) {
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    const auto attribute = [](GLuint place, GLint count, GLenum type, bool unit,
                              std::size_t offset) {
        glEnableVertexAttribArray(place);
        glVertexAttribPointer(place, count, type, unit, sizeof(ImDrawVert),
                              reinterpret_cast<const void*>(offset));
    };
    attribute(0, 2, GL_FLOAT, false, offsetof(ImDrawVert, pos));
    attribute(1, 2, GL_FLOAT, false, offsetof(ImDrawVert, uv));
    attribute(2, 4, GL_UNSIGNED_BYTE, true, offsetof(ImDrawVert, col));
    glBindVertexArray(0);
}

void GuiGl::upload_fonts() {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
    GLuint name = 0;
    glGenTextures(1, &name);
    font_ = GlTexture(name);
    glBindTexture(GL_TEXTURE_2D, font_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    atlas.SetTexID(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(name)));
}

void GuiGl::draw(const ImDrawData& data) const {
    const ImVec2 scale = data.FramebufferScale;
    const int width = static_cast<int>(data.DisplaySize.x * scale.x);
    const int height = static_cast<int>(data.DisplaySize.y * scale.y);
    if (width <= 0 || height <= 0) return;
    glViewport(0, 0, width, height);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_SCISSOR_TEST);
    program_.use();
    program_.set("image", 0);
    program_.set("window", Rgba{data.DisplayPos.x, data.DisplayPos.y, data.DisplaySize.x,
                                data.DisplaySize.y});
    glActiveTexture(GL_TEXTURE0);
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    for (int n = 0; n < data.CmdListsCount; ++n) {
        const ImDrawList& list = *data.CmdLists[n];
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.VtxBuffer.size_in_bytes()),
                     list.VtxBuffer.Data, GL_STREAM_DRAW);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                     static_cast<GLsizeiptr>(list.IdxBuffer.size_in_bytes()), list.IdxBuffer.Data,
                     GL_STREAM_DRAW);
        for (const ImDrawCmd& command : list.CmdBuffer) {
            const auto x0 = static_cast<int>((command.ClipRect.x - data.DisplayPos.x) * scale.x);
            const auto y0 = static_cast<int>((command.ClipRect.y - data.DisplayPos.y) * scale.y);
            const auto x1 = static_cast<int>((command.ClipRect.z - data.DisplayPos.x) * scale.x);
            const auto y1 = static_cast<int>((command.ClipRect.w - data.DisplayPos.y) * scale.y);
            if (x1 <= x0 || y1 <= y0) continue;
            glScissor(x0, height - y1, x1 - x0, y1 - y0);
            glBindTexture(GL_TEXTURE_2D,
                          static_cast<GLuint>(reinterpret_cast<std::intptr_t>(command.GetTexID())));
            glDrawElementsBaseVertex(
                GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount),
                sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
                reinterpret_cast<const void*>(std::size_t{command.IdxOffset} * sizeof(ImDrawIdx)),
                static_cast<GLint>(command.VtxOffset));
        }
    }
    glBindVertexArray(0);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
}

}  // namespace vog::viewer
