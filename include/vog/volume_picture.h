// vog/volume_picture.h: volume rendering by value: emission and absorption under a transfer function of a field's
// values (docs/volume_rendering.md).
//   dL/dt = s (c - L),   s = extinction at the field's value there, c = its colour
// Extinction per length is that of the value where the field is the measure itself, else that times the measure:
// other fields are weighed by density.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/image.h"
#include "vog/reference.h"
#include "vog/value_transfer.h"
#include "vog/voxel_field.h"

namespace vog {

/// Light and clipping of a volume picture.
struct VolumeLook {
    /// Shading of Blinn and Phong by the field's gradient; colour = (ambient + diffuse n.l) colour + specular
    /// (n.h)^power, at most 1, with the normal n towards the eye. Where the field has no gradient: the colour itself.
    /// Off: emission and absorption alone.
    bool light = false;
    Vec3d towards_light{};  ///< world, any length > 0; 0 0 0: the eye
    double ambient = 0.3, diffuse = 0.7, specular = 0.2, power = 20;  ///< weights >= 0; power > 0
    Clipping clip{};  ///< space that is shown; exact on every ray
};
/// throws  vog::Error for an invalid clip, weights that are negative or not finite, a power that is not > 0
void validate(const VolumeLook& look);

/// Premultiplied colour of a pixel, no background: [0, 1].
struct VolumeImage {
    int width = 0, height = 0;  ///< pixels
    std::vector<Rgba>
        pixel;  ///< [height * width] colour times alpha, and alpha = 1 - transmittance
};
/// The picture over a background, colours as displayed. A transparent background (a = 0) keeps alpha: as in every
/// Image the colour is then not multiplied by it (write_exr multiplies, as that format has it).
/// throws  vog::Error for a background with a component off [0, 1]
Image over(const VolumeImage& picture, const Rgba& background);

/// The voxels' own picture: constant in each voxel, exponentials per cell.
/// volumes  the measures; one, or the parts of a mesh, which do not overlap
/// fields   [volumes] a scalar field at the voxels of each; a component with neither leaves nor tiles is the
///          volume's own values, whose extinction is not weighed by density
/// Where several volumes overlap, their extinctions add up. options.clip and look.clip both cut.
/// returns  within 1e-6 of the exact picture; the same bytes for any number of threads
/// throws   vog::Error as render_field_reference, validate(look) and validate(transfer) do
/// cost     O(pixels * samples^2 * voxels on a ray), about 10 ns for each that absorbs
[[nodiscard]] VolumeImage render_volume_reference(std::span<const Volume> volumes,
                                                  std::span<const VoxelField> fields,
                                                  const ValueTransfer& transfer,
                                                  const Camera& camera, int width, int height,
                                                  const ReferenceOptions& options = {},
                                                  const VolumeLook& look = {});

}  // namespace vog
