// splat_boxes.cpp: Splats restricted to the pixels whose rays meet the Gaussians' boxes.
#include "render/splat/splat_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "core/parallel.h"

namespace vog::splat {

namespace {

/// Corners of a box relative to the eye.
struct EyeBox {
    std::array<float, 3> lower, upper;
};

/// Splats, their boxes, and the bounds of the pixels that both may cover.
template <class Splat>
struct Boxed {
    std::vector<Splat> splat;
    std::vector<EyeBox> box;
    std::vector<PixelBounds> bounds;

    void append(const Boxed& other) {
        splat.insert(splat.end(), other.splat.begin(), other.splat.end());
        box.insert(box.end(), other.box.begin(), other.box.end());
        bounds.insert(bounds.end(), other.bounds.begin(), other.bounds.end());
    }
};
struct BoxedSplats {
    Boxed<FarSplat> far;
    Boxed<NearSplat> near;
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

/// Narrows `bounds` to the pixels whose rays can meet the box; leaves them unchanged for a box that
/// reaches behind the eye plane.
/// returns  false if there is no such pixel
bool narrow(PixelBounds& bounds, const Box& box, const CameraFrame& frame) {
    std::array<double, 2> x{std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity()};
    std::array<double, 2> y = x;
    const double diagonal = length(box.upper - box.lower);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d point{corner & 1 ? box.upper.x : box.lower.x,
                          corner & 2 ? box.upper.y : box.lower.y,
                          corner & 4 ? box.upper.z : box.lower.z};
        const Vec3d p = point - frame.eye;
        const double forward = dot(p, frame.forward);
        // Clear of the eye plane: finite slopes.
        if (!frame.orthographic && !(forward > 0.01 * diagonal)) return true;
        const double pixels = frame.pixels_at(forward);
        const double column = 0.5 * (frame.width - 1) + pixels * dot(p, frame.right);
        const double row = 0.5 * (frame.height - 1) - pixels * dot(p, frame.up);
        x = {std::min(x[0], column), std::max(x[1], column)};
        y = {std::min(y[0], row), std::max(y[1], row)};
    }
    constexpr double kSlack = 1e-3;  // pixels; the exact test follows for each ray
    const double x0 = std::max(static_cast<double>(bounds.x0), std::ceil(x[0] - kSlack));
    const double x1 = std::min(static_cast<double>(bounds.x1), std::floor(x[1] + kSlack));
    const double y0 = std::max(static_cast<double>(bounds.y0), std::ceil(y[0] - kSlack));
    const double y1 = std::min(static_cast<double>(bounds.y1), std::floor(y[1] + kSlack));
    if (!(x0 <= x1 && y0 <= y1)) return false;
    bounds = {static_cast<std::uint16_t>(x0), static_cast<std::uint16_t>(x1),
              static_cast<std::uint16_t>(y0), static_cast<std::uint16_t>(y1)};
    return true;
}

template <class Splat>
void add_boxed(const Splat& splat, const Box& box, const CameraFrame& frame, Boxed<Splat>& out) {
    PixelBounds bounds = splat.bounds;
    if (!narrow(bounds, box, frame)) return;
    EyeBox faces;
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(axis);
        faces.lower[n] = static_cast<float>(box.lower[axis] - frame.eye[axis]);
        faces.upper[n] = static_cast<float>(box.upper[axis] - frame.eye[axis]);
    }
    out.splat.push_back(splat);
    out.splat.back().bounds = bounds;
    out.box.push_back(faces);
    out.bounds.push_back(bounds);
}

/// Projects Gaussians first ... last - 1, one at a time to keep each with its box.
BoxedSplats project_boxed(const SplatKernels& kernels, const SplatClip& clip, double aabb_sigma,
                          std::size_t first, std::size_t last) {
    const SplatModel& model = clip.model;
    const CameraFrame& frame = clip.frame;
    constexpr std::size_t kChunk = 4096;
    const Box scene = moved(view_box(*model.gaussians), -model.gaussians->origin);
    std::vector<BoxedSplats> parts((last - first + kChunk - 1) / kChunk);
    vog::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t n) {
        const std::size_t begin = first + n * kChunk, end = std::min(begin + kChunk, last);
        FarSplat far;
        PixelBounds bounds;
        std::vector<NearSplat> near;
        for (std::size_t i = begin; i < end; ++i) {
            near.clear();
            SplatRun run{&far, &bounds, 0, &near};
            kernels.project(model, frame, i, i + 1, run);
            const Box box = paper_box(*model.gaussians, i, aabb_sigma, scene);
            clip.keep(near);
            if (run.count > 0 && clip.keep({i, false}, far, near))
                add_boxed(far, box, frame, parts[n].far);
            for (const NearSplat& splat : near) add_boxed(splat, box, frame, parts[n].near);
        }
    });
    BoxedSplats all;
    for (const BoxedSplats& part : parts) {
        all.far.append(part.far);
        all.near.append(part.near);
    }
    return all;
}

/// 1 / direction of every ray of a tile, by axis, its origin relative to the eye, and the part that a clip leaves. A zero
/// component becomes tiny, so that 0/0 cannot arise; correct for every face except one that contains the origin.
struct BoxRays {
    float inverse[3][kTileHeight][kTileWidth], origin[3][kTileHeight][kTileWidth];
    float first[kTileHeight][kTileWidth], last[kTileHeight][kTileWidth];
    TileRays clipped;
};
BoxRays box_rays(const SplatClip& clip, const TilePixels& tile) {
    constexpr double kTiny = 1e-30;
    const CameraFrame& frame = clip.frame;
    BoxRays rays;
    clip.find(tile.column, tile.row, rays.clipped);
    for (int y = 0; y < kTileHeight; ++y)
        for (int x = 0; x < kTileWidth; ++x) {
            const Vec3d d = frame.direction(tile.column + x, tile.row + y);
            const Vec3d from = frame.origin(tile.column + x, tile.row + y) - frame.eye;
            for (int axis = 0; axis < 3; ++axis) {
                const double component =
                    std::abs(d[axis]) < kTiny ? std::copysign(kTiny, d[axis]) : d[axis];
                rays.inverse[axis][y][x] = static_cast<float>(1 / component);
                rays.origin[axis][y][x] = static_cast<float>(from[axis]);
            }
            const RayInterval kept = rays.clipped.kept[y][x];
            constexpr double kMost = std::numeric_limits<float>::max();
            rays.first[y][x] = static_cast<float>(std::min(kept.first, kMost));
            rays.last[y][x] = static_cast<float>(std::min(kept.last, kMost));
        }
    return rays;
}

/// Adds alone[x] to depth[x] where the ray of pixel x0 <= x <= x1 meets the box in front of the eye and inside the clip
/// (the slabs between opposite faces have a point in common).
void add_where_met(const EyeBox& box, const BoxRays& rays, int y, int x0, int x1,
                   const float* alone, float* depth) {
    for (int x = x0; x <= x1; ++x) {
        float enter = rays.first[y][x], leave = rays.last[y][x];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float inverse = rays.inverse[axis][y][x], from = rays.origin[axis][y][x];
            const float a = (box.lower[axis] - from) * inverse,
                        b = (box.upper[axis] - from) * inverse;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        depth[x] += enter <= leave ? alone[x] : 0.0f;
    }
}

/// Draws splats into `tile`: each is drawn into a tile of its own, and added where rays meet its box.
template <class Splat, class MakeAlone>
void add_tile(const Boxed<Splat>& splats, std::span<const std::uint32_t> index, const BoxRays& rays,
              TilePixels& tile, const MakeAlone& make_alone) {
    TilePixels alone = tile;
    for (const std::uint32_t n : index) {
        const TileRange range = range_in(tile, splats.bounds[n]);
        for (int y = range.y0; y <= range.y1; ++y)
            std::fill(alone.depth[y] + range.x0, alone.depth[y] + range.x1 + 1, 0.0f);
        make_alone(splats.splat[n], alone);
        for (int y = range.y0; y <= range.y1; ++y)
            add_where_met(splats.box[n], rays, y, range.x0, range.x1, alone.depth[y],
                          tile.depth[y]);
    }
}

/// Splats of a tile: those binned to it, and those of many tiles that touch it.
template <class Splat>
std::vector<std::uint32_t> touching(const Boxed<Splat>& splats, const TileBins& bins, int t,
                                    const CameraFrame& frame) {
    std::vector<std::uint32_t> all;
    visit_bins(bins, splats.bounds, t, frame, [&](const std::uint32_t* index, std::size_t count) {
        all.insert(all.end(), index, index + count);
    });
    return all;
}

template <class Splat>
TileBins bin(const Boxed<Splat>& splats, const CameraFrame& frame) {
    TileBins bins;
    bins.start(frame.width, frame.height, 1);
    bins.count(0, splats.bounds);
    bins.place();
    bins.fill(0, splats.bounds, 0);
    return bins;
}

}  // namespace

void render_boxes(const SplatKernels& kernels, const KernelPolynomial& kernel,
                  const SplatClip& clip, double aabb_sigma, const Progress& progress,
                  DepthImage& image) {
    const SplatModel& model = clip.model;
    const CameraFrame& frame = clip.frame;
    const std::size_t size = model.gaussians->size();
    const std::size_t batch = TileBins::most_splats(frame.width, frame.height);
    std::fill(image.depth.begin(), image.depth.end(), 0.0f);
    std::size_t first = 0;
    do {
        const std::size_t last = std::min(first + batch, size);
        const BoxedSplats splats = project_boxed(kernels, clip, aabb_sigma, first, last);
        const TileBins far = bin(splats.far, frame), near = bin(splats.near, frame);
        vog::parallel_for(0, far.tiles(), [&](int t) {
            const auto far_index = touching(splats.far, far, t, frame);
            const auto near_index = touching(splats.near, near, t, frame);
            if (far_index.empty() && near_index.empty()) return;
            TilePixels tile;
            tile.column = t % far.columns() * kTileWidth;
            tile.row = t / far.columns() * kTileHeight;
            const BoxRays rays = box_rays(clip, tile);
            add_tile(splats.far, far_index, rays, tile,
                     [&](const FarSplat& splat, TilePixels& alone) {
                         const std::uint32_t only = 0;
                         kernels.add_far(&splat, &only, 1, kernel, alone);
                     });
            add_tile(splats.near, near_index, rays, tile,
                     [&](const NearSplat& splat, TilePixels& alone) {
                         kernels.add_near(splat, double{model.cutoff}, rays.clipped, alone);
                     });
            kernels.finish_tile(tile, frame, model.unit, true, image.depth.data());
        });
        if (progress)
            progress(size > 0 ? static_cast<double>(last) / static_cast<double>(size) : 1);
        first = last;
    } while (first < size);
}

}  // namespace vog::splat
