// gl_objects.cpp: OpenGL programs, render targets and timer queries.
#include "gl/gl_objects.h"

#include <fmt/core.h>

#include <algorithm>

#include "gl/shader_sources.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

// Header for desktop OpenGL; WebGL2 has "#version 300 es" and a precision in its place.
constexpr const char* kHeader = "#version 330 core\n";

GLuint compile(GLenum kind, const std::vector<std::string>& names, const std::string& word) {
    std::string source = kHeader + (word.empty() ? word : "#define " + word + "\n");
    for (const std::string& name : names) source += shader_source(name);
    const char* text = source.c_str();
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    char log[1024] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    throw Error(fmt::format("OpenGL: the driver refuses {}: {}", names.back(), log));
}

/// Order of a format's channels in memory.
GLenum layout_of(GLenum format) {
    return format == GL_R32F ? GL_RED : format == GL_RG32F ? GL_RG : GL_RGBA;
}

}  // namespace

void delete_buffer(GLuint name) { glDeleteBuffers(1, &name); }
void delete_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
void delete_texture(GLuint name) { glDeleteTextures(1, &name); }
void delete_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }

GlBuffer make_buffer() {
    GLuint name = 0;
    glGenBuffers(1, &name);
    return GlBuffer(name);
}
GlVertexArray make_vertex_array() {
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    return GlVertexArray(name);
}

void require_gl() {
    const int version = epoxy_gl_version();
    if (!epoxy_is_desktop_gl() || version < 33)
        throw Error(fmt::format("OpenGL {}.{}, expected 3.3 or newer ({})", version / 10,
                                version % 10,
                                reinterpret_cast<const char*>(glGetString(GL_RENDERER))));
    const GlTarget probe(GL_R32F, 1, 1);
    glBindFramebuffer(GL_FRAMEBUFFER, probe.framebuffer());
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(fmt::format("OpenGL: {} cannot draw into 32-bit floats",
                                reinterpret_cast<const char*>(glGetString(GL_RENDERER))));
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

bool is_software_gl() {
    const std::string renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

GlProgram::GlProgram(const std::string& vertex, const std::vector<std::string>& fragments,
                     const std::string& word) {
    const GLuint v = compile(GL_VERTEX_SHADER, {vertex}, word);
    const GLuint f = compile(GL_FRAGMENT_SHADER, fragments, word);
    name_ = glCreateProgram();
    glAttachShader(name_, v);
    glAttachShader(name_, f);
    glLinkProgram(name_);
    glDeleteShader(v);
    glDeleteShader(f);
    GLint good = 0;
    glGetProgramiv(name_, GL_LINK_STATUS, &good);
    if (good) return;
    char log[1024] = "";
    glGetProgramInfoLog(name_, sizeof log, nullptr, log);
    throw Error(
        fmt::format("OpenGL: the driver refuses {} with {}: {}", vertex, fragments.back(), log));
}

GlProgram::~GlProgram() { glDeleteProgram(name_); }

void GlProgram::use() const { glUseProgram(name_); }
GLint GlProgram::place(const char* name) const { return glGetUniformLocation(name_, name); }
void GlProgram::set(const char* name, int value) const { glUniform1i(place(name), value); }
void GlProgram::set(const char* name, float value) const { glUniform1f(place(name), value); }
void GlProgram::set(const char* name, float x, float y) const { glUniform2f(place(name), x, y); }
void GlProgram::set(const char* name, float x, float y, float z, float w) const {
    glUniform4f(place(name), x, y, z, w);
}
void GlProgram::set(const char* name, Vec3d v) const {
    glUniform3f(place(name), static_cast<float>(v.x), static_cast<float>(v.y),
                static_cast<float>(v.z));
}
void GlProgram::set(const char* name, const Rgba& c) const {
    glUniform4f(place(name), c.r, c.g, c.b, c.a);
}
void GlProgram::set(const char* name, std::span<const std::array<float, 4>> values) const {
    glUniform4fv(place(name), static_cast<GLsizei>(values.size()), values.front().data());
}
void GlProgram::sample(const std::vector<std::pair<const char*, GLuint>>& textures) const {
    int unit = 0;
    for (const auto& [name, texture] : textures) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_2D, texture);
        set(name, unit++);
    }
    glActiveTexture(GL_TEXTURE0);
}

GlTexture make_texture(GLenum target, GLenum filter) {
    GLuint name = 0;
    glGenTextures(1, &name);
    GlTexture texture(name);
    glBindTexture(target, texture);
    for (const GLenum side : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(target, side, static_cast<GLint>(filter));
    return texture;
}

GlTarget::GlTarget(GLenum format, int width, int height, std::size_t images)
    : format_(format), width_(width), height_(height) {
    GLuint framebuffer = 0;
    glGenFramebuffers(1, &framebuffer);
    framebuffer_ = GlFramebuffer(framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    std::vector<GLenum> places;
    for (std::size_t n = 0; n < images; ++n) {
        textures_.push_back(make_texture());
        glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0,
                     layout_of(format), format == GL_RGBA8 ? GL_UNSIGNED_BYTE : GL_FLOAT, nullptr);
        places.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(n));
        glFramebufferTexture2D(GL_FRAMEBUFFER, places.back(), GL_TEXTURE_2D, textures_.back(), 0);
    }
    glDrawBuffers(static_cast<GLsizei>(images), places.data());
}

void GlTarget::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, width_, height_);
}

void GlTarget::clear() const {
    bind();
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
}

void GlTarget::upload(std::span<const float> pixels) const {
    glBindTexture(GL_TEXTURE_2D, textures_.front());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, layout_of(format_), GL_FLOAT,
                    pixels.data());
}

void GlTarget::upload_from(GLuint buffer) const {
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
    glBindTexture(GL_TEXTURE_2D, textures_.front());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, layout_of(format_), GL_FLOAT, nullptr);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

std::vector<float> GlTarget::read_floats() const {
    std::vector<float> pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) *
                              static_cast<std::size_t>(channels()));
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width_, height_, layout_of(format_), GL_FLOAT, pixels.data());
    return pixels;
}

Image read_picture(int width, int height) {
    std::vector<std::uint8_t> bytes(std::size_t{4} * static_cast<std::size_t>(width) *
                                    static_cast<std::size_t>(height));
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
    Image image(width, height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const std::uint8_t* p = bytes.data() + 4 * (static_cast<std::size_t>(height - 1 - row) *
                                                            static_cast<std::size_t>(width) +
                                                        static_cast<std::size_t>(column));
            const auto unit = [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0f; };
            image.at(column, row) = {unit(p[0]), unit(p[1]), unit(p[2]), unit(p[3])};
        }
    return image;
}

GlTimer::GlTimer() { glGenQueries(kQueries, query_.data()); }
GlTimer::~GlTimer() { glDeleteQueries(kQueries, query_.data()); }

void GlTimer::begin() {
    collect();
    running_ = !pending_[next_];  // all queries are in flight: this interval is not measured
    if (running_) glBeginQuery(GL_TIME_ELAPSED, query_[next_]);
}

void GlTimer::end() {
    if (!running_) return;
    glEndQuery(GL_TIME_ELAPSED);
    pending_[next_] = true;
    next_ = (next_ + 1) % kQueries;
    running_ = false;
}

double GlTimer::ms() {
    collect();
    return ms_;
}

void GlTimer::collect() {
    for (std::size_t n = 0; n < kQueries; ++n) {
        const std::size_t q = (next_ + n) % kQueries;  // oldest first
        GLint known = 0;
        if (pending_[q]) glGetQueryObjectiv(query_[q], GL_QUERY_RESULT_AVAILABLE, &known);
        if (!known) continue;
        GLuint64 ns = 0;
        glGetQueryObjectui64v(query_[q], GL_QUERY_RESULT, &ns);
        ms_ = static_cast<double>(ns) * 1e-6;
        pending_[q] = false;
    }
}

}  // namespace vog::viewer
