// field_entries.h: components of fields as conversions sum them, and the arrays of a model that they end in.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "convert/fields/joint_sums.h"
#include "vog/gaussians.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// Components of all fields, one after another, and how their numbers are scaled.
struct Layout {
    struct Part {
        std::size_t field, component;
        float reference, unit;
    };
    std::vector<Part> parts;
    std::vector<std::size_t> first_part;  ///< [fields]
    std::vector<std::size_t> first_sum;   ///< [fields] of the residuals
    std::size_t residual_sums = 0;

    /// fields  [fields][levels]
    explicit Layout(std::span<const std::vector<VoxelField>> fields);
    /// The components at the voxels of one level.
    std::vector<Component> components(const Volume& volume,
                                      std::span<const std::vector<VoxelField>> fields,
                                      std::size_t level) const;
};

/// Plane of a component about a Gaussian's mean, in the component's unit; gradient per world unit.
struct WorldPlane {
    double value = 0;
    Vec3d gradient;
};

/// C^-1 c by least squares; 0 where the positions have no extent.
/// covariance  C of positions: xx xy xz yy yz zz
/// with        c of positions and values
Vec3d least_squares(std::array<double, 6> covariance, Vec3d with);

/// Fields of a model in progress.
class FieldEntries {
  public:
    /// fields, layout  must outlive the object
    FieldEntries(std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                 std::size_t gaussians);
    /// Sets all fields of Gaussian i.
    /// planes     [components]
    /// residuals  [Layout::residual_sums]
    /// mass       of both sums; 0: no residual
    void set(std::size_t i, const WorldPlane* planes, const double* residuals, double mass);
    /// Appends them to a model's.
    /// Planes leave no field's range (limit_planes).
    void move_to(Gaussians& model) &&;

  private:
    std::span<const std::vector<VoxelField>> fields_;
    const Layout& layout_;
    std::vector<ScalarField> scalar_;  ///< [fields] empty for vectors
    std::vector<VectorField> vector_;  ///< [fields] empty for scalars
};

}  // namespace vog::joint
