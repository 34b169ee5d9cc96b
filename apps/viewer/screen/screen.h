// screen.h: display and source of input: a window, or memory only (headless). Each has a current
// OpenGL context of its own. All input goes through ImGuiIO, so that a script can drive both.
#pragma once

#include <memory>
#include <string>
#include <vector>

struct ImGuiIO;

namespace vog::viewer {

struct PixelSize {
    int width = 0, height = 0;
    friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

/// throws vog::Error unless both sides are 1 to 16384, the limit of OpenGL's textures
void require_size(PixelSize size);

class Screen {
  public:
    virtual ~Screen() = default;
    /// Size of the framebuffer, pixels.
    virtual PixelSize size() const = 0;
    virtual void resize(PixelSize pixels) = 0;
    /// To the whole display, and back.
    virtual void toggle_full_screen() = 0;
    /// The display's scale of text and controls, in framebuffer pixels: 1, or 2 on HiDPI.
    virtual double content_scale() const = 0;
    /// Handles events; sets size, pointer and keys in `io`. Waits for an event up to `wait_s`
    /// seconds.
    virtual void begin_frame(ImGuiIO& io, double wait_s) = 0;
    /// Binds the whole framebuffer for drawing.
    virtual void bind() const = 0;
    virtual void show_frame() = 0;
    virtual bool close_requested() const = 0;
    virtual void set_title(const std::string& title) = 0;
    /// Files dropped on the window since the last call.
    virtual std::vector<std::string> take_dropped_files() = 0;
};

/// Opens a window of this size, pixels at the display's scale. Needs ImGui::CreateContext() before.
/// throws vog::Error without a display or OpenGL 3.3
std::unique_ptr<Screen> open_window(PixelSize size);

/// Opens no window: an EGL context without a surface, which draws into memory.
/// throws vog::Error where EGL has no OpenGL 3.3
std::unique_ptr<Screen> open_headless(PixelSize size);

/// Version and renderer of the OpenGL that open_headless draws with.
/// throws vog::Error as open_headless does
std::string headless_gl_name();

}  // namespace vog::viewer
