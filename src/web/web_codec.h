// web_codec.h: quantised, compressed encoding of models for the page; page/picture/gaussians.js decodes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vog/gaussians.h"

namespace vog::web {

/// Origin and unit of length of a page's numbers, from the finest level and shared by all.
struct WebFrame {
    Vec3d center;  ///< world units
    double unit = 1;
};
/// Centre of the means, and the radius of their box or the largest scale if larger.
WebFrame web_frame(const Gaussians& model);

/// Gaussians with density > 0 in Morton order of their means, in a page's frame; logarithms of base 2.
struct WebShapes {
    bool rotated = false;
    std::vector<std::uint32_t> index;  ///< in the model
    std::vector<Vec3d> mean;
    std::vector<Vec3d> log_scale;
    std::vector<Quat> rotation;    ///< the smallest of the ellipsoid, its scales permuted
    std::vector<double> log_mass;  ///< log2(density * s0 * s1 * s2)
};
WebShapes web_shapes(const Gaussians& model, const WebFrame& frame);

/// Quantisation of positive values: log2(value) = low + step * word.
struct WebLogarithm {
    double low = 0, step = 1;
};

/// Fineness of a page's words.
struct WebPrecision {
    /// Steps of a mean per smallest standard deviation: errors are at most half of one.
    double steps_per_deviation = 256;
    /// Scales and densities have steps of 2^step = 1 + 1 / this, or the finest that 65,535 of them allow: relative errors of
    /// half of it.
    double steps_per_unit = 1024;
    int rotation_words = 3000;  ///< steps from -kWebRotationLimit to kWebRotationLimit
};
/// Eight times as fine in as many words, which compress less.
inline constexpr WebPrecision kPreciseWords{2048, 8192, 24000};

/// One level as 16-bit words in columns: x y z, three scales, x y z of the rotation (if rotated),
/// density. The bytes of a column are split into all low bytes, then all high bytes: the latter
/// have few distinct values, which deflate compresses well.
struct WebLevel {
    std::size_t count = 0;
    bool rotated = false;
    WebLogarithm scale, density;
    int rotation_words = 0;
    /// Run of Gaussians with a common origin and step of their means: mean = corner + step * word.
    struct Chunk {
        float corner[3], step;
        std::uint32_t count;
    };
    std::vector<Chunk> chunks;
    std::vector<std::uint16_t> words;  ///< [columns][count]

    std::size_t columns() const { return rotated ? 10 : 7; }
    /// zlib stream of the chunks and the bytes of the words.
    std::string compressed() const;
};

/// Quantisation of x, y, z of rotations: -kWebRotationLimit at word 0 to +kWebRotationLimit at the last
/// word. An ellipsoid is unchanged if its axes are permuted; of the 24 equivalent
/// rotations the smallest has w >= 0.853 (62.8 degrees, the largest angle between two orientations
/// of a cube), and no other component above sin(22.5 degrees) = 0.3827, half the angle between two
/// of them about one axis. An error of half a step of 3000 in all three components is 0.00044 rad.
inline constexpr double kWebRotationLimit = 0.383;

WebLevel web_level(const WebShapes& shapes, const WebPrecision& precision = {});
/// Of all Gaussians with density > 0.
inline WebLevel web_level(const Gaussians& model, const WebFrame& frame,
                          const WebPrecision& precision = {}) {
    return web_level(web_shapes(model, frame), precision);
}

/// zlib stream of bytes.
std::string deflated(const std::string& bytes);

}  // namespace vog::web
