// split_merge.cpp: halves of a cell, and the rules for cells of density alone.
#include "convert/moments/refine/split_merge.h"

#include <cmath>
#include <numbers>

namespace vog::moments {

double log_determinant(const std::array<double, 6>& covariance) {
    const auto& [xx, xy, xz, yy, yz, zz] = covariance;
    const double determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    constexpr double kLeast = 1e-30;  // rounding may make that of a thin cell 0
    return std::log(std::max(determinant, kLeast));
}

std::array<Moments, 2> split_in_two(const Moments& cell, Vec3d shift) {
    std::array<Moments, 2> parts{cell, cell};
    const std::array<double, 6> square{shift.x * shift.x, shift.x * shift.y, shift.x * shift.z,
                                       shift.y * shift.y, shift.y * shift.z, shift.z * shift.z};
    for (Moments& part : parts) {
        part.mass *= 0.5;
        for (std::size_t n = 0; n < 6; ++n) part.covariance[n] -= square[n];
    }
    parts[0].mean = cell.mean - shift;
    parts[1].mean = cell.mean + shift;
    return parts;
}

std::array<Moments, 2> split_in_two(const Moments& cell) {
    const auto& [xx, xy, xz, yy, yz, zz] = cell.covariance;
    const Eigen3 eigen =
        symmetric_eigen({{Vec3d{xx, xy, xz}, Vec3d{xy, yy, yz}, Vec3d{xz, yz, zz}}});
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (eigen.values[axis] > eigen.values[longest]) longest = axis;
    return split_in_two(
        cell, std::sqrt(eigen.values[longest] * kHalvesVariance) * eigen.axes.column(longest));
}

namespace {

struct DensityRules {
    const VisibilityWeight& visibility;

    struct Candidate {
        Moments cell;
        double log_determinant, visibility;
    };
    static Vec3d mean(const Moments& cell) { return cell.mean; }
    Candidate candidate(const Moments& cell) const {
        return {cell, moments::log_determinant(cell.covariance), visibility(cell.mean)};
    }
    static Moments joined(const Moments& a, const Moments& b) {
        return joined_moments(std::array{a, b});
    }
    static std::array<Moments, 2> split(const Moments& cell) { return split_in_two(cell); }
    static double cost(const Candidate& a, const Candidate& b) {
        const Moments both = joined(a.cell, b.cell);
        const double divergence =
            0.5 * (both.mass * moments::log_determinant(both.covariance) -
                   a.cell.mass * a.log_determinant - b.cell.mass * b.log_determinant);
        return divergence * 0.5 * (a.visibility + b.visibility) / std::sqrt(both.mass);
    }
};

}  // namespace

void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& visibility) {
    split_and_merge(cells, error, share, DensityRules{visibility});
}

}  // namespace vog::moments
