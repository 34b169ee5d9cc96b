// exact_pixels.h: closed forms of single pixels under a clip, of voxels and models, in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/shown_field.h"
#include "render/splat/splat.h"
#include "support/ray_voxels.h"
#include "vog/clip.h"
#include "vog/field_maps.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"

namespace vog::test {

/// Piece of a ray in one voxel.
struct Piece {
    double first, last, density, heat;
};
inline std::vector<Piece> pieces_of(const Volume& volume, const VoxelField& heat, Vec3d origin,
                                    Vec3d direction, const Clipping& clip) {
    const IndexRay ray(volume, origin, direction);
    const RayInterval shown = clipped_ray(clip, origin, direction);
    std::vector<Piece> pieces;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Leaf& leaf = volume.leaves[l];
            if (!leaf.active(n)) continue;
            const Vec3d at = vec_cast<double>(leaf.origin) +
                             Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)};
            const Vec3d half{0.5, 0.5, 0.5};
            auto [first, last] = ray.cut(at - half, at + half);
            first = std::max(first, shown.first), last = std::min(last, shown.last);
            if (first >= last) continue;
            const auto v = static_cast<std::size_t>(n);
            pieces.push_back(
                {first, last, double{leaf.value[v]}, double{heat.component.front().leaf[l][v]}});
        }
    std::ranges::sort(pieces, {}, &Piece::first);
    return pieces;
}

/// Closed form of one pixel.
struct Exact {
    double column = 0, mean = 0, deviation = 0;
    double maximum = std::numeric_limits<double>::quiet_NaN();
    Rgba light{0, 0, 0, 0};
};
inline Exact exact_voxels(const std::vector<Piece>& pieces, const ValueTransfer& transfer) {
    Exact exact;
    double first = 0, second = 0, through = 1, r = 0, g = 0, b = 0;
    for (const Piece& piece : pieces) {
        const double length = piece.last - piece.first, mass = length * piece.density;
        exact.column += mass, first += mass * piece.heat;
        exact.maximum = std::fmax(exact.maximum, piece.heat);
        const ValueLight light = light_of(transfer, piece.heat);
        // Other fields than the density itself are weighed by it.
        const double seen = through * -std::expm1(-light.extinction * mass);
        r += seen * light.r, g += seen * light.g, b += seen * light.b, through -= seen;
    }
    if (exact.column > 0) exact.mean = first / exact.column;
    for (const Piece& piece : pieces)
        second += (piece.last - piece.first) * piece.density * (piece.heat - exact.mean) *
                  (piece.heat - exact.mean);
    if (exact.column > 0) exact.deviation = std::sqrt(second / exact.column);
    exact.light = {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b),
                   static_cast<float>(1 - through)};
    return exact;
}
inline Exact exact_model(const Gaussians& model, Vec3d origin, Vec3d direction,
                         const Clipping& clip) {
    Exact exact;
    double first = 0, second = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const FieldSums sums =
            field_sums(model, {"temperature", FieldPart::value}, i, origin, direction, clip);
        exact.column += sums.column, first += sums.first, second += sums.second;
    }
    if (!(exact.column > 0)) return exact;
    exact.mean = first / exact.column;
    exact.deviation = std::sqrt(std::max(second / exact.column - exact.mean * exact.mean, 0.0));
    return exact;
}

/// Whether the part of a ray that stays meets the paper's box of a Gaussian, clipped to the model's.
inline bool meets_box(const Gaussians& model, std::size_t i, double aabb_sigma, Vec3d origin,
                      Vec3d direction, const Clipping& clip) {
    RayInterval met = clipped_ray(clip, origin, direction);
    const Box scene = view_box(model);
    const Mat3 axes = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    const Vec3d scale = vec_cast<double>(model.scale[i]), mean = world_mean(model, i);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d row = axes.row[static_cast<std::size_t>(axis)];
        const double half = aabb_sigma * std::sqrt(2.0) *
                            length(Vec3d{row.x * scale.x, row.y * scale.y, row.z * scale.z});
        const auto face = [&](double at) {
            return (std::clamp(at, scene.lower[axis], scene.upper[axis]) - origin[axis]) /
                   direction[axis];
        };
        const double a = face(mean[axis] - half), b = face(mean[axis] + half);
        met.first = std::max(met.first, std::min(a, b));
        met.last = std::min(met.last, std::max(a, b));
    }
    return met.first <= met.last;
}
inline double exact_depth(const Gaussians& model, double aabb_sigma, Vec3d origin, Vec3d direction,
                          const Clipping& clip) {
    const RayInterval shown = clipped_ray(clip, origin, direction);
    double depth = 0;
    if (!(shown.first < shown.last)) return depth;
    for (std::size_t i = 0; i < model.size(); ++i) {
        if (aabb_sigma > 0 && !meets_box(model, i, aabb_sigma, origin, direction, clip)) continue;
        depth += optical_depth(model, i, origin + shown.first * direction, direction);
        if (std::isfinite(shown.last))
            depth -= optical_depth(model, i, origin + shown.last * direction, direction);
    }
    return depth;
}

}  // namespace vog::test
