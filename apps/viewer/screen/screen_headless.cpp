// screen_headless.cpp: an OpenGL context without a display, through EGL.
#include <epoxy/egl.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "gl/gl_objects.h"
#include "screen/screen.h"
#include "screen/screen_keys.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

/// EGL context on Mesa's surfaceless platform; failing that on the default display, with a surface
/// of one pixel.
class EglContext {
  public:
    EglContext() {
        const std::string failure = open(EGL_PLATFORM_SURFACELESS_MESA);
        if (failure.empty()) return;
        close();
        const std::string failure_default = open(0);
        if (failure_default.empty()) return;
        close();
        throw Error(fmt::format("no headless OpenGL 3.3: EGL: {}", failure_default));
    }
    ~EglContext() { close(); }
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

  private:
    /// Creates the context.
    /// returns  the error; empty: none
    std::string open(EGLenum platform) {
        const auto failed = [](const char* failure) {
            return fmt::format("{} (error {:#x})", failure, static_cast<unsigned>(eglGetError()));
        };
        if (platform && !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base"))
            return "no EGL_EXT_platform_base";
        display_ = platform ? eglGetPlatformDisplayEXT(platform, EGL_DEFAULT_DISPLAY, nullptr)
                            : eglGetDisplay(EGL_DEFAULT_DISPLAY);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) {
            display_ = EGL_NO_DISPLAY;
            return failed("no display");
        }
        if (!eglBindAPI(EGL_OPENGL_API)) return failed("no OpenGL");
        const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                 EGL_PBUFFER_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0)
            return failed("no configuration with OpenGL");
        const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                                  3,
                                  EGL_CONTEXT_MINOR_VERSION,
                                  3,
                                  EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                  EGL_NONE};
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version);
        if (context_ == EGL_NO_CONTEXT) return failed("no context of OpenGL 3.3 core");
        if (!platform) {
            const EGLint pixel[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
            surface_ = eglCreatePbufferSurface(display_, config, pixel);
        }
        if (!eglMakeCurrent(display_, surface_, surface_, context_))
            return failed("the context cannot be made current");
        return {};
    }
    void close() {
        if (display_ == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
        if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
        // The display is shared by the process: terminating it would take it from other contexts,
        // and would unload Mesa's driver before that has freed its memory.
        display_ = EGL_NO_DISPLAY;
        surface_ = EGL_NO_SURFACE;
        context_ = EGL_NO_CONTEXT;
    }

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLSurface surface_ = EGL_NO_SURFACE;
    EGLContext context_ = EGL_NO_CONTEXT;
};

using Clock = std::chrono::steady_clock;

class HeadlessScreen : public Screen {
  public:
    explicit HeadlessScreen(PixelSize size) : size_(size) {
        require_gl();
        target_ = std::make_unique<GlTarget>(GL_RGBA8, size.width, size.height);
    }
    PixelSize size() const override { return size_; }
    void resize(PixelSize pixels) override {
        size_ = pixels;
        target_ = std::make_unique<GlTarget>(GL_RGBA8, pixels.width, pixels.height);
    }
    void toggle_full_screen() override {}
    double content_scale() const override { return 1; }
    void begin_frame(ImGuiIO& io, double wait_s) override {
        // There are no events to wait for.
        std::this_thread::sleep_for(std::chrono::duration<double>(std::min(wait_s, 0.01)));
        map_keys(io);
        io.DisplaySize = {static_cast<float>(size_.width), static_cast<float>(size_.height)};
        const Clock::time_point now = Clock::now();
        io.DeltaTime = std::max(1e-4f, std::chrono::duration<float>(now - last_).count());
        last_ = now;
    }
    void bind() const override { target_->bind(); }
    void show_frame() override { glFlush(); }
    bool close_requested() const override { return false; }
    void set_title(const std::string&) override {}
    std::vector<std::string> take_dropped_files() override { return {}; }

  private:
    EglContext context_;  // first member: destroyed last
    PixelSize size_;
    std::unique_ptr<GlTarget> target_;
    Clock::time_point last_ = Clock::now();
};

}  // namespace

void require_size(PixelSize size) {
    constexpr int kMost = 16384;
    if (size.width < 1 || size.height < 1 || size.width > kMost || size.height > kMost)
        throw Error(fmt::format("a window of {}x{} pixels, expected 1x1 to {}x{}", size.width,
                                size.height, kMost, kMost));
}

std::unique_ptr<Screen> open_headless(PixelSize size) {
    return std::make_unique<HeadlessScreen>(size);
}

std::string headless_gl_name() {
    const EglContext context;
    const auto text = [](GLenum name) {
        const GLubyte* value = glGetString(name);
        return value ? reinterpret_cast<const char*>(value) : "unknown";
    };
    return fmt::format("{}, {}", text(GL_VERSION), text(GL_RENDERER));
}

}  // namespace vog::viewer
