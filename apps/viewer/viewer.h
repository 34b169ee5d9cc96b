// viewer.h: the window. What `vog view` opens, and what a script drives without one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "screen/screen.h"
#include "session/look.h"
#include "session/scene_loader.h"
#include "vog/camera.h"

namespace vog::viewer {

struct ViewerOptions {
    std::vector<std::string> files;  ///< shown together; may be empty
    PixelSize size{1280, 800};
    bool headless = false;
    std::string script{};  ///< file to play; then the program ends
    double scale = 1;      ///< pixels rendered per pixel shown, [0.1, 4]
    double ui_scale = 0;   ///< size of text and controls; 0: as the display and the size ask for
    std::function<Camera(const Box& box)> camera{};  ///< of the files' box; none: paper view
    double extinction = 0;                           ///< 0: automatic
    Look look{};
    ReadFiles read;
};

/// Runs until the window is closed, or the script has ended.
/// throws vog::Error for no display, no OpenGL 3.3, files that cannot be shown when nothing else
///        is, and what goes wrong in a script, naming its line
void run(const ViewerOptions& options);

}  // namespace vog::viewer
