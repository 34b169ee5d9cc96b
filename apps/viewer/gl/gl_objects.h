// gl_objects.h: owners of OpenGL objects: programs, render targets, timers. All need a current
// OpenGL 3.3 core context.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vog/image.h"
#include "vog/linear.h"

namespace vog::viewer {

/// Owner of one OpenGL object; can be moved, not copied.
template <void (*kDelete)(GLuint)>
class GlName {
  public:
    GlName() = default;
    explicit GlName(GLuint name) : name_(name) {}
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlName& operator=(GlName&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlName() {
        if (name_) kDelete(name_);
    }
    operator GLuint() const { return name_; }  // for calls of OpenGL

  private:
    GLuint name_ = 0;
};

void delete_buffer(GLuint name);
void delete_vertex_array(GLuint name);
void delete_texture(GLuint name);
void delete_framebuffer(GLuint name);
using GlBuffer = GlName<delete_buffer>;
using GlVertexArray = GlName<delete_vertex_array>;
using GlTexture = GlName<delete_texture>;
using GlFramebuffer = GlName<delete_framebuffer>;
GlBuffer make_buffer();
GlVertexArray make_vertex_array();

/// throws vog::Error unless the context supports OpenGL 3.3 with additive blending into 32-bit
/// floats
void require_gl();
/// Whether OpenGL is rendered in software (llvmpipe and the like).
bool is_software_gl();

/// Program of embedded shaders, named by their files.
class GlProgram {
  public:
    /// fragments  joined to one shader
    /// word       defined in both, as splat.vert asks; empty: none
    /// throws     vog::Error, with the driver's message, for a shader that does not compile or link
    GlProgram(const std::string& vertex, const std::vector<std::string>& fragments,
              const std::string& word = {});
    ~GlProgram();
    GlProgram(const GlProgram&) = delete;
    GlProgram& operator=(const GlProgram&) = delete;

    void use() const;
    void set(const char* name, int value) const;
    void set(const char* name, float value) const;
    void set(const char* name, float x, float y) const;
    void set(const char* name, Vec3d value) const;
    void set(const char* name, float x, float y, float z, float w) const;
    void set(const char* name, const Rgba& value) const;
    /// Elements of an array of vec4.
    void set(const char* name, std::span<const std::array<float, 4>> values) const;
    /// Binds textures to samplers, from unit 0 on.
    void sample(const std::vector<std::pair<const char*, GLuint>>& textures) const;

  private:
    GLint place(const char* name) const;
    GLuint name_ = 0;
};

/// A new texture, whose pixels are read as they are; filter GL_LINEAR: with values between them.
GlTexture make_texture(GLenum target = GL_TEXTURE_2D, GLenum filter = GL_NEAREST);

/// Render target: textures of one size with a framebuffer, which can be read back.
class GlTarget {
  public:
    /// format  GL_R32F, GL_RG32F or GL_RGBA32F for sums, GL_RGBA8 for pictures
    /// images  drawn into at once
    GlTarget(GLenum format, int width, int height, std::size_t images = 1);

    int width() const { return width_; }
    int height() const { return height_; }
    int channels() const { return format_ == GL_R32F ? 1 : format_ == GL_RG32F ? 2 : 4; }
    GLuint texture(std::size_t image = 0) const { return textures_[image]; }
    GLuint framebuffer() const { return framebuffer_; }
    /// Binds the whole target for drawing.
    void bind() const;
    /// Sets all images to 0.
    void clear() const;
    /// Uploads values to the first image, in the order of its rows.
    void upload(std::span<const float> pixels) const;
    /// The same from the begin of a buffer object.
    void upload_from(GLuint buffer) const;
    /// Values of the first image, in the order of its rows, channel by channel of each pixel.
    std::vector<float> read_floats() const;

  private:
    GLenum format_;
    int width_ = 0, height_ = 0;
    std::vector<GlTexture> textures_;
    GlFramebuffer framebuffer_;
};

/// Reads the bound framebuffer (RGBA8) as a picture with rows from the top.
Image read_picture(int width, int height);

/// GPU time between begin() and end(), available a few frames later without waiting.
class GlTimer {
  public:
    GlTimer();
    ~GlTimer();
    GlTimer(const GlTimer&) = delete;
    GlTimer& operator=(const GlTimer&) = delete;
    void begin();
    void end();
    /// Latest available time, ms; 0 before the first.
    double ms();

  private:
    void collect();
    static constexpr std::size_t kQueries = 4;
    std::array<GLuint, kQueries> query_{};
    std::array<bool, kQueries> pending_{};
    std::size_t next_ = 0;
    bool running_ = false;
    double ms_ = 0;
};

}  // namespace vog::viewer
