// images.h: small images of colour and depth, special floats, and readers for checks of bad files.
#pragma once

#include <filesystem>
#include <limits>
#include <string>

#include "support/data.h"
#include "support/image_bytes.h"
#include "vog/image.h"

namespace vog::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

/// Image in a file of these bytes; its format is recognised by the first of them.
inline Image read_bytes_as_image(const std::string& bytes) {
    const TempDir dir;
    write_bytes(dir / "image", bytes);
    return read_image(dir / "image");
}

inline const auto read_any_image = [](const std::filesystem::path& file) {
    (void)read_image(file);
};
inline const auto read_any_depth = [](const std::filesystem::path& file) {
    (void)read_depth(file);
};

}  // namespace vog::test
