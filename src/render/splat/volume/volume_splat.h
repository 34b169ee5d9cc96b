// volume_splat.h: Volumes and maxima of a model by depth slabs on the CPU.
#pragma once

#include <memory>
#include <string>

#include "render/by_value/volume_image.h"
#include "render/light/illumination.h"
#include "render/splat/volume/slab_splats.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/quantity.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog {

struct Collective;
namespace splat {
struct SlabPart;
}

/// Options of a SlabRenderer.
struct SlabOptions {
    int slabs = kVolumeSlabs;   ///< depth slabs of a picture, 1 to 1024
    std::string simd_target{};  ///< one of splat_targets(); empty: the best
    double kappa = 0;           ///< as SplatOptions::kappa
    VolumeLook look{};
    /// Error of a pixel of a volume, in colour and opacity from 0 to 1, up to which it is interpolated between pixels at half
    /// the resolution; estimated from its neighbours. 0: every pixel is drawn.
    double precision = 0;
    /// Processes that each hold a part of the model and make the same calls (vog-mpi); pictures are complete on the
    /// root. Null: this process has all of it.
    const Collective* collective = nullptr;
};

/// Renderer of one model by value, from any number of cameras and under any transfer function, without sorting:
/// `slabs` slabs of equal depth over the picture's range; in each, sums over Gaussians of the exact part of the integral
/// of each times moments of its values, which the transfer function then classifies; slabs are composited front to back.
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

    /// Transfer function of the next pictures. The same one again costs nothing, another a few milliseconds.
    void set_transfer(const ValueTransfer& transfer);
    /// Another direction or other weights of the light.
    /// throws  vog::Error as validate(look) does, and for another clip, or a light where there was none
    void set_light(const VolumeLook& look);
    /// picture  receives the result, the same bytes for any number of threads; its memory is reused
    /// throws   vog::Error for an unusable camera or size, or more than 65536 pixels a side
    /// cost     memory: 200 bytes a visible Gaussian and resolution, one to three; 4 kB a slab and thread. The second picture of a view under another
    ///          transfer function or light keeps its sums, 1 GB at most; further ones of the view draw no Gaussians.
    void render(const Camera& camera, int width, int height, VolumeImage& picture);
    [[nodiscard]] VolumeImage render(const Camera& camera, int width, int height);

    // A layer of a picture (render/layers): begin(), set_depths(), then tiles, each with its cells, in any thread.

    /// Projects the model. Its light is what `reached` has, which must outlive the picture.
    /// depths   receives those of the model, too, from the eye
    /// returns  whether any Gaussian is in the picture
    bool begin(const Camera& camera, int width, int height, const lights::Illumination& reached,
               splat::DepthRange& depths);
    /// depths  from the eye, of as many slabs as the renderer has
    void set_depths(const splat::SlabDepths& depths);
    /// returns  whether any Gaussian is in the tile
    bool begin_tile(int t);
    /// Sums of a cell of the thread's tile; the caller clears them.
    /// returns  no cell where nothing is
    splat::LayerCell sum_cell(int t, int n);
    /// In place of tiles, of a model in parts: what draw_parts takes, and the thread's cell with the sums of all parts.
    splat::SlabPart part();
    splat::LayerCell received();
    /// Adds the model's extinction under its transfer function.
    void add_extinction(lights::ExtinctionLattice& lattice) const;
    const splat::SlabKernels& kernels() const;

    /// Pictures whose Gaussians were drawn; the others came from kept sums.
    int drawn() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};
/// One picture by a SlabRenderer. throws vog::Error as SlabRenderer does
[[nodiscard]] VolumeImage render_volume_splat(const Gaussians& gaussians, const std::string& field,
                                              const ValueTransfer& transfer, const Camera& camera,
                                              int width, int height,
                                              const SlabOptions& options = {});

/// Largest conditional mean of a model's field along the ray through each pixel,
///   max over t of  sum d_i phi_i / sum d_i,   d_i density of Gaussian i at t, phi_i the plane of its field there
/// as means over depth slabs. Within the field's range.
/// options  its light has no effect
/// returns  NaN where there is no Gaussian; the same bytes for any number of threads
/// throws   vog::Error as SlabRenderer does
[[nodiscard]] ValueMap render_maximum_splat(const Gaussians& gaussians, const std::string& field,
                                            const Camera& camera, int width, int height,
                                            const SlabOptions& options = {.slabs = kMaximumSlabs});

}  // namespace vog
