// voxel_sums.h: Maps of a field, light by value and maxima along rays through NanoVDB grids, exact for voxels of constant
// value. The formulas are the reference's (src/render/reference/fields).
#pragma once

#include "render/device/voxels/ray_sums.h"
#include "render/device/voxels/voxel_picture.h"
#include "render/device/voxels/voxel_walk.h"

namespace vog::device {

VOG_HD const NanoVoxels& voxels_of(const void* grid) {
    return *static_cast<const NanoVoxels*>(grid);
}

/// The value of the field at a voxel.
/// towards  unit length
VOG_HD double value_at(const VoxelPicture& p, const VoxelVolume& v, const VoxelPiece& at,
                       Double3 towards) {
    if (!v.component[0]) return at.density + v.background;
    double value[3] = {0, 0, 0};
    for (int n = 0; n < (p.along_rays ? 3 : 1); ++n) {
        const auto& tree = voxels_of(v.component[n]).tree();
        // Leaves of both grids have the same order.
        value[n] = static_cast<double>(
            at.leaf
                ? tree.getFirstNode<0>()[at.leaf - voxels_of(v.density).tree().getFirstNode<0>()]
                      .getValue(VoxelLeaf::CoordToOffset(at.voxel))
                : tree.getValue(at.voxel));
    }
    return p.along_rays ? dot(towards, {value[0], value[1], value[2]}) : value[0];
}

/// Value of a neighbour: inactive ones have the background where the field is the density, else that of the voxel.
VOG_HD double neighbour(const VoxelVolume& v, nanovdb::Coord at, double otherwise) {
    const auto& tree = voxels_of(v.density).tree();
    if (!v.component[0]) return static_cast<double>(tree.getValue(at)) + v.background;
    return tree.isActive(at) ? static_cast<double>(voxels_of(v.component[0]).tree().getValue(at))
                             : otherwise;
}
/// Gradient by central differences, per world unit; inside tiles 0.
VOG_HD Double3 gradient_at(const VoxelVolume& v, const VoxelPiece& at, double value) {
    if (!at.leaf) return {0, 0, 0};
    double per_voxel[3];
    for (int axis = 0; axis < 3; ++axis) {
        nanovdb::Coord ahead = at.voxel, behind = at.voxel;
        ++ahead[axis];
        --behind[axis];
        per_voxel[axis] = (neighbour(v, ahead, value) - neighbour(v, behind, value)) / 2;
    }
    return v.to_world({per_voxel[0], per_voxel[1], per_voxel[2]});
}

/// Light of a voxel with its shading.
VOG_HD LightOfValue light_at(const VoxelPicture& p, const VoxelVolume& v, const VoxelPiece& at,
                             Double3 towards) {
    const double value = value_at(p, v, at, towards);
    LightOfValue light = p.transfer.light(value);
    if (v.component[0]) light.extinction *= at.density;
    const bool by_gradient = p.transfer.gradient.any();
    if (!(p.look.on || by_gradient) || !(light.extinction > 0)) return light;
    const Double3 gradient = gradient_at(v, at, value);
    if (by_gradient) light.extinction *= p.transfer.factor(sqrt(dot(gradient, gradient)));
    if (!p.look.on) return light;
    const Shading by = p.look.shading(gradient, -1.0 * towards, {nullptr, towards, 0, 1});
    for (int n = 0; n < 3; ++n) light.color[n] = fmin(by.body * light.color[n] + by.shine, 1.0);
    return light;
}

/// A ray of the picture in the world.
struct VoxelRay {
    Double3 origin, direction;
    RayPart part;    ///< that the clip leaves
    double stretch;  ///< world units of one t

    VOG_HD Double3 towards() const { return (1 / stretch) * direction; }
};
VOG_HD VoxelRay voxel_ray(const VoxelPicture& p, double column, double row) {
    const Camera& c = p.camera;
    VoxelRay ray{c.eye + column * c.shift_x + row * c.shift_y,
                 c.corner + column * c.step_x + row * c.step_y, RayPart{0, HUGE_VAL}, 0};
    for (int32_t n = 0; n < p.plane_count; ++n)
        cut(ray.part, p.planes[n], ray.origin, ray.direction);
    ray.stretch = sqrt(dot(ray.direction, ray.direction));
    return ray;
}
VOG_HD VoxelWalk walk_of(const VoxelVolume& v, const VoxelRay& ray) {
    return walk_of(voxels_of(v.density), v.to_grid(ray.origin - v.corner) + v.corner_in_grid,
                   v.to_grid(ray.direction), ray.part);
}

/// Sums over the rays of a pixel.
struct VoxelPixel {
    FirstRelative sums;
    double light[4] = {0, 0, 0, 0};  ///< colours and alpha
    double largest = 0, met = 0;     ///< sum of the rays' maxima, and their number
};

VOG_HD void add_field(const VoxelPicture& p, const VoxelRay& ray, FirstRelative& sums) {
    const Double3 towards = ray.towards();
    for (int32_t n = 0; n < p.count; ++n) {
        const VoxelVolume& v = p.volume[n];
        const VoxelAccessor accessor = voxels_of(v.density).getAccessor();
        VoxelWalk walk = walk_of(v, ray);
        VoxelPiece at;
        while (walk.next(accessor, at))
            sums.add(at.density * (at.last - at.first) * ray.stretch, value_at(p, v, at, towards));
    }
}

VOG_HD void add_maximum(const VoxelPicture& p, const VoxelRay& ray, VoxelPixel& pixel) {
    double largest = -HUGE_VAL;
    for (int32_t n = 0; n < p.count; ++n) {
        const VoxelVolume& v = p.volume[n];
        const VoxelAccessor accessor = voxels_of(v.density).getAccessor();
        VoxelWalk walk = walk_of(v, ray);
        VoxelPiece at;
        while (walk.next(accessor, at)) largest = fmax(largest, value_at(p, v, at, ray.towards()));
    }
    if (!(largest > -HUGE_VAL)) return;
    pixel.largest += largest;
    ++pixel.met;
}

/// Light of one volume.
VOG_HD RayLight light_of_one(const VoxelPicture& p, const VoxelRay& ray) {
    const VoxelVolume& v = p.volume[0];
    const VoxelAccessor accessor = voxels_of(v.density).getAccessor();
    VoxelWalk walk = walk_of(v, ray);
    VoxelPiece at;
    RayLight seen;
    while (!seen.opaque() && walk.next(accessor, at)) {
        const LightOfValue light = light_at(p, v, at, ray.towards());
        const double depth = light.extinction * (at.last - at.first) * ray.stretch;
        if (depth > 0) seen.add(depth, light.color[0], light.color[1], light.color[2]);
    }
    return seen;
}

/// A volume with the next piece of a ray that absorbs.
struct LitWalk {
    VoxelWalk walk;
    double first, last;  ///< t; first HUGE_VAL: none is left
    LightOfValue light;
};
VOG_HD void move_on(const VoxelPicture& p, const VoxelVolume& v, const VoxelRay& ray, LitWalk& to) {
    const VoxelAccessor accessor = voxels_of(v.density).getAccessor();
    VoxelPiece at;
    while (to.walk.next(accessor, at)) {
        to.light = light_at(p, v, at, ray.towards());
        to.first = at.first;
        to.last = at.last;
        if (to.light.extinction > 0) return;
    }
    to.first = HUGE_VAL;
}

/// Light of several volumes, all on their way at once; where they overlap, extinctions add up.
VOG_HD RayLight light_of_all(const VoxelPicture& p, const VoxelRay& ray) {
    LitWalk lit[kMostLitVolumes];
    for (int32_t n = 0; n < p.count; ++n) {
        lit[n].walk = walk_of(p.volume[n], ray);
        move_on(p, p.volume[n], ray, lit[n]);
    }
    RayLight seen;
    double at = 0;
    while (!seen.opaque()) {
        double until = HUGE_VAL;
        LightOfValue sum{0, {0, 0, 0}};
        for (int32_t n = 0; n < p.count; ++n) {
            if (lit[n].first > at) {
                until = fmin(until, lit[n].first);
                continue;
            }
            const LightOfValue& light = lit[n].light;
            until = fmin(until, lit[n].last);
            sum.extinction += light.extinction;
            for (int c = 0; c < 3; ++c) sum.color[c] += light.extinction * light.color[c];
        }
        if (until == HUGE_VAL) break;
        if (sum.extinction > 0) {
            const double per_extinction = 1 / sum.extinction;
            seen.add(sum.extinction * (until - at) * ray.stretch, per_extinction * sum.color[0],
                     per_extinction * sum.color[1], per_extinction * sum.color[2]);
        }
        at = until;
        for (int32_t n = 0; n < p.count; ++n)
            if (lit[n].first < HUGE_VAL && lit[n].last <= at) move_on(p, p.volume[n], ray, lit[n]);
    }
    return seen;
}

/// Adds one ray of a pixel.
VOG_HD void add_ray(const VoxelPicture& p, const VoxelRay& ray, VoxelPixel& pixel) {
    if (!(ray.part.first < ray.part.last)) return;
    if (p.kind == VoxelKind::sums) return add_field(p, ray, pixel.sums);
    if (p.kind == VoxelKind::maximum) return add_maximum(p, ray, pixel);
    const RayLight seen = p.count == 1 ? light_of_one(p, ray) : light_of_all(p, ray);
    pixel.light[0] += seen.r;
    pixel.light[1] += seen.g;
    pixel.light[2] += seen.b;
    pixel.light[3] += 1 - seen.transmittance;
}

VOG_HD void write_pixel(const VoxelPicture& p, uint32_t at, const VoxelPixel& pixel) {
    double* out = p.out + 4 * static_cast<uint64_t>(at);
    const RaySums& sums = pixel.sums.sums;
    const double of_sums[4] = {sums.column, sums.first, sums.second, pixel.sums.reference};
    const double of_maximum[4] = {pixel.largest, pixel.met, 0, 0};
    const double* from = p.kind == VoxelKind::sums      ? of_sums
                         : p.kind == VoxelKind::maximum ? of_maximum
                                                        : pixel.light;
    for (int n = 0; n < 4; ++n) out[n] = from[n];
}

}  // namespace vog::device
