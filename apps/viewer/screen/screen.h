// screen.h: where frames are shown and input comes from: a window, or memory alone. Both have a
// current OpenGL context of their own; all input goes through ImGuiIO, so that a script can play it
// into either.
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

/// throws vog::Error unless both sides are 1 to 16384, what OpenGL's textures take
void require_size(PixelSize size);

class Screen {
  public:
    virtual ~Screen() = default;
    /// Pixels of the framebuffer.
    virtual PixelSize size() const = 0;
    virtual void resize(PixelSize pixels) = 0;
    /// Size of text and controls that the display asks for, in framebuffer pixels: 1, 2 on HiDPI.
    virtual double content_scale() const = 0;
    /// Events, and the size, the pointer and the keys into `io`. May wait for an event up to
    /// `wait_s` seconds.
    virtual void begin_frame(ImGuiIO& io, double wait_s) = 0;
    /// Draws from now on go to the whole of what is shown.
    virtual void bind() const = 0;
    virtual void show_frame() = 0;
    virtual bool close_requested() const = 0;
    virtual void set_title(const std::string& title) = 0;
    /// Files dropped on the window since the last call.
    virtual std::vector<std::string> take_dropped_files() = 0;
};

/// A window of this many pixels, at the display's scale. After ImGui::CreateContext().
/// throws vog::Error where there is no display, or no OpenGL 3.3
std::unique_ptr<Screen> open_window(PixelSize size);

/// No window: an EGL context without a surface, drawing into memory.
/// throws vog::Error where EGL gives no OpenGL 3.3
std::unique_ptr<Screen> open_headless(PixelSize size);

}  // namespace vog::viewer
