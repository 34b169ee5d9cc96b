// splat_boxes.cpp: splats whose pixels are those of rays that meet a box.
#include "render/splat_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "render/ray_gaussian.h"
#include "render/splat_tiles.h"

namespace vog {

namespace {

/// Faces of a box relative to the eye.
struct EyeBox {
    std::array<float, 3> lower, upper;
};

template <class Splat>
struct Boxed {
    Splat splat;
    EyeBox box;
    PixelBounds bounds;
};

struct BoxedSplats {
    std::vector<Boxed<FarSplat>> far;
    std::vector<Boxed<NearSplat>> near;
};

/// Half edges of the box around the ellipsoid of the paper's radii times sigma.
Vec3d half_edges(const Gaussians& gaussians, std::size_t i, double aabb_sigma) {
    const Vec3d radius = aabb_sigma * std::numbers::sqrt2 * vec_cast<double>(gaussians.scale[i]);
    if (gaussians.axis_aligned()) return radius;
    const Mat3 world_from_own = matrix_from_quat(gaussians.rotation[i]);
    Vec3d half;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d row = world_from_own.row[static_cast<std::size_t>(axis)];
        half[axis] = length(Vec3d{row.x * radius.x, row.y * radius.y, row.z * radius.z});
    }
    return half;
}

Box paper_box(const Gaussians& gaussians, std::size_t i, double aabb_sigma, const Box& scene) {
    const Vec3d mean = vec_cast<double>(gaussians.mean[i]);
    const Vec3d half = half_edges(gaussians, i, aabb_sigma);
    Box box{mean - half, mean + half};
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::clamp(box.lower[axis], scene.lower[axis], scene.upper[axis]);
        box.upper[axis] = std::clamp(box.upper[axis], scene.lower[axis], scene.upper[axis]);
    }
    return box;
}

/// Narrows `bounds` to the pixels whose rays can meet the box; leaves them as they are where the
/// box reaches behind the eye plane.
PixelBounds narrowed(PixelBounds bounds, const Box& box, const CameraFrame& frame) {
    std::array<double, 2> x{std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity()};
    std::array<double, 2> y = x;
    const double reach = length(box.upper - box.lower);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d point{corner & 1 ? box.upper.x : box.lower.x,
                          corner & 2 ? box.upper.y : box.lower.y,
                          corner & 4 ? box.upper.z : box.lower.z};
        const Vec3d p = point - frame.eye;
        const double forward = dot(p, frame.forward);
        if (!(forward > 0.01 * reach)) return bounds;  // clear of the eye plane: finite slopes
        const double column =
            0.5 * (frame.width - 1) + frame.pixels_per_unit * dot(p, frame.right) / forward;
        const double row =
            0.5 * (frame.height - 1) - frame.pixels_per_unit * dot(p, frame.up) / forward;
        x = {std::min(x[0], column), std::max(x[1], column)};
        y = {std::min(y[0], row), std::max(y[1], row)};
    }
    constexpr double kSlack = 1e-3;  // pixels; the ray decides
    const auto least = [](double v, int limit) {
        return static_cast<std::int32_t>(std::ceil(std::clamp(v - kSlack, -1.0, limit + 1.0)));
    };
    const auto most = [](double v, int limit) {
        return static_cast<std::int32_t>(std::floor(std::clamp(v + kSlack, -1.0, limit + 1.0)));
    };
    bounds.x0 = std::max(bounds.x0, least(x[0], frame.width));
    bounds.x1 = std::min(bounds.x1, most(x[1], frame.width));
    bounds.y0 = std::max(bounds.y0, least(y[0], frame.height));
    bounds.y1 = std::min(bounds.y1, most(y[1], frame.height));
    return bounds;
}

template <class Splat>
void add_boxed(Splat splat, const Box& box, const CameraFrame& frame,
               std::vector<Boxed<Splat>>& out) {
    splat.bounds = narrowed(splat.bounds, box, frame);
    if (splat.bounds.empty()) return;
    EyeBox faces;
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(axis);
        faces.lower[n] = static_cast<float>(box.lower[axis] - frame.eye[axis]);
        faces.upper[n] = static_cast<float>(box.upper[axis] - frame.eye[axis]);
    }
    out.push_back({splat, faces, splat.bounds});
}

/// Projects one Gaussian at a time, because its box must stay with it.
BoxedSplats project_boxed(const SplatKernels& kernels, const Gaussians& gaussians,
                          const CameraFrame& frame, double aabb_sigma, std::size_t first,
                          std::size_t last) {
    constexpr std::size_t kChunk = 4096;
    const Box scene = view_box(gaussians);
    std::vector<BoxedSplats> parts((last - first + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
        const std::size_t begin = first + n * kChunk, end = std::min(begin + kChunk, last);
        Splats one;
        for (std::size_t i = begin; i < end; ++i) {
            one.far.clear();
            one.near.clear();
            kernels.project(gaussians, i, i + 1, frame, one);
            const Box box = paper_box(gaussians, i, aabb_sigma, scene);
            for (const FarSplat& splat : one.far) add_boxed(splat, box, frame, parts[n].far);
            for (const NearSplat& splat : one.near) add_boxed(splat, box, frame, parts[n].near);
        }
    });
    BoxedSplats all;
    for (const BoxedSplats& part : parts) {
        all.far.insert(all.far.end(), part.far.begin(), part.far.end());
        all.near.insert(all.near.end(), part.near.begin(), part.near.end());
    }
    return all;
}

/// 1 / direction of every ray of a tile, by axis. A zero component becomes tiny: it decides rightly
/// for every face but one that holds the eye, and 0/0 cannot arise.
struct TileRays {
    float inverse[3][kTileHeight][kTileWidth];
};
TileRays tile_rays(const CameraFrame& frame, const TilePixels& tile) {
    constexpr double kTiny = 1e-30;
    TileRays rays;
    for (int y = 0; y < kTileHeight; ++y)
        for (int x = 0; x < kTileWidth; ++x) {
            const Vec3d d = frame.direction(tile.column + x, tile.row + y);
            for (int axis = 0; axis < 3; ++axis) {
                const double component =
                    std::abs(d[axis]) < kTiny ? std::copysign(kTiny, d[axis]) : d[axis];
                rays.inverse[axis][y][x] = static_cast<float>(1 / component);
            }
        }
    return rays;
}

/// Adds alone[x] to depth[x] where the ray of pixel x0 <= x <= x1 meets the box in front of the
/// eye: the slabs between opposite faces have a point in common.
void add_where_met(const EyeBox& box, const TileRays& rays, int y, int x0, int x1,
                   const float* alone, float* depth) {
    for (int x = x0; x <= x1; ++x) {
        float enter = 0, leave = std::numeric_limits<float>::infinity();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float inverse = rays.inverse[axis][y][x];
            const float a = box.lower[axis] * inverse, b = box.upper[axis] * inverse;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        depth[x] += enter <= leave ? alone[x] : 0.0f;
    }
}

/// Rows and columns of a tile that a splat touches, inclusive.
struct TileRange {
    int x0, x1, y0, y1;
};
TileRange range_in(const TilePixels& tile, const PixelBounds& bounds) {
    return {std::max(bounds.x0 - tile.column, 0), std::min(bounds.x1 - tile.column, kTileWidth - 1),
            std::max(bounds.y0 - tile.row, 0), std::min(bounds.y1 - tile.row, kTileHeight - 1)};
}

/// T of one near splat in a tile, by the exact segment form.
void near_alone(const NearSplat& s, double cutoff, const TileRange& range, TilePixels& alone) {
    for (int y = range.y0; y <= range.y1; ++y)
        for (int x = range.x0; x <= range.x1; ++x) {
            const Vec3d d =
                s.corner + double(alone.column + x) * s.step_x + double(alone.row + y) * s.step_y;
            const double tau = s.density * segment_integral(s.e, d, cutoff);
            alone.depth[y][x] = static_cast<float>(tau * std::sqrt(double{alone.slant2[y][x]}));
        }
}

}  // namespace

DepthImage render_boxes(const SplatKernels& kernels, const Gaussians& gaussians,
                        const CameraFrame& frame, double aabb_sigma) {
    const KernelPolynomial kernel = fit_kernel(gaussians.cutoff);
    using Index = std::span<const std::uint32_t>;

    /// Each splat is made alone in a tile of its own, and added where its box is met.
    const auto add_tile = [&](const auto* splats, Index index, TilePixels& tile,
                              const auto& make_alone) {
        const TileRays rays = tile_rays(frame, tile);
        TilePixels alone = tile;
        for (const std::uint32_t n : index) {
            const TileRange range = range_in(tile, splats[n].bounds);
            for (int y = range.y0; y <= range.y1; ++y)
                std::fill(alone.depth[y] + range.x0, alone.depth[y] + range.x1 + 1, 0.0f);
            make_alone(splats[n].splat, range, alone);
            for (int y = range.y0; y <= range.y1; ++y)
                add_where_met(splats[n].box, rays, y, range.x0, range.x1, alone.depth[y],
                              tile.depth[y]);
        }
    };

    constexpr std::size_t kBatch = 1 << 19;  // bounds the memory of the projected splats
    DepthImage image(frame.width, frame.height);
    for (std::size_t first = 0; first < gaussians.size(); first += kBatch) {
        const std::size_t last = std::min(first + kBatch, gaussians.size());
        const BoxedSplats batch = project_boxed(kernels, gaussians, frame, aabb_sigma, first, last);
        add_splats(batch.far, frame, image,
                   [&](const Boxed<FarSplat>* splats, Index index, TilePixels& tile) {
                       add_tile(splats, index, tile,
                                [&](const FarSplat& splat, const TileRange&, TilePixels& alone) {
                                    const std::uint32_t only = 0;
                                    kernels.add_far(&splat, &only, 1, kernel, alone);
                                });
                   });
        add_splats(batch.near, frame, image,
                   [&](const Boxed<NearSplat>* splats, Index index, TilePixels& tile) {
                       add_tile(
                           splats, index, tile,
                           [&](const NearSplat& splat, const TileRange& range, TilePixels& alone) {
                               near_alone(splat, gaussians.cutoff, range, alone);
                           });
                   });
    }
    return image;
}

}  // namespace vog
