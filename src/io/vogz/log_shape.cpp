// log_shape.cpp: logarithm and exponential of covariances.
#include "io/vogz/log_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vog::vogz {

namespace {

float scale_of(double logarithm) {
    using Limits = std::numeric_limits<float>;
    return std::clamp(static_cast<float>(std::exp(std::clamp(logarithm, -200.0, 200.0))),
                      Limits::denorm_min(), Limits::max());
}

}  // namespace

LogShape log_shape(const Gaussians& model, std::size_t i) {
    const Vec3f s = model.scale[i];
    const Vec3d l{std::log(double{s.x}), std::log(double{s.y}), std::log(double{s.z})};
    if (model.axis_aligned()) return {l.x, l.y, l.z};
    const Mat3 r = matrix_from_quat(model.rotation[i]);
    const auto entry = [&](std::size_t a, std::size_t b) {
        const Vec3d p = r.row[a], q = r.row[b];
        return p.x * q.x * l.x + p.y * q.y * l.y + p.z * q.z * l.z;
    };
    return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
}

void set_shape(Gaussians& model, std::size_t i, const LogShape& l) {
    if (model.axis_aligned()) {
        model.scale[i] = {scale_of(l[0]), scale_of(l[1]), scale_of(l[2])};
        return;
    }
    const Eigen3 eigen = symmetric_eigen(
        {{Vec3d{l[0], l[3], l[4]}, Vec3d{l[3], l[1], l[5]}, Vec3d{l[4], l[5], l[2]}}});
    model.scale[i] = {scale_of(eigen.values.x), scale_of(eigen.values.y), scale_of(eigen.values.z)};
    model.rotation[i] = quat_from_matrix(eigen.axes);
}

}  // namespace vog::vogz
