// vog/field_maps.h: pictures of fields: column of the measure, and weighted mean and dispersion of a field along
// rays (docs/fields.md).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/quantity.h"
#include "vog/reference.h"
#include "vog/splat.h"
#include "vog/trace.h"
#include "vog/voxel_field.h"

namespace vog {

/// Number shown of a field.
enum class FieldPart {
    value,  ///< a scalar field itself
    view,   ///< component of a vector field along the ray, away from the eye positive
    x,
    y,
    z,          ///< component of a vector field along a world axis
    magnitude,  ///< root mean square of a vector field (FieldMaps)
};

/// A field and the part of it that is shown.
struct FieldChoice {
    std::string field;
    FieldPart part = FieldPart::value;
};

/// Reads "temperature", "velocity" (the component along the view), "velocity.x" or "velocity.magnitude".
/// throws  vog::Error listing the fields of the model, for one it lacks and a part that the field has not
FieldChoice field_choice(const std::string& text, const Fields& fields);
/// Name of the shown number: "temperature", "velocity along the view", "velocity.x", "rms of velocity".
std::string field_label(const FieldChoice& choice);

/// Sums along the ray through each pixel; rows from the top. The mean magnitude of a vector is not a sum of
/// moments; FieldPart::magnitude has, of the vector u and its mean <u> along the ray,
///   mean = sqrt <|u|^2>, the root mean square        deviation = sqrt <|u - <u>|^2>, in three dimensions
struct FieldMaps {
    int width = 0, height = 0;  ///< pixels
    std::vector<float>
        column;  ///< [height * width] integral of the measure, density times world units, >= 0
    std::vector<float>
        mean;  ///< [height * width] of the field weighted by the measure; NaN without column
    std::vector<float>
        deviation;  ///< [height * width] standard deviation likewise, >= 0; NaN without column
};

/// Splats a field of a model: exact integrals of each Gaussian's plane and residual along every ray.
/// A Gaussian drawn wider than it is (docs/method.md, "Gaussians smaller than a pixel") has its mean value and
/// whole variance at each of its pixels.
/// With a hierarchy its cut is drawn: nodes have the joint moments of the Gaussians below.
/// report   receives the counts of the cut; null: not
/// clip     space that counts: chords are cut exactly; a Gaussian drawn wider than it is counts by the share of
///          the chord through its mean that stays
/// returns  the same bytes for any number of threads
/// throws   vog::Error as SplatRenderer does, for a field that the model lacks, and for options with boxes
[[nodiscard]] FieldMaps render_field_splat(const Gaussians& gaussians, const FieldChoice& choice,
                                           const Camera& camera, int width, int height,
                                           const SplatOptions& options = {},
                                           CutReport* report = nullptr, const Clipping& clip = {});
/// The same into the arrays of an earlier picture, which saves a third of the time of a fresh one's memory.
/// maps  of any size, or empty; FieldPart::magnitude makes new ones
void render_field_splat(const Gaussians& gaussians, const FieldChoice& choice, const Camera& camera,
                        int width, int height, const SplatOptions& options, FieldMaps& maps,
                        CutReport* report = nullptr, const Clipping& clip = {});
/// The same by one ray a pixel.
/// throws  vog::Error as trace_scene and render_trace do, for a field that the model lacks, and for AnyHit::collect
[[nodiscard]] FieldMaps render_field_trace(const Gaussians& gaussians, const FieldChoice& choice,
                                           const Camera& camera, int width, int height,
                                           const TraceOptions& options = {},
                                           const TraceSceneOptions& scene = {},
                                           const Clipping& clip = {});
/// The voxels' own maps. With Interpolation::constant each voxel is a box with its density and field, with
/// linear a tent over the eight voxels around (trilinear density; at a point the field has the values of those
/// voxels, by their weights times density).
/// Several volumes are added up; samples are those of ReferenceOptions.
/// volumes  the measures
/// fields   [volumes] the field at the voxels of each; a component with neither leaves nor tiles is the volume's
///          own values
/// part     FieldPart::value for scalar fields, another for vector fields
/// throws   vog::Error as voxel_grid and render_reference do, and for fields that are not the volumes'
[[nodiscard]] FieldMaps render_field_reference(std::span<const Volume> volumes,
                                               std::span<const VoxelField> fields, FieldPart part,
                                               const Camera& camera, int width, int height,
                                               const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});
/// The same of the levels of a mesh: at every point the finest counts alone (level_grids). Interpolated, and
/// where a voxel is hidden in part, moments of the field are stored in floats: deviations below 3e-4 of the
/// mean's distance from the field's least value are rounding.
/// fields  [levels.volumes]
[[nodiscard]] FieldMaps render_field_reference(const Levels& levels,
                                               std::span<const VoxelField> fields, FieldPart part,
                                               const Camera& camera, int width, int height,
                                               const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});
/// The same of parts of levels, which add up: of each level as read_level_parts in vog/distributed.h has it.
/// fields  [parts][levels of the part]
[[nodiscard]] FieldMaps render_field_reference(std::span<const Levels* const> parts,
                                               std::span<const std::span<const VoxelField>> fields,
                                               FieldPart part, const Camera& camera, int width,
                                               int height, const ReferenceOptions& options = {},
                                               const VoxelGridOptions& voxels = {});

/// Values that count for a color scale: where the column is at least a thousandth of the largest. Others are
/// the rims of supports, often of extreme values.
/// shown  [maps.column] the map that is shown
std::vector<float> values_for_scale(const FieldMaps& maps, std::span<const float> shown);
/// The shown map, NaN where the column is below a share of the largest.
ValueMap visible_values(const FieldMaps& maps, std::span<const float> shown, double least_share);

/// Contributions of Gaussian i to the sums along o + t r, t >= 0, in double precision by the closed form: the
/// measure, the measure times the field, and times its square. Every renderer is tested against this function.
/// FieldPart::magnitude has no first sum: 0.
/// clip  space that counts
struct FieldSums {
    double column = 0, first = 0, second = 0;
};
FieldSums field_sums(const Gaussians& gaussians, const FieldChoice& choice, std::size_t i,
                     Vec3d origin, Vec3d direction, const Clipping& clip = {});

}  // namespace vog
