// web_decoder.cpp: Decoder of the page's encoding, as page/picture/gaussians.js decodes it.
#include "support/web_decoder.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace vog::test {

namespace {

std::string inflated(const std::string& packed, std::size_t size) {
    std::string bytes(size, '\0');
    uLongf left = size;
    const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &left,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (status != Z_OK || left != size) throw std::runtime_error("not a level's zlib stream");
    return bytes;
}

}  // namespace

Gaussians decoded(const web::WebLevel& level, const web::WebFrame& frame, float cutoff) {
    const std::size_t planes = level.chunks.size() * sizeof(web::WebLevel::Chunk);
    const std::string bytes =
        inflated(level.compressed(), planes + 2 * level.columns() * level.count);
    const auto word = [&](std::size_t column, std::size_t n) {
        const std::size_t low = planes + 2 * column * level.count + n;
        const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
        return static_cast<double>(byte(low) | byte(low + level.count) << 8);
    };
    Gaussians model;
    model.cutoff = cutoff;
    std::size_t n = 0;
    for (std::size_t c = 0; c < level.chunks.size(); ++c) {
        web::WebLevel::Chunk chunk;
        std::memcpy(&chunk, bytes.data() + c * sizeof chunk, sizeof chunk);
        for (std::uint32_t k = 0; k < chunk.count; ++k, ++n) {
            Vec3f mean, scale;
            for (int axis = 0; axis < 3; ++axis) {
                const auto column = static_cast<std::size_t>(axis);
                mean[axis] = static_cast<float>(
                    frame.center[axis] +
                    frame.unit * (chunk.corner[axis] + chunk.step * word(column, n)));
                scale[axis] = static_cast<float>(
                    frame.unit *
                    std::exp2(level.scale.low + level.scale.step * word(3 + column, n)));
            }
            model.mean.push_back(mean);
            model.scale.push_back(scale);
            model.density.push_back(static_cast<float>(
                std::exp2(level.density.low + level.density.step * word(level.columns() - 1, n)) /
                frame.unit));
            if (!level.rotated) continue;
            const auto part = [&](std::size_t column) {
                return static_cast<float>(word(column, n) * 2 * web::kWebRotationLimit /
                                              level.rotation_words -
                                          web::kWebRotationLimit);
            };
            Quat q{0, part(6), part(7), part(8)};
            q.w = std::sqrt(std::max(0.0f, 1 - q.x * q.x - q.y * q.y - q.z * q.z));
            model.rotation.push_back(q);
        }
    }
    if (n != level.count) throw std::runtime_error("chunks that do not add up to the level");
    return model;
}

}  // namespace vog::test
