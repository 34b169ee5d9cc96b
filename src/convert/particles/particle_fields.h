// particle_fields.h: fields of models of particles: the joint moments of each Gaussian's particles.
#pragma once

#include <span>
#include <vector>

#include "vog/convert_points.h"

namespace vog::particles {

/// Particles that each Gaussian of a model stands for.
struct Members {
    BigVector<std::uint32_t> particle;  ///< Gaussian by Gaussian
    BigVector<std::uint32_t> end;       ///< [Gaussians] index in `particle` behind its last
};

/// Values of one field, [components][particles].
struct ParticleValues {
    std::string name, unit;
    std::vector<BigVector<float>> component;  ///< 1: scalar, 3: vector
};
/// Finds the values of fields: `velocity`, a value of point_values, or three attributes NAME_x NAME_y NAME_z.
/// throws  vog::Error listing the names for an unknown one, and for a name used twice
std::vector<ParticleValues> particle_values(const Points& points,
                                            std::span<const PointField> fields);

/// Adds fields to a model. A particle's value is constant over its Gaussian, so that one particle's has neither
/// gradient nor residual; several particles' have the plane of least squares and what it leaves.
/// mass    [particles] weights; ranges are those of particles with mass
/// radius  [particles] standard deviations, world units
void add_particle_fields(Gaussians& model, const Points& points,
                         std::span<const ParticleValues> fields, const Members& members,
                         const BigVector<float>& mass, const BigVector<double>& radius);

}  // namespace vog::particles
