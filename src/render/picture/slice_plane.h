// slice_plane.h: the plane of a slice in its data, and the directions of a patient around its picture.
#pragma once

#include <optional>
#include <string>

#include "vog/picture.h"

namespace vog {

/// The plane with its normal and offset.
/// throws  RequestError for directions of a patient where the data have none, and a plane or slab outside of the data
SlicePlane resolved_plane(SlicePlane plane, std::optional<double> thickness,
                          const Subject& subject);

/// Colours and opacities of a layer's plane: opacities that its transfer function states hold as in maps, ramps and windows are opaque,
/// bands, too, and thresholds leave holes. All are multiplied by Layer::opacity.
/// transfer  of the layer's values in a volume
ValueTransfer plane_transfer(ValueTransfer transfer, const Layer& layer);

/// Share of a picture with axes, whose coordinates need room, that a section covers.
inline constexpr double kShareWithAxes = 1 / 1.2;

/// Letters at the sides of a picture: R, L, A, P, S or I.
struct SliceSides {
    std::string left, right, above, below;
};
/// returns  nothing for data that do not say how a patient lies
std::optional<SliceSides> slice_sides(const Camera& camera, const Standing& standing);

}  // namespace vog
