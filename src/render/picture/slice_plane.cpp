// slice_plane.cpp: plane and view of a slice.
#include "render/picture/slice_plane.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "vog/error.h"
#include "vog/text.h"

namespace vog {

namespace {

constexpr std::array<const char*, 6> kAxes = {"x", "y", "z", "axial", "coronal", "sagittal"};

std::size_t axis_of(const SlicePlane& plane) {
    return static_cast<std::size_t>(std::ranges::find(kAxes, plane.axis) - kAxes.begin());
}

/// Unit vectors upwards in the picture and to the observer.
struct Facing {
    Vec3d up, towards;
};
Facing facing_of(const SlicePlane& plane, const Standing& standing) {
    const std::size_t axis = axis_of(plane);
    Facing facing{{}, normalized(plane.normal)};
    if (axis < 3)
        facing.up[static_cast<int>(axis + 2) % 3] = 1;
    else if (axis < kAxes.size())
        facing.up = plane.axis == std::string("axial") ? standing.front : standing.up;
    else
        facing.up = std::abs(facing.towards.z) < 0.999 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    // The patient's right is at the left.
    if (plane.axis == "axial" || plane.axis == "sagittal") facing.towards = -facing.towards;
    return facing;
}

Vec3d corner_of(const Box& box, int n) {
    return {n & 1 ? box.upper.x : box.lower.x, n & 2 ? box.upper.y : box.lower.y,
            n & 4 ? box.upper.z : box.lower.z};
}

/// Calls visit(point) for the corners of the section of a box.
template <class Visit>
void each_corner(const Box& box, const SlicePlane& plane, const Visit& visit) {
    for (int n = 0; n < 8; ++n)
        for (const int bit : {1, 2, 4}) {
            if (n & bit) continue;
            const Vec3d from = corner_of(box, n), along = corner_of(box, n | bit) - from;
            const double ahead = *plane.offset - dot(plane.normal, from);
            const double slope = dot(plane.normal, along);
            if (slope == 0) {
                if (ahead == 0) visit(from), visit(from + along);
            } else if (const double t = ahead / slope; t >= 0 && t <= 1) {
                visit(from + t * along);
            }
        }
}

}  // namespace

std::span<const char* const> slice_axes() { return kAxes; }

SlicePlane resolved_plane(SlicePlane plane, std::optional<double> thickness,
                          const Subject& subject) {
    const Standing& standing = subject.content.standing;
    const std::size_t axis = axis_of(plane);
    const bool medical = axis >= 3 && axis < kAxes.size();
    if (medical && standing.front == Vec3d{})
        throw RequestError("plane",
                           fmt::format(" {}: the data do not say where a patient's front is, "
                                       "expected x, y or z, as in z=0.5, or NX,NY,NZ,D",
                                       plane.axis));
    if (axis < 3) {
        plane.normal = {};
        plane.normal[static_cast<int>(axis)] = 1;
    } else if (medical) {
        plane.normal = plane.axis == "axial"     ? standing.up
                       : plane.axis == "coronal" ? standing.front
                                                 : cross(standing.front, standing.up);
    }
    const Box box = outline_of(subject);
    if (box.empty()) {
        plane.offset = plane.offset.value_or(0);
        return plane;
    }
    double low = dot(plane.normal, corner_of(box, 0)), high = low;
    for (int n = 1; n < 8; ++n) {
        low = std::min(low, dot(plane.normal, corner_of(box, n)));
        high = std::max(high, dot(plane.normal, corner_of(box, n)));
    }
    if (!plane.offset) plane.offset = std::midpoint(low, high);
    const double half = 0.5 * thickness.value_or(0) * length(plane.normal);
    if (*plane.offset + half < low || *plane.offset - half > high)
        throw RequestError(
            "plane",
            fmt::format("{}: lies outside of the data, which extend from {:.6g} to {:.6g}",
                        plane.axis.empty() ? fmt::format(" with offset {}", *plane.offset)
                                           : fmt::format(" {}={}", plane.axis, *plane.offset),
                        low, high));
    return plane;
}

Camera slice_view(const Subject& subject, const SlicePlane& plane, int width, int height,
                  double share) {
    const Facing facing = facing_of(plane, subject.content.standing);
    const Vec3d right = normalized(cross(facing.up, facing.towards));
    const Vec3d up = cross(facing.towards, right);
    const Box box = outline_of(subject);
    const double per = 1 / dot(plane.normal, plane.normal);
    Box picture;
    if (!box.empty())
        each_corner(box, plane, [&](Vec3d corner) {
            picture.include(Vec3d{dot(corner, right), dot(corner, up), 0});
        });
    const bool empty = picture.empty();  // a thick slice may meet the data where its plane does not
    const Vec3d middle = empty ? Vec3d{} : picture.center(),
                sides = empty ? Vec3d{} : picture.upper - picture.lower;
    Camera camera;
    camera.look_at = middle.x * right + middle.y * up + (*plane.offset * per) * plane.normal;
    camera.up = up;
    camera.orthographic_width = std::max(sides.x, sides.y * width / height) / share;
    const double size = box.empty() ? 0 : 2 * box.radius();
    if (!(camera.orthographic_width > 0)) camera.orthographic_width = size > 0 ? size : 1;
    // In front of the data, and of a slab that holds them.
    camera.eye = camera.look_at + (size > 0 ? 2 * size : 1) * facing.towards;
    return camera;
}

ValueTransfer plane_transfer(ValueTransfer transfer, const Layer& layer) {
    const TransferRequest& stated = layer.transfer;
    if (!stated.bands.empty())
        for (ValueOpacity& point : transfer.opacity) point.opacity = point.opacity > 0 ? 1 : 0;
    else if (stated.points.points.opacity.empty())
        transfer.opacity = {{0, 1}};
    for (ValueOpacity& point : transfer.opacity) point.opacity *= layer.opacity.value_or(1);
    return stated.threshold ? above(std::move(transfer), *stated.threshold) : transfer;
}

std::optional<SliceSides> slice_sides(const Camera& camera, const Standing& standing) {
    if (standing.front == Vec3d{} || !standing.known()) return {};
    const CameraFrame frame = frame_of(camera, 1, 1);
    const Vec3d axes[] = {cross(standing.front, standing.up), standing.front, standing.up};
    const auto letter = [&](Vec3d direction) {
        int most = 0;
        for (int n = 1; n < 3; ++n)
            if (std::abs(dot(direction, axes[n])) > std::abs(dot(direction, axes[most]))) most = n;
        return std::string(1, (dot(direction, axes[most]) > 0 ? "RAS" : "LPI")[most]);
    };
    return SliceSides{letter(-frame.right), letter(frame.right), letter(frame.up),
                      letter(-frame.up)};
}

}  // namespace vog
