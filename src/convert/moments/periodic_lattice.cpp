// periodic_lattice.cpp: edges and corners of a box, mapped to indices.
#include "convert/moments/periodic_lattice.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "vog/volume.h"

namespace vog::moments {

std::vector<Vec3d> image_shifts(const std::optional<Box>& period, const Affine& world_from_index) {
    std::vector<Vec3d> shifts;
    if (!period) return shifts;
    const Mat3 to_index = inverse(world_from_index).linear;
    const Vec3d edge = period->upper - period->lower;
    for (int n = 0; n < 27; ++n)
        if (const Vec3i step{n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1}; !(step == Vec3i{}))
            shifts.push_back(to_index * Vec3d{step.x * edge.x, step.y * edge.y, step.z * edge.z});
    return shifts;
}

std::optional<IndexBox> leaf_period(const std::optional<Box>& period,
                                    const Affine& world_from_index) {
    if (!period) return {};
    const Affine to_index = inverse(world_from_index);
    const Vec3d a = to_index(period->lower), b = to_index(period->upper);
    IndexBox box;
    for (int axis = 0; axis < 3; ++axis) {
        constexpr double kLimit = 1e9;
        constexpr double kRounding = 1e-3;  // voxels: of transforms and boxes written as text
        for (int other = 0; other < 3; ++other)
            if (other != axis && std::abs(to_index.linear(axis, other)) *
                                         (period->upper[other] - period->lower[other]) >
                                     kRounding)
                return {};
        // Voxel n is [n - 1/2, n + 1/2).
        for (const auto& [at, shift, index] :
             {std::tuple{std::min(a[axis], b[axis]), 0, &box.lower},
              {std::max(a[axis], b[axis]), -1, &box.upper}}) {
            const double leaves = (at + 0.5) / kLeafEdge, whole = std::round(leaves);
            if (!(std::abs(whole) < kLimit / kLeafEdge) ||
                std::abs(leaves - whole) * kLeafEdge > kRounding)
                return {};
            (*index)[axis] = static_cast<int>(whole) * kLeafEdge + shift;
        }
    }
    return box;
}

}  // namespace vog::moments
