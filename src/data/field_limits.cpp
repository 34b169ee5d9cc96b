// field_limits.cpp: The limiter of T. J. Barth and D. C. Jespersen, "The design and application of upwind schemes on
// unstructured meshes" (1989), for the planes of Gaussians.
#include "data/field_limits.h"

namespace vog {

double plane_variance(const Gaussians& gaussians, const ScalarField& field, std::size_t i) {
    const Vec3d g = vec_cast<double>(field.gradient[i]);
    const Vec3d own =
        gaussians.axis_aligned() ? g : transpose(matrix_from_quat(gaussians.rotation[i])) * g;
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    const Vec3d across{own.x * s.x, own.y * s.y, own.z * s.z};
    return dot(across, across);
}

}  // namespace vog
