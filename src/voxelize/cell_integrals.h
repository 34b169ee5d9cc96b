// cell_integrals.h: integrals of one truncated Gaussian over the voxels of a box.
//
// In index space the Gaussian is x = m + G u, |u| <= k, with exp(-|u|^2 / 2) du: G is the lower triangular factor of its
// covariance, so that
//   x1 = m1 + g11 u1,   x2 = m2 + g21 u1 + g22 u2,   x3 = m3 + g31 u1 + g32 u2 + g33 u3
// and integrals nest: faces across axis 1 bound u1 alone, those across axis 2 bound u2 at a given u1, and along u3 the
// integral is a difference of normal distribution functions. The axes are permuted: axis 3, the one in closed form, is
// where the Gaussian is narrowest, axis 1 the longer one of the others.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "vog/dense.h"
#include "vog/gaussians.h"
#include "vog/linear.h"

namespace vog::voxelization {

/// Normal distribution function by cubic Hermite interpolation between 64 values a unit: error below 2e-10, and below
/// 1e-7 of the density in the tails.
class NormalTable {
  public:
    NormalTable();
    /// Phi(u) for u < 0, Phi(u) - 1 from 0 on: differences keep their digits in both tails.
    double tail(double u) const {
        const double t = u < 0 ? -u : u;
        const auto n = static_cast<std::size_t>(t * kPerUnit);
        if (n + 1 >= kSize) return 0;
        const double s = t * kPerUnit - static_cast<double>(n);
        const Node &a = node_[n], &b = node_[n + 1];
        const double rise = b.value - a.value;
        const double value = a.value + s * (a.slope + s * (3 * rise - 2 * a.slope - b.slope +
                                                           s * (a.slope + b.slope - 2 * rise)));
        return u < 0 ? value : -value;
    }

  private:
    static constexpr double kPerUnit = 64;
    static constexpr std::size_t kSize = 64 * 9 + 2;  // cutoffs reach 8
    struct Node {
        double value, slope;  ///< Phi(-t), its derivative by t times the step
    };
    std::array<Node, kSize> node_;
};

/// Truncated Gaussian in index space.
struct IndexGaussian {
    std::array<int, 3> axis{0, 1, 2};  ///< axes of the lattice in the order of integration
    std::array<double, 3> center{};    ///< m, in that order, voxels
    double g11 = 0, g21 = 0, g22 = 0, g31 = 0, g32 = 0, g33 = 0;  ///< G, voxels
    double cutoff = 0;                                            ///< k
    double weight = 0;  ///< density s1 s2 s3: mass = weight * integral over u
    IndexBox box{};     ///< voxels that the support's box meets
    /// Plane of a field: value at the mean, and its change along u1, u2, u3.
    struct Plane {
        double value = 0;
        std::array<double, 3> slope{};
    };
};
/// Gaussian i of a model on a lattice.
/// returns  an empty box (lower > upper) for a Gaussian without mass
/// throws   vog::Error for voxels beyond index 2^30
IndexGaussian index_gaussian(const Gaussians& model, std::size_t i, const Affine& index_from_world);
/// Planes of the model's fields, every component one, scalar fields first; fields that are the measure left out.
void field_planes(const Gaussians& model, std::size_t i, const Affine& world_from_index,
                  const IndexGaussian& gaussian, std::vector<IndexGaussian::Plane>& planes);

/// Sums over voxels of a box: mass, and mass times each field.
class CellSums {
  public:
    /// size      voxels along the axes of the lattice
    /// channels  1 and one for each component of a field
    CellSums(Vec3i size, std::size_t channels);
    /// Sets all sums to 0, and the box's place.
    void clear(Vec3i lower);
    /// Adds the integrals of a Gaussian over the voxels of `box`, a part of these.
    /// planes  [channels - 1]
    void add(const IndexGaussian& gaussian, std::span<const IndexGaussian::Plane> planes,
             const IndexBox& box, const NormalTable& normal);
    /// [channels][voxels] x slowest, z fastest
    std::span<const double> channel(std::size_t n) const {
        return {sums_.data() + n * voxels_, voxels_};
    }

  private:
    struct Frame;
    void add_slice(const Frame& frame, double u1, double weight);
    void add_line(const Frame& frame, double u1, double u2, double weight, std::ptrdiff_t at);

    Vec3i size_, lower_;
    std::size_t voxels_, channels_;
    std::vector<double> sums_;
    std::vector<double> faces_, kinks_, outer_, inner_;  // ends of pieces of u1 and of u2
};

}  // namespace vog::voxelization
