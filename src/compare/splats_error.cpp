// splats_error.cpp: pictures of splats under parallel rays, where their projection is exact, against those of the model.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "render/splat/splat.h"
#include "vog/camera.h"
#include "vog/error.h"
#include "vog/exchange.h"

namespace vog {

namespace {

constexpr int kPictureSize = 256;  // pixels

/// A splat on the screen, pixels.
struct Projected {
    double x, y;              ///< of its mean
    double xx, xy, yy;        ///< inverse of its covariance
    double reach_x, reach_y;  ///< half edges of the box where alpha is 1/255 or more
    double opacity;
};

Projected project(const Splats& splats, std::size_t i, const Camera& camera) {
    const Vec3d forward = normalized(camera.look_at - camera.eye);
    const Vec3d right = normalized(cross(forward, camera.up)), up = cross(right, forward);
    const double scale = kPictureSize / camera.orthographic_width;
    const Vec3d from = vec_cast<double>(splats.mean[i]) - camera.eye;
    const Mat3 r = matrix_from_quat(splats.rotation[i]);
    double xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3d axis = scale * double{splats.scale[i][k]} * r.column(k);
        const double a = dot(axis, right), b = -dot(axis, up);
        xx += a * a, xy += a * b, yy += b * b;
    }
    const double opacity = splats.opacity[i];
    // Renderers leave out alphas below 1/255.
    const double reach2 = std::max(0.0, 2 * std::log(255 * opacity));
    const double determinant = std::max(xx * yy - xy * xy, std::numeric_limits<double>::min());
    return {0.5 * (kPictureSize - 1) + scale * dot(from, right),
            0.5 * (kPictureSize - 1) - scale * dot(from, up),
            yy / determinant,
            -xy / determinant,
            xx / determinant,
            std::sqrt(reach2 * xx),
            std::sqrt(reach2 * yy),
            opacity};
}

/// -ln of the product of all 1 - alpha, at each pixel.
std::vector<double> depth_of(const Splats& splats, const Camera& camera) {
    std::vector<Projected> all(splats.size());
    vog::parallel_for(std::size_t{0}, all.size(),
                      [&](std::size_t i) { all[i] = project(splats, i, camera); });
    std::vector<double> depth(std::size_t{kPictureSize} * kPictureSize);
    vog::parallel_for(0, kPictureSize, [&](int row) {
        for (const Projected& p : all) {
            const double dy = row - p.y;
            if (!(std::abs(dy) <= p.reach_y)) continue;
            const int first =
                std::max(0, static_cast<int>(std::ceil(std::max(p.x - p.reach_x, 0.0))));
            const int last =
                static_cast<int>(std::floor(std::min(p.x + p.reach_x, kPictureSize - 1.0)));
            for (int column = first; column <= last; ++column) {
                const double dx = column - p.x;
                const double alpha =
                    p.opacity *
                    std::exp(-0.5 * (p.xx * dx * dx + 2 * p.xy * dx * dy + p.yy * dy * dy));
                if (alpha >= 1 / 255.0)
                    depth[static_cast<std::size_t>(row) * kPictureSize +
                          static_cast<std::size_t>(column)] -= std::log1p(-alpha);
            }
        }
    });
    return depth;
}

}  // namespace

SplatsError splats_error(const Gaussians& model, const Splats& splats, double extinction) {
    if (splats.size() != model.size())
        throw Error(fmt::format("{} splats, expected {}", splats.size(), model.size()));
    SplatsError error;
    error.worst_db = std::numeric_limits<double>::infinity();
    if (model.size() == 0) return error;
    SplatRenderer renderer(model);
    const Box box = view_box(model);
    double sum = 0, expected = 0;
    DepthImage image;
    for (const char* name : view_names()) {
        Orbit orbit;
        orbit.orthographic = true;
        set_view(orbit, name);
        const Camera camera = orbit_view(box, orbit);
        renderer.render(camera, kPictureSize, kPictureSize, image);
        const std::vector<double> depth = depth_of(splats, camera);
        double squares = 0;
        for (std::size_t n = 0; n < depth.size(); ++n) {
            const double t = extinction * double{image.depth[n]};
            sum += depth[n], expected += t;
            const double difference = std::exp(-t) - std::exp(-depth[n]);
            squares += difference * difference;
        }
        const double db = squares > 0
                              ? -10 * std::log10(squares / static_cast<double>(depth.size()))
                              : std::numeric_limits<double>::infinity();
        error.worst_db = std::min(error.worst_db, db);
        error.mean_db += db / static_cast<double>(view_names().size());
    }
    if (expected > 0) error.depth = sum / expected;
    for (const float opacity : splats.opacity)
        error.opaque += (opacity > 0.9998f) / static_cast<double>(splats.size());
    return error;
}

}  // namespace vog
