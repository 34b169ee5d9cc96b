// palette.h: colours of texts over the picture, and of notices in panels. Contrasts: tests/viewer/contrast_test.cpp.
#pragma once

#include <imgui.h>

namespace vog::viewer {

/// Text and its ground over the picture, whatever that shows.
inline constexpr ImU32 kInk = IM_COL32(240, 240, 240, 255), kGround = IM_COL32(0, 0, 0, 170);

/// Notices in panels.
struct Notices {
    ImVec4 error, progress, key;
};
/// light  of dark text on light panels
inline Notices notices(bool light) {
    return light ? Notices{{0.65f, 0.08f, 0.05f, 1}, {0.45f, 0.28f, 0, 1}, {0.40f, 0.25f, 0, 1}}
                 : Notices{{1, 0.45f, 0.4f, 1}, {1, 0.8f, 0.4f, 1}, {1, 0.85f, 0.5f, 1}};
}

}  // namespace vog::viewer
