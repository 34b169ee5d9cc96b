// shown_field.h: The field of one picture, relative to its mean over the model and in a unit near its largest
// difference from that, so that sums of floats keep the digits of 300 ± 0.1.
#pragma once

#include <functional>

#include "render/device/field_hit.h"
#include "render/device/voxels/ray_sums.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/field_maps.h"
#include "vog/gaussians.h"
#include "vog/progress.h"

namespace vog {

inline device::Double3 plain(Vec3d v) { return {v.x, v.y, v.z}; }
inline Vec3d vec(device::Double3 v) { return {v.x, v.y, v.z}; }

/// The shown part of a field.
struct ShownField {
    const ScalarField* scalar = nullptr;  ///< null: a vector field
    const VectorField* vector = nullptr;
    /// Unit vector, world: the component of a vector field that is shown as a scalar one; unused if along_rays.
    Vec3d direction;
    bool along_rays = false;  ///< component along each ray, whose directions differ
    double unit = 1;          ///< a power of two: |field - reference| < unit inside every support
    Vec3d reference;          ///< subtracted from the values; of scalars x alone

    /// The field in Gaussian i, without `along_rays`: (field - reference) / unit.
    device::FieldPlane plane(std::size_t i) const;
    /// All components likewise, for `along_rays`.
    device::VectorPlane vector_plane(std::size_t i) const;
    /// The field in Gaussian i along a direction: of `along_rays` the component times its length.
    device::FieldPlane plane_along(std::size_t i, Vec3d towards) const {
        return along_rays ? device::plane_along(vector_plane(i), plain(towards)) : plane(i);
    }
    /// The reference along a direction of length 1.
    double reference_along(Vec3d towards) const {
        return along_rays ? dot(reference, towards) : reference.x;
    }
};

/// The field and part that a picture shows.
/// frame   of the picture
/// cutoff  k of its kernels
/// throws  vog::Error for a field that the model lacks
ShownField shown_field(const Gaussians& gaussians, const FieldChoice& choice,
                       const CameraFrame& frame, double cutoff);
/// The same without reference and unit, for one direction of rays, of any length > 0.
ShownField field_towards(const Gaussians& gaussians, const FieldChoice& choice, Vec3d direction);

/// A field inside a Gaussian drawn as a point: constant, with the whole variance, the residual's and the
/// plane's over the truncated kernel.
/// share  variance_within(k)
device::FieldPlane constant_plane(const device::FieldPlane& plane, const Gaussians& gaussians,
                                  std::size_t i, double share);

using device::RaySums;
/// Fills pixel n of the maps.
/// column     in its unit
/// reference  ShownField::reference_along
/// unit       of first / column, the square of which is that of second / column
inline void set_pixel(FieldMaps& maps, std::size_t n, const RaySums& sums, double column,
                      double reference, double unit) {
    maps.column[n] = static_cast<float>(column);
    if (!(maps.column[n] > 0)) return;
    const double per_column = 1 / sums.column, mean = sums.first * per_column;
    maps.mean[n] = static_cast<float>(reference + unit * mean);
    maps.deviation[n] =
        static_cast<float>(unit * std::sqrt(std::max(sums.second * per_column - mean * mean, 0.0)));
}
/// Maps of FieldPart::magnitude from those of the components.
/// render  called with FieldPart::x, y and z, and the part of the progress that is its own
FieldMaps magnitude_maps(const Progress& progress,
                         const std::function<FieldMaps(FieldPart, const Progress&)>& render);
/// Maps without any column.
FieldMaps empty_maps(int width, int height);

/// Contributions of Gaussian i to the sums along o + t r, t >= 0, in double precision by the closed form: the
/// measure, the measure times the field, and times its square. Every renderer is tested against this function.
/// FieldPart::magnitude has no first sum: 0.
/// clip  space that counts
struct FieldSums {
    double column = 0, first = 0, second = 0;
};
FieldSums field_sums(const Gaussians& gaussians, const FieldChoice& choice, std::size_t i,
                     Vec3d origin, Vec3d direction, const Clipping& clip = {});

}  // namespace vog
