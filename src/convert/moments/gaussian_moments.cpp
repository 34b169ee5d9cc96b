// gaussian_moments.cpp: moment sums of a leaf's cubes, and the truncated Gaussian with given
// moments.
#include "convert/moments/gaussian_moments.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/paging.h"
#include "data/fields/field_arrays.h"
#include "vog/error.h"

namespace vog::moments {

Moments moments_of(const MomentSums& sums) {
    Moments result;
    const double inverse_mass = 1 / sums.mass;
    result.mass = sums.mass;
    result.mean = inverse_mass * sums.first;
    const Vec3d m = result.mean;
    const std::array<double, 6> squares{m.x * m.x, m.x * m.y, m.x * m.z,
                                        m.y * m.y, m.y * m.z, m.z * m.z};
    for (std::size_t n = 0; n < 6; ++n)
        result.covariance[n] = sums.second[n] * inverse_mass - squares[n];
    // No variance is below that of one voxel, except by rounding.
    for (const std::size_t n : {0, 3, 5})
        result.covariance[n] = std::max(result.covariance[n], kBoxVariance);
    return result;
}

Moments joined_moments(std::span<const Moments> parts) {
    Moments sum;
    for (const Moments& part : parts) {
        sum.mass += part.mass;
        sum.mean = sum.mean + part.mass * part.mean;
    }
    sum.mean = (1 / sum.mass) * sum.mean;
    // Second moments about the joint mean: squares of coordinates would cancel.
    for (const Moments& part : parts) {
        const Vec3d d = part.mean - sum.mean;
        const std::array<double, 6> squares{d.x * d.x, d.x * d.y, d.x * d.z,
                                            d.y * d.y, d.y * d.z, d.z * d.z};
        for (std::size_t n = 0; n < 6; ++n)
            sum.covariance[n] += part.mass / sum.mass * (part.covariance[n] + squares[n]);
    }
    return sum;
}

MomentSums sums_of(const Moments& moments) {
    const Vec3d m = moments.mean;
    const std::array<double, 6> squares{m.x * m.x, m.x * m.y, m.x * m.z,
                                        m.y * m.y, m.y * m.z, m.z * m.z};
    MomentSums sums{moments.mass, moments.mass * m, {}};
    for (std::size_t n = 0; n < 6; ++n)
        sums.second[n] = moments.mass * (moments.covariance[n] + squares[n]);
    return sums;
}

LeafSums<2> leaf_sums(const Leaf& leaf) {
    LeafSums<2> sums;
    for (int n = 0; n < 64; ++n) {
        const Vec3i place = morton_place(n);
        const float* v = leaf.value.data() + leaf_offset(2 * place.x, 2 * place.y, 2 * place.z);
        // The voxels lie half a voxel from the centre on each axis: all sums are signed sums of the
        // eight values, a Hadamard transform. Inactive voxels hold 0.
        const double a = v[0], b = v[1], c = v[8], d = v[9];
        const double e = v[64], f = v[65], g = v[72], h = v[73];
        const double z00 = b + a, z01 = d + c, z10 = f + e, z11 = h + g;
        const double w00 = b - a, w01 = d - c, w10 = f - e, w11 = h - g;
        const double y0 = z01 + z00, y1 = z11 + z10, p0 = z01 - z00, p1 = z11 - z10;
        const double q0 = w01 + w00, q1 = w11 + w10, r0 = w01 - w00, r1 = w11 - w10;
        const double mass = y1 + y0;
        constexpr double kHalf = 0.5, kQuarter = 0.25;
        const double square = mass * (kQuarter + kBoxVariance);
        sums[static_cast<std::size_t>(n)] = {
            mass,
            {kHalf * (y1 - y0), kHalf * (p1 + p0), kHalf * (q1 + q0)},
            {square, kQuarter * (p1 - p0), kQuarter * (q1 - q0), square, kQuarter * (r1 + r0),
             square}};
    }
    return sums;
}

template <int edge>
LeafSums<2 * edge> merge_eight(const LeafSums<edge>& fine) {
    LeafSums<2 * edge> coarse;
    constexpr double kOffset = 0.5 * edge;
    for (std::size_t n = 0; n < coarse.size(); ++n)
        for (std::size_t child = 0; child < 8; ++child)
            if (fine[8 * n + child].mass > 0)
                add_shifted(coarse[n], fine[8 * n + child],
                            {child & 4 ? kOffset : -kOffset, child & 2 ? kOffset : -kOffset,
                             child & 1 ? kOffset : -kOffset});
    return coarse;
}
template LeafSums<4> merge_eight<2>(const LeafSums<2>&);
template LeafSums<8> merge_eight<4>(const LeafSums<4>&);

MomentFrame moment_frame(const Affine& world_from_index, bool axis_aligned, double spread,
                         double cutoff) {
    MomentFrame frame;
    frame.world_from_index = world_from_index;
    frame.voxel_volume = std::abs(determinant(world_from_index.linear));
    frame.axis_aligned = axis_aligned;
    frame.spread = spread;
    frame.widening2 = 1 / variance_within(cutoff);
    frame.density_factor = 1 / (std::pow(2 * std::numbers::pi, 1.5) * mass_within(cutoff));
    return frame;
}

void resize(Gaussians& model, std::size_t count, bool axis_aligned) {
    resize_kept(model.mean, count);
    resize_kept(model.scale, count);
    resize_kept(model.density, count);
    if (!axis_aligned) resize_kept(model.rotation, count);
    each_array([&](auto& array) { resize_kept(array, count); }, model.fields);
}

void set_gaussian(Gaussians& model, std::size_t i, const Moments& moments,
                  const MomentFrame& frame) {
    // Covariance in world space, then widened so that the kernel has it after truncation.
    const std::array<double, 6>& c = moments.covariance;
    const Mat3 index{{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, Vec3d{c[2], c[4], c[5]}}};
    const Mat3& map = frame.world_from_index.linear;
    const Mat3 world = map * index * transpose(map);
    Vec3d variance{world(0, 0), world(1, 1), world(2, 2)};
    if (!frame.axis_aligned) {
        const Eigen3 eigen = symmetric_eigen(world);
        variance = eigen.values;
        model.rotation[i] = quat_from_matrix(eigen.axes);
    }
    // The smallest eigenvalue of a long thin cell may be rounding error, even negative. Floor: a
    // ratio of 1e-6 between standard deviations, near the resolution of float32.
    const double floor = 1e-12 * std::max({variance.x, variance.y, variance.z});
    Vec3d scale;
    for (int axis = 0; axis < 3; ++axis)
        scale[axis] = frame.spread * std::sqrt(frame.widening2 * std::max(variance[axis], floor));
    model.mean[i] = vec_cast<float>(frame.world_from_index(moments.mean));
    model.scale[i] = vec_cast<float>(scale);
    // From the rounded scales, so that the mass is right to one rounding.
    const Vec3d s = vec_cast<double>(model.scale[i]);
    model.density[i] = static_cast<float>(moments.mass * frame.voxel_volume * frame.density_factor /
                                          (s.x * s.y * s.z));
}

std::array<double, 6> kernel_covariance(const Gaussians& model, std::size_t i) {
    Mat3 scaled = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    const Vec3d s = vec_cast<double>(model.scale[i]);
    for (Vec3d& row : scaled.row) row = {row.x * s.x, row.y * s.y, row.z * s.z};
    const auto at = [&](std::size_t a, std::size_t b) { return dot(scaled.row[a], scaled.row[b]); };
    return {at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)};
}

void check_density_range(const Gaussians& model, const std::string& source) {
    constexpr float kSmallest = std::numeric_limits<float>::min();
    float largest = 0;
    for (const float density : model.density) largest = std::max(largest, density);
    if (model.size() == 0 || (largest >= kSmallest && std::isfinite(largest))) return;
    throw Error(
        fmt::format("{}: {:.2g} world units across, which gives densities {} {:.2g}, expected "
                    "within the range of 32-bit floats: other units of length or of values",
                    source, 2 * model.box.radius(), largest < kSmallest ? "below" : "above",
                    largest < kSmallest ? kSmallest : std::numeric_limits<float>::max()));
}

}  // namespace vog::moments
