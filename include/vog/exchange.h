// vog/exchange.h: models as splats, for renderers of 3D Gaussian splatting and of volumetric primitives.
// Such renderers blend splats of one opacity each, in depth order: the T of a Gaussian, which depends on the direction,
// is matched in the mean over directions. docs/exchange.md has what each format loses.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/gaussians.h"

namespace vog {

/// N splats: alpha = opacity exp(-1/2 |W d|^2) around the mean, blended front to back.
struct Splats {
    std::vector<Vec3f> mean;     ///< [N]
    std::vector<Vec3f> scale;    ///< [N] standard deviations along the own axes
    std::vector<Quat> rotation;  ///< [N]
    std::vector<float> opacity;  ///< [N] (0, 1)
    std::vector<Vec3f> color;    ///< [N] red, green, blue as displayed, [0, 1]
    std::string source;          ///< name of the source data
    double world_scale = 1;      ///< world units in one unit of the splats, > 0
    Vec3d world_center;          ///< point of the world at the splats' 0, world units
    std::size_t size() const { return mean.size(); }
};

/// Options of splats_of.
struct SplatsOptions {
    double extinction = 1;  ///< factor on density, > 0
    /// Move and scale the box of the model to the centre 0 and a longest edge of 2, a size that viewers open in view.
    bool unit_box = true;
};

/// Splats of a model. The optical depth -ln(1 - alpha), integrated over the screen, is that of the Gaussian, in the mean over
/// directions: Li2(opacity) = extinction mass / (2 pi A), A the mean over directions of the product of the standard deviations on
/// the screen. A Gaussian of more than Li2(1) = 1.64 is opaque.
/// color   [N] red, green, blue, [0, 1]; empty: white, as fog
/// throws  vog::Error for an invalid model, an extinction out of range, and colours of another number or beyond [0, 1]
[[nodiscard]] Splats splats_of(const Gaussians& model, std::span<const Vec3f> color,
                               const SplatsOptions& options = {});

/// Difference of splats from the model that they are of, in V = 1 - exp(-T), which no order of blending changes.
struct SplatsError {
    double mean_db = 0, worst_db = 0;  ///< PSNR of V over the views, dB
    double depth = 1;  ///< optical depth of the splats over the model's, mean over all pixels
    double opaque =
        0;  ///< share of splats that are opaque: the Gaussian is denser than a splat can be
};
/// Compares parallel views `paper`, +x, -x, +y, -y, +z and -z of 256 x 256 pixels. Renderers in perspective add their own error.
/// splats  of this model and extinction, not in a unit box
/// throws  vog::Error for other numbers of splats and Gaussians
[[nodiscard]] SplatsError splats_error(const Gaussians& model, const Splats& splats,
                                       double extinction);

/// Writes splats, beside the file, renamed when whole: by the extension .ply (3DGS: logarithms of scales, logits of opacities,
/// f_dc), .spz (version 3, 24-bit positions, 8-bit scales and opacities), .glb (glTF with KHR_gaussian_splatting), .usda
/// (OpenUSD's ParticleField3DGaussianSplat, as text). Splats are turned so that they stand upright: y is up in
/// .spz, .glb and .usda, -y in .ply. The file states the turn, world_scale and world_center, and read_model undoes them.
/// up      direction that is upright in the data, not 0
/// throws  vog::Error for another extension, no splats, positions beyond what .spz holds, or if the file cannot be written
void write_splats(const std::filesystem::path& file, const Splats& splats, Vec3d up = {0, 1, 0});

/// Writes a model as volprim's PLY: volumetric Gaussians of unit mass times sigmat, cut at 3 standard deviations there. Mass is
/// kept: where the model cuts elsewhere, kernels change.
/// extinction  factor on density, > 0
/// throws      vog::Error for an invalid model, or if the file cannot be written
void write_volprim(const std::filesystem::path& file, const Gaussians& model, double extinction);

}  // namespace vog
