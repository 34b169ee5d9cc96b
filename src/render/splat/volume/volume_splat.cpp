// volume_splat.cpp: Volume rendering of a model by splatting to depth slabs: no sorting, sums alone.
#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "render/by_value/volume_field.h"
#include "render/pixel_limits.h"
#include "render/splat/projected_splats.h"
#include "render/splat/volume/slab_splats.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog {

using namespace by_value;
using namespace splat;

namespace {

/// Splats of a run of Gaussians: as many as fit the bins.
struct SlabBatch {
    ProjectedSplats splats;
    std::vector<SlabSplat> lights;
};

/// One picture in progress.
struct SlabPicture {
    const SlabView& view;
    const SplatKernels& kernels;
    const SlabPolynomials& polynomials;
    const std::deque<SlabBatch>& batches;

    void project(const SplatModel& model, SlabBatch& batch, std::size_t first,
                 std::size_t last) const;
    DepthRange depths(int t) const;
    void draw_tile(int t, SlabBand& band, Rgba* image) const;
};

void SlabPicture::project(const SplatModel& model, SlabBatch& batch, std::size_t first,
                          std::size_t last) const {
    batch.splats.keep_origin = true;
    batch.lights.resize(std::max(batch.lights.size(), last - first));
    batch.splats.project(kernels, model, view.frame, first, last, [&](const SplatChunk& chunk) {
        for (std::size_t n = chunk.slot; n < chunk.slot + chunk.count; ++n)
            batch.lights[n] = slab_splat(view, batch.splats.origin[n], batch.splats.far[n]);
    });
}

/// Range of depths of a tile's splats; empty: near > far.
DepthRange SlabPicture::depths(int t) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    DepthRange range{kInfinity, -kInfinity};
    const auto include = [&](float near, float far) {
        range.near = std::min(range.near, near);
        range.far = std::max(range.far, far);
    };
    for (const SlabBatch& batch : batches) {
        batch.splats.visit(t, view.frame, [&](const std::uint32_t* index, std::size_t count) {
            for (std::size_t n = 0; n < count; ++n)
                include(batch.lights[index[n]].near, batch.lights[index[n]].far);
        });
        const int left = batch.splats.column_of(t), top = batch.splats.row_of(t);
        for (const NearSplat& splat : batch.splats.near) {
            const PixelBounds& b = splat.bounds;
            if (b.x0 >= left + kTileWidth || b.x1 < left || b.y0 >= top + kTileHeight || b.y1 < top)
                continue;
            const DepthRange depths = depths_of(view, splat.index);
            include(depths.near, depths.far);
        }
    }
    return range;
}

/// Draws the bands of tile t.
/// band  buffer, all sums 0 before and after
void SlabPicture::draw_tile(int t, SlabBand& band, Rgba* image) const {
    const DepthRange range = depths(t);
    if (!(range.near <= range.far)) return;  // all pixels stay transparent
    const SlabKernels& loops = slab_kernels(kernels);
    const ProjectedSplats& first = batches.front().splats;
    band.column = first.column_of(t);
    // A margin keeps rounded depths inside.
    const float margin = 1e-5f * (range.far - range.near) + std::numeric_limits<float>::min();
    band.first = range.near - margin;
    band.thickness = (range.far - range.near + 2 * margin) / static_cast<float>(band.slabs);
    const int bottom = std::min(first.row_of(t) + kTileHeight, view.frame.height);
    for (band.row = first.row_of(t); band.row < bottom; band.row += kBandRows) {
        set_clip(view, band);
        for (const SlabBatch& batch : batches) {
            batch.splats.visit(t, view.frame, [&](const std::uint32_t* index, std::size_t count) {
                (view.frame.orthographic ? loops.add_parallel : loops.add_pinhole)(
                    batch.splats.far.data(), batch.lights.data(), index, count, polynomials, band);
            });
            for (const NearSplat& splat : batch.splats.near) add_near_light(view, splat, band);
        }
        if (band.pixels.y0 <= band.pixels.y1) loops.composite(band, view.frame, image);
    }
}

}  // namespace

/// Model, light and buffers, kept from picture to picture.
struct SlabRenderer::State {
    const Gaussians* gaussians;
    const ScalarField* field;
    SplatModel model;
    KernelPolynomial kernel;
    const SplatKernels* kernels;
    SlabPolynomials polynomials;
    std::optional<ValueTransfer> transfer;  ///< of the light
    std::vector<LightQuadratic> light;
    VolumeLook look;
    std::deque<SlabBatch> batches;
    tbb::enumerable_thread_specific<SlabBand> bands;
};

SlabRenderer::SlabRenderer(const Gaussians& gaussians, const std::string& field,
                           const ValueTransfer& transfer, const SlabOptions& options)
    : state_(std::make_unique<State>()) {
    if (options.slabs < 1 || options.slabs > kMostSlabs)
        throw Error(
            fmt::format("splat: {} depth slabs, expected 1 to {}", options.slabs, kMostSlabs));
    vog::validate(gaussians);
    vog::validate(options.look);
    State& s = *state_;
    s.look = options.look;
    s.gaussians = &gaussians;
    s.field = &volume_field(gaussians, field);
    const double cutoff = cutoff_of_kappa(options.kappa, gaussians.cutoff);
    s.model = {&gaussians, unit_of(gaussians), static_cast<float>(cutoff), pixel_limits(cutoff),
               &s.kernel};
    s.kernel = fit_kernel(double{s.model.cutoff});
    s.polynomials = fit_slab_polynomials(double{s.model.cutoff});
    s.kernels =
        options.simd_target.empty() ? &best_splat_kernels() : &splat_kernels(options.simd_target);
    s.bands = tbb::enumerable_thread_specific<SlabBand>([slabs = options.slabs] {
        SlabBand band;
        band.resize(slabs);
        return band;
    });
    set_transfer(transfer);
}
SlabRenderer::~SlabRenderer() = default;
SlabRenderer::SlabRenderer(SlabRenderer&&) noexcept = default;
SlabRenderer& SlabRenderer::operator=(SlabRenderer&&) noexcept = default;

void SlabRenderer::set_transfer(const ValueTransfer& transfer) {
    State& s = *state_;
    if (s.transfer == transfer) return;
    s.light = fit_light(*s.gaussians, *s.field, transfer);
    s.transfer = transfer;
}

VolumeImage SlabRenderer::render(const Camera& camera, int width, int height) {
    State& s = *state_;
    const Gaussians& gaussians = *s.gaussians;
    const CameraFrame frame = relative_to(frame_of(camera, width, height), gaussians.origin);
    if (width > kMaxSide || height > kMaxSide)
        throw Error(fmt::format("image size {}x{}: expected at most {} pixels a side", width,
                                height, kMaxSide));
    VolumeImage picture{width, height, {}};
    picture.pixel.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                         Rgba{0, 0, 0, 0});
    const std::size_t size = gaussians.size();
    if (size == 0) return picture;
    const double depth = dot(vec_cast<double>(gaussians.mean[size / 2]) - frame.eye, frame.forward);
    const Lighting lighting(s.look);
    const Clipping clip = relative_to(s.look.clip, gaussians.origin);
    const SlabView view{gaussians,
                        *s.field,
                        s.light,
                        lighting,
                        frame,
                        clip,
                        double{s.model.cutoff},
                        s.model.unit,
                        s.model.limits.variance,
                        depth};
    const std::size_t most = TileBins::most_splats(width, height);
    s.batches.resize((size + most - 1) / most);
    SlabPicture drawn{view, *s.kernels, s.polynomials, s.batches};
    for (std::size_t n = 0; n < s.batches.size(); ++n)
        drawn.project(s.model, s.batches[n], n * most, std::min((n + 1) * most, size));
    struct Nothing {};
    draw_tiles<Nothing>(s.batches.front().splats.bins, [&](int t, Nothing) {
        drawn.draw_tile(t, s.bands.local(), picture.pixel.data());
    });
    return picture;
}

VolumeImage render_volume_splat(const Gaussians& gaussians, const std::string& field,
                                const ValueTransfer& transfer, const Camera& camera, int width,
                                int height, const SlabOptions& options) {
    return SlabRenderer(gaussians, field, transfer, options).render(camera, width, height);
}

}  // namespace vog
