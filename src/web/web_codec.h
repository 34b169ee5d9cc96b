// web_codec.h: a model as few bytes for a page. page/gaussians.js reads them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vog/gaussians.h"

namespace vog::web {

/// Where numbers of the page count from: places from the centre, lengths in units. Both are those
/// of the finest level, shared by all levels.
struct WebFrame {
    Vec3d center;
    double unit = 1;
};
WebFrame web_frame(const Gaussians& model);

/// log2 of a value is low + step * word.
struct WebLogarithm {
    double low = 0, step = 1;
};

/// One level. Words of 16 bits, one column after another: x y z, three scales, three components of
/// the rotation if there is one, density. Of each column all low bytes, then all high bytes: the
/// latter are few different ones, which is what deflate needs.
struct WebLevel {
    std::size_t count = 0;
    bool rotated = false;
    WebLogarithm scale, density;
    /// Runs of Gaussians that share a corner and a step for their means.
    struct Chunk {
        float corner[3], step;
        std::uint32_t count;
    };
    std::vector<Chunk> chunks;
    std::vector<std::uint16_t> words;  ///< [columns][count]

    std::size_t columns() const { return rotated ? 10 : 7; }
    /// Chunks, then the bytes of the words, as zlib has them.
    std::string compressed() const;
};

/// Rotation words: -kWebRotationLimit at 0 to +kWebRotationLimit at kWebRotationWords. An ellipsoid
/// stays the same when its axes are swapped: of the 24 ways the one that turns least has w >= 0.853
/// (62.8 degrees, the most between two orientations of a cube) and no other component above
/// sin(22.5 degrees) = 0.3827, half the angle between two of them about an axis. Half a step in
/// each of three is 0.00044 rad.
inline constexpr double kWebRotationLimit = 0.383;
inline constexpr int kWebRotationWords = 3000;

/// Gaussians in the order of a Morton curve, those without density left out.
WebLevel web_level(const Gaussians& model, const WebFrame& frame);

}  // namespace vog::web
