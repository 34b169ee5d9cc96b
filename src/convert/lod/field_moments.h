// field_moments.h: joint moments of position and field values, and their exact sums over parts (docs/fields.md).
// A field of one component is a scalar field, of three a vector field.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "convert/moments/gaussian_moments.h"
#include "vog/fields.h"

namespace vog::lod {

using namespace moments;

/// A field over a distribution of mass.
template <std::size_t components>
struct FieldMoments {
    static constexpr std::size_t kPairs = components * (components + 1) / 2;
    std::array<double, components> value{};    ///< mean, weighted by mass
    std::array<Vec3d, components> cross{};     ///< covariance of each component and position
    std::array<double, kPairs> covariance{};   ///< of the components, xx xy xz yy yz zz; scalar: xx
    std::array<Vec3d, components> gradient{};  ///< of the plane around the mean
    std::array<double, kPairs> residual{};     ///< covariance that the plane leaves
    double third = 0;                          ///< third moment of a scalar's residual
};
using ScalarMoments = FieldMoments<1>;
using VectorMoments = FieldMoments<3>;

/// Moments of Gaussian i's field.
/// kernel  covariance of Gaussian i after truncation, xx xy xz yy yz zz
ScalarMoments field_moments(const ScalarField& field, std::size_t i,
                            const std::array<double, 6>& kernel);
VectorMoments field_moments(const VectorField& field, std::size_t i,
                            const std::array<double, 6>& kernel);

/// A sum of distributions of mass, and what the sums over their fields share.
struct Merger {
    Moments sum;
    std::span<const Moments> parts;
    Mat3 precision;  ///< inverse of the sum's covariance; along directions without extent 0

    /// sum  of the parts; if none has mass, they count alike
    Merger(const Moments& sum_of_parts, std::span<const Moments> of);
    /// Part k's share of the mass.
    double share(std::size_t k) const {
        return sum.mass > 0 ? parts[k].mass / sum.mass : 1.0 / static_cast<double>(parts.size());
    }
};

/// Moments of the merger from those of its parts, all but `third` exact: that takes each part's position to be
/// normal, and its residual to be independent of it.
template <std::size_t components>
FieldMoments<components> merged(const Merger& merger,
                                std::span<const FieldMoments<components>> parts);

/// Sets the plane and the residual that covariances of value and position give.
/// precision  inverse of the covariance of position
template <std::size_t components>
void set_plane(FieldMoments<components>& moments, const Mat3& precision);

/// Sets the field of Gaussian i.
void set_field(ScalarField& field, std::size_t i, const ScalarMoments& moments);
void set_field(VectorField& field, std::size_t i, const VectorMoments& moments);

}  // namespace vog::lod
