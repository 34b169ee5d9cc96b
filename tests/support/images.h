// images.h: a small picture and a small depth image, and readers to hand to the checks of bad
// files.
#pragma once

#include <filesystem>

#include "vog/image.h"

namespace vog::test {

inline Image small_image() {
    Image image(3, 2);
    image.pixel = {{0, 0.5f, 1, 1},    {0.25f, 0.125f, 0, 1}, {1, 1, 1, 1},
                   {0.1f, 0.2f, 0.3f}, {0, 0, 0, 1},          {0.9f, 0.8f, 0.7f}};
    return image;
}

inline DepthImage small_depth() {
    DepthImage image(3, 2);
    image.depth = {0, 1e-30f, 0.1f, 3.14159274f, 4, 1e30f};
    image.extinction = 0.1;
    return image;
}

inline const auto read_any_image = [](const std::filesystem::path& file) {
    (void)read_image(file);
};
inline const auto read_any_depth = [](const std::filesystem::path& file) {
    (void)read_depth(file);
};

}  // namespace vog::test
