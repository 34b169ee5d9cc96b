// vog/convert_fields.h: fields for the Gaussians of any model, from the voxels or particles it was made of
// (docs/fields.md).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/voxel_field.h"

namespace vog {

/// Default of FieldOptions::joint_steps. More serve narrow bands of values and cost T
/// (docs/volume_rendering.md).
inline constexpr int kJointSteps = 2;

/// Models of dense images by default: their error by value (JointReport::value_error), to a tenth, and the fewest Gaussians, 3 MB of a
/// file, which have it for smooth scans of any size (docs/scans.md).
inline constexpr double kDefaultValueError = 0.1;
inline constexpr int kLeastOfImage = 30000;

/// Errors of a model before and after the steps of FieldOptions::joint_field.
struct JointReport {
    /// Relative L2 of the optical depth T in the worst of the error views (MomentReport::measured_error), before and after
    /// the steps.
    double error_before = -1, error_after = -1;
    /// Relative L2 of premultiplied colour and alpha against the voxels' volume pictures, under a ramp, three narrow
    /// bands and an opaque step together, in the worst of the error views; -1: not measured.
    double value_error = -1;
    std::size_t removed = 0;  ///< Gaussians left without any voxel
};

/// Options of add_fields.
struct FieldOptions {
    /// Cells of the model (MomentReport::cells): a voxel counts for the Gaussian of its cell, or for those
    /// of the windows it lies in. None, or of a volume whose tiles were divided since: a voxel's mass is
    /// divided among the Gaussians by their densities there.
    std::optional<UniformCells> cells{};
    /// Name of one of the fields, or `volume`, the volumes' own values: steps of expectation-maximisation in
    /// the joint space of position and its values move the Gaussians, for pictures of that field. A voxel then counts for the
    /// Gaussians that are near it and expect its value. Empty: the Gaussians stay where they are.
    std::string joint_field{};
    int joint_steps = kJointSteps;        ///< 1 to 1000; used with joint_field
    JointReport* joint_report = nullptr;  ///< receives the errors; null: they are not measured
    std::optional<Box> periodic{};        ///< MomentOptions::periodic
    Progress progress{};                  ///< called with the finished fraction; empty: not
};

/// FieldOptions::joint_field of a conversion.
/// joint_field  name of a field; "none"; empty: the default, `volume` for dense images (Volume::is_image), none for other volumes
std::string resolved_joint_field(const std::string& joint_field, std::span<const Volume> volumes);

/// A field before it is read.
struct FieldName {
    std::string name;
    bool own = false;  ///< the volumes' own values
};
/// Place among fields of the one that FieldOptions::joint_field names.
/// throws  vog::Error naming the fields there are
std::size_t find_joint_field(const std::string& joint_field, std::span<const FieldName> fields);
/// Names of sampled fields, [fields][levels].
std::vector<FieldName> field_names(std::span<const std::vector<VoxelField>> fields);

/// Fields that a cut shall follow, MomentOptions::carried_fields: without the volumes' own values, which are the density,
/// and those that are constant.
/// fields      [fields][levels], must outlive the result
/// collective  processes that hold other parts of the data, with as many fields; null: a single process
std::vector<CarriedField> carried_fields(std::span<const Volume> levels,
                                         std::span<const std::vector<VoxelField>> fields,
                                         const Collective* collective = nullptr);

/// Adds fields to a model, by the moments of position and value over each Gaussian's part of the voxels.
/// model   of these volumes, by any conversion; Gaussians without a part get the value of the nearest voxels'
///         Gaussian or the mean of the field, and no gradient
/// levels  the measures, as the conversion had them: one volume, or the parts of a mesh
/// fields  [fields][levels] each field at the voxels of each volume; a component with neither leaves nor
///         tiles is the volume's own values
/// throws  vog::Error for a name that the model has already or that is reserved, and for a joint_field that is
///         not among the fields
/// cost    about two steps of expectation-maximisation, for each of joint_steps as much again; of cells a part
///         of their conversion's
void add_fields(Gaussians& model, std::span<const Volume> levels,
                std::span<const std::vector<VoxelField>> fields, const FieldOptions& options = {});

/// Converts voxels to a model with fields: convert_moments, whose adaptive cuts follow the fields (carried_fields), then
/// add_fields. With a joint_field for volume pictures of that field: errors of these
/// (JointReport::value_error) take the place of those of T: moments.error is met by the fewest Gaussians, to 5 %, or,
/// where no count meets it, the count of least error is taken; moments.refine_seconds splits Gaussians where pictures by
/// value err and merges as many elsewhere, as long as their error falls. The default without error, budget and block is
/// that of convert_moments, by T; for the own values of a dense image (Volume::is_image) an error by value of about
/// kDefaultValueError, by at least kLeastOfImage Gaussians, and at most default_count.
/// fields   as for add_fields, at the voxels of the volume or of the parts of the mesh
/// options  joint_field with an error or refinement: a scalar field that is not constant
/// throws   vog::Error as convert_moments and add_fields do, and for those fields
/// cost     with joint_field and an error or refinement 36 volume pictures of the voxels; a search for an error some
///          ten conversions
[[nodiscard]] Gaussians convert_for_field(const Volume& volume,
                                          std::span<const std::vector<VoxelField>> fields,
                                          const MomentOptions& moments, const FieldOptions& options,
                                          MomentReport* report = nullptr);
[[nodiscard]] Gaussians convert_for_field(const Composite& mesh,
                                          std::span<const std::vector<VoxelField>> fields,
                                          const MomentOptions& moments, const FieldOptions& options,
                                          MomentReport* report = nullptr);
/// Converts a volume by its defaults: convert_moments, or with moments.own_field convert_for_field of its resolved_joint_field.
[[nodiscard]] Gaussians convert_by_default(const Volume& volume, MomentOptions moments);

}  // namespace vog
