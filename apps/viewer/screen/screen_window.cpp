// screen_window.cpp: window by GLFW.
#include <epoxy/gl.h>  // before GLFW, which includes another OpenGL header otherwise
#include <GLFW/glfw3.h>

#include <backends/imgui_impl_glfw.h>
#include <fmt/core.h>
#include <imgui.h>

#include <cmath>
#include <utility>
#include <vector>

#include "gl/gl_objects.h"
#include "screen/screen.h"
#include "vog/error.h"
#include "vog/shade.h"

namespace vog::viewer {

namespace {

/// GLFW's latest error.
std::string glfw_reason() {
    const char* text = nullptr;
    return glfwGetError(&text) == GLFW_NO_ERROR || !text ? "no reason given" : text;
}

class GlfwLibrary {
  public:
    GlfwLibrary() {
        if (!glfwInit())
            throw Error(fmt::format(
                "no display to open a window on: {} (--headless --script FILE needs none)",
                glfw_reason()));
    }
    ~GlfwLibrary() { glfwTerminate(); }
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;
};

class WindowScreen : public Screen {
  public:
    explicit WindowScreen(PixelSize size) {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        glfwWindowHintString(GLFW_X11_CLASS_NAME, "vog");
        glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "vog");
        window_ = glfwCreateWindow(size.width, size.height, "vog", nullptr, nullptr);
        if (!window_) throw Error(fmt::format("no window with OpenGL 3.3: {}", glfw_reason()));
        set_icon();
        glfwMakeContextCurrent(window_);
        glfwSwapInterval(1);
        require_gl();
        if (this->size() != size)
            resize(size);  // screen coordinates differ from pixels on HiDPI displays
        glfwSetWindowUserPointer(window_, this);
        glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
            auto& self = *static_cast<WindowScreen*>(glfwGetWindowUserPointer(window));
            self.dropped_.assign(paths, paths + count);
        });
        ImGui_ImplGlfw_InitForOther(window_, true);
    }
    ~WindowScreen() override {
        if (!window_) return;
        ImGui_ImplGlfw_Shutdown();
        glfwDestroyWindow(window_);
    }
    PixelSize size() const override {
        PixelSize size;
        glfwGetFramebufferSize(window_, &size.width, &size.height);
        return size;
    }
    void resize(PixelSize pixels) override {
        int width = 0, height = 0;
        glfwGetWindowSize(window_, &width, &height);
        const PixelSize now = size();
        if (now.width < 1 || now.height < 1) return;
        glfwSetWindowSize(window_, pixels.width * width / now.width,
                          pixels.height * height / now.height);
    }
    void toggle_full_screen() override {
        if (glfwGetWindowMonitor(window_)) {
            glfwSetWindowMonitor(window_, nullptr, before_.x, before_.y, before_.width,
                                 before_.height, GLFW_DONT_CARE);
            return;
        }
        GLFWmonitor* monitor = glfwGetPrimaryMonitor();
        const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
        if (!mode) return;
        glfwGetWindowPos(window_, &before_.x, &before_.y);
        glfwGetWindowSize(window_, &before_.width, &before_.height);
        glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    }
    double content_scale() const override {
        float x = 1, y = 1;
        glfwGetWindowContentScale(window_, &x, &y);
        return static_cast<double>(x);
    }
    void begin_frame(ImGuiIO&, double wait_s) override {
        if (wait_s > 0)
            glfwWaitEventsTimeout(wait_s);
        else
            glfwPollEvents();
        while (glfwGetWindowAttrib(window_, GLFW_ICONIFIED) && !glfwWindowShouldClose(window_))
            glfwWaitEventsTimeout(0.2);
        ImGui_ImplGlfw_NewFrame();
    }
    void bind() const override {
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        const PixelSize now = size();
        glViewport(0, 0, now.width, now.height);
    }
    void show_frame() override { glfwSwapBuffers(window_); }
    bool close_requested() const override { return glfwWindowShouldClose(window_); }
    void set_title(const std::string& title) override {
        glfwSetWindowTitle(window_, title.c_str());
    }
    std::vector<std::string> take_dropped_files() override { return std::exchange(dropped_, {}); }

  private:
    /// A Gaussian in the colours of inferno.
    void set_icon() {
        constexpr int kSide = 48;
        const TransferFunction map = named_transfer_function("inferno");
        std::vector<unsigned char> pixels;
        for (int row = 0; row < kSide; ++row)
            for (int column = 0; column < kSide; ++column) {
                const double x = (column + 0.5) / kSide * 2 - 1, y = (row + 0.5) / kSide * 2 - 1;
                const double r2 = x * x + y * y;
                const Rgba c = color_at(map, static_cast<float>(std::exp(-2.5 * r2)));
                for (const float channel : {c.r, c.g, c.b, r2 < 1 ? 1.0f : 0.0f})
                    pixels.push_back(static_cast<unsigned char>(std::lround(255 * channel)));
            }
        const GLFWimage icon{kSide, kSide, pixels.data()};
        glfwSetWindowIcon(window_, 1, &icon);
    }

    GlfwLibrary library_;  // first member: destroyed last
    GLFWwindow* window_ = nullptr;
    struct {
        int x = 0, y = 0, width = 0, height = 0;
    } before_;  ///< full screen, in the display's coordinates
    std::vector<std::string> dropped_;
};

}  // namespace

std::unique_ptr<Screen> open_window(PixelSize size) { return std::make_unique<WindowScreen>(size); }

}  // namespace vog::viewer
