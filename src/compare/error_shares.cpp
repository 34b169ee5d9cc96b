// error_shares.cpp: footprints of Gaussians as circles, and their shares of T in pixels.
#include "compare/error_shares.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace vog::comparison {

void add_error_shares(std::span<float> errors, const Gaussians& model, const Camera& camera,
                      const DepthImage& depth, const std::function<double(int, int)>& error2) {
    const int width = depth.width, height = depth.height;
    const CameraFrame frame = frame_of(camera, width, height);
    vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t i) {
        const Vec3d to = world_mean(model, i) - frame.eye;
        const double distance = dot(to, frame.forward);
        if (distance <= 0) return;
        const double pixels = frame.pixels_at(distance);
        const double column = 0.5 * (width - 1) + pixels * dot(to, frame.right);
        const double row = 0.5 * (height - 1) - pixels * dot(to, frame.up);
        const Vec3d scale = vec_cast<double>(model.scale[i]);
        const double sigma = std::sqrt(dot(scale, scale) / 3);
        // Narrower footprints could fall between pixel centres.
        const double sigma_px = std::max(0.4, pixels * sigma), reach = 2 * sigma_px;
        const double peak =
            static_cast<double>(model.density[i]) * sigma * std::sqrt(2 * std::numbers::pi);
        const auto clamped = [](double pixel, int size) {
            return static_cast<int>(std::clamp(pixel, 0.0, size - 1.0));
        };
        double sum = 0;
        for (int y = clamped(std::ceil(row - reach), height); y <= clamped(row + reach, height);
             ++y)
            for (int x = clamped(std::ceil(column - reach), width);
                 x <= clamped(column + reach, width); ++x) {
                const double t = depth.at(x, y), dx = x - column, dy = y - row;
                const double from2 = (dx * dx + dy * dy) / (2 * sigma_px * sigma_px);
                if (t <= 0 || from2 > 2) continue;
                sum += std::min(1.0, peak * std::exp(-from2) / t) * error2(x, y);
            }
        errors[i] += static_cast<float>(sum);
    });
}

}  // namespace vog::comparison
