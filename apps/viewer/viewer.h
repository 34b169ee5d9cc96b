// viewer.h: the interactive viewer, in a window or headless by a script.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "screen/screen.h"
#include "session/session.h"
#include "vog/camera.h"

namespace vog::viewer {

struct ViewerOptions {
    std::vector<std::string> files;  ///< opened together; may be empty
    PixelSize size{1280, 800};
    bool headless = false;
    std::string script{};  ///< file with actions to run; the program ends after them
    double scale = 1;      ///< rendered pixels per screen pixel along an edge, [0.1, 4]
    double ui_scale = 0;   ///< scale of text and controls; 0: from the display and the size
    std::function<Camera(const Subject&)> camera{};  ///< initial view; empty: fitted
    double extinction = 0;                           ///< 0: automatic
    Look look{};
    Quantity quantity{};  ///< shown first; its field is that of `field`
    std::string field{};  ///< as field_for reads it; empty: the first one
    /// Of column, mean and deviation; none: of the first picture.
    std::optional<ColorScale> color_scale{};
    ScaleFit fit = ScaleFit::automatic;  ///< of a scale that is fitted to the first view
    ChooseTransfer choose_transfer{};    ///< of volume
    LayeredData layers{};                ///< of volume
    bool steps = false;                  ///< the files are models, steps in time
    OpenFilm open_film{};
    ReadFiles read;
};

/// Runs until the window is closed, or the script has ended.
/// throws  vog::Error without a display or OpenGL 3.3, for unreadable files when nothing else is
///         open, and for errors in a script, with its line
void run(const ViewerOptions& options);

}  // namespace vog::viewer
