// vog/volume_picture.h: volume rendering by value: emission and absorption under a transfer function of a field's
// values (docs/volume_rendering.md).
//   dL/dt = s (c - L),   s = extinction at the field's value there, c = its colour
// Extinction per length is that of the value where the field is the measure itself, else that times the measure:
// other fields are weighed by density.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/reference.h"
#include "vog/splat.h"
#include "vog/trace.h"
#include "vog/value_transfer.h"
#include "vog/voxel_field.h"

namespace vog {

struct Collective;

/// Light and clipping of a volume picture.
struct VolumeLook {
    /// Shading of Blinn and Phong by the field's gradient (in a Gaussian as far as its plane explains the values); colour = (ambient + diffuse n.l) colour + specular
    /// (n.h)^power, at most 1, with the normal n towards the eye. Where the field has no gradient: the colour itself.
    /// Off: emission and absorption alone.
    bool light = false;
    Vec3d towards_light{};  ///< world, any length > 0; 0 0 0: the eye
    double ambient = 0.3, diffuse = 0.7, specular = 0.2, power = 20;  ///< weights >= 0; power > 0
    Clipping clip{};  ///< space that is shown; exact on every ray
    friend bool operator==(const VolumeLook&, const VolumeLook&) = default;
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

/// Options of a SlabRenderer.
struct SlabOptions {
    int slabs = 32;             ///< depth slabs a tile, 1 to 1024
    std::string simd_target{};  ///< one of splat_targets(); empty: the best
    double kappa = 0;           ///< as SplatOptions::kappa
    VolumeLook look{};
    /// Processes that each hold a part of the model and make the same calls (vog-mpi); pictures are complete on the
    /// root. Null: this process has all of it.
    const Collective* collective = nullptr;
};

/// Renderer of one model by value, from any number of cameras and under any transfer function, without sorting: per
/// tile of the picture `slabs` slabs of equal depth over the tile's own range; in each, sums over Gaussians of the
/// exact part of the integral of each times its expected extinction and colour; slabs are composited front to back.
/// Buffers are kept. Not for two threads at once; each picture uses all threads.
class SlabRenderer {
  public:
    /// gaussians  must outlive the renderer, unchanged; validated once, here
    /// field      a scalar field of the model
    /// throws     vog::Error as SplatRenderer and validate(transfer) do, for a field that the model lacks, for
    ///            slabs out of range
    SlabRenderer(const Gaussians& gaussians, const std::string& field,
                 const ValueTransfer& transfer, const SlabOptions& options = {});
    ~SlabRenderer();
    SlabRenderer(SlabRenderer&&) noexcept;
    SlabRenderer& operator=(SlabRenderer&&) noexcept;

    /// Transfer function of the next pictures. The same one again costs nothing, another about 1 us a Gaussian.
    void set_transfer(const ValueTransfer& transfer);
    /// picture  receives the result, the same bytes for any number of threads; its memory is reused
    /// throws   vog::Error for an unusable camera or size, or more than 65536 pixels a side
    /// cost     memory: 200 bytes a visible Gaussian, 4 kB a slab and thread
    void render(const Camera& camera, int width, int height, VolumeImage& picture);
    [[nodiscard]] VolumeImage render(const Camera& camera, int width, int height);

  private:
    struct State;
    std::unique_ptr<State> state_;
};
/// One picture by a SlabRenderer. throws vog::Error as SlabRenderer does
[[nodiscard]] VolumeImage render_volume_splat(const Gaussians& gaussians, const std::string& field,
                                              const ValueTransfer& transfer, const Camera& camera,
                                              int width, int height,
                                              const SlabOptions& options = {});
/// The same in exact order of depth, by one ray a pixel in steps of an eighth of the thinnest Gaussian: the truth
/// of the slabs.
/// throws  vog::Error as render_trace does, and for a field that the model lacks
[[nodiscard]] VolumeImage render_volume_trace(const Gaussians& gaussians, const std::string& field,
                                              const ValueTransfer& transfer, const Camera& camera,
                                              int width, int height,
                                              const TraceOptions& options = {},
                                              const TraceSceneOptions& scene = {},
                                              const VolumeLook& look = {});
/// Voxels of other processes (ReferenceOptions::collective), as far as one knows of them.
struct OtherVoxels {
    /// Whether volumes may overlap those of other processes: extinctions then add up, and all pieces of a ray are sent
    /// in place of runs of them.
    bool overlap = true;
    /// [volumes] voxels next to this process's, on the same lattice, for light by gradients; empty: none
    std::span<const Volume> beside{};
    std::span<const VoxelField> field{};  ///< [beside]
};
/// The voxels' own picture: constant in each voxel, exponentials per cell.
/// volumes  the measures; one, or the parts of a mesh, which do not overlap
/// fields   [volumes] a scalar field at the voxels of each; a component with neither leaves nor tiles is the
///          volume's own values, whose extinction is not weighed by density
/// Where several volumes overlap, their extinctions add up. options.clip and look.clip both cut.
/// voxels   Interpolation::linear: of one volume; values are interpolated, then classified (post-classification), at
///          the middles of steps of step_voxels > 0; light is by the gradient of the interpolated field
/// others   of several processes, which must have the same transfer function, and constant voxels
/// returns  constant voxels: within 1e-6 of the exact picture; the same bytes for any number of threads
/// throws   vog::Error as render_field_reference, validate(look) and validate(transfer) do
/// cost     O(pixels * samples^2 * voxels on a ray), about 10 ns for each that absorbs
[[nodiscard]] VolumeImage render_volume_reference(
    std::span<const Volume> volumes, std::span<const VoxelField> fields,
    const ValueTransfer& transfer, const Camera& camera, int width, int height,
    const ReferenceOptions& options = {}, const VolumeLook& look = {},
    const VoxelGridOptions& voxels = {}, const OtherVoxels& others = {});

}  // namespace vog
