// volume_splat.cpp: Volume rendering of a model by splatting to depth slabs: no sorting, sums alone.
#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "render/by_value/clipped_depth.h"
#include "render/by_value/volume_field.h"
#include "render/pixel_limits.h"
#include "render/splat/projected_splats.h"
#include "render/splat/volume/slab_maximum.h"
#include "render/splat/volume/slab_splats.h"
#include "vog/error.h"
#include "vog/maximum_picture.h"
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
    void (*composite)(SlabBand& band, const CameraFrame& frame, Rgba* image);

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
    const ProjectedSplats& first = batches.front().splats;
    const int bottom = std::min(first.row_of(t) + kTileHeight, view.frame.height);
    band.column = first.column_of(t);
    for (int y = first.row_of(t); y < bottom; ++y)
        std::fill_n(image + static_cast<std::ptrdiff_t>(y) * view.frame.width + band.column,
                    std::min(kTileWidth, view.frame.width - band.column), Rgba{0, 0, 0, 0});
    const DepthRange range = depths(t);
    if (!(range.near <= range.far)) return;
    const SlabKernels& loops = slab_kernels(kernels);
    // A margin keeps rounded depths inside.
    const float margin = 1e-5f * (range.far - range.near) + std::numeric_limits<float>::min();
    band.first = range.near - margin;
    band.thickness = (range.far - range.near + 2 * margin) / static_cast<float>(band.slabs);
    for (band.row = first.row_of(t); band.row < bottom; band.row += kBandRows) {
        set_clip(view, band);
        for (const SlabBatch& batch : batches) {
            batch.splats.visit(t, view.frame, [&](const std::uint32_t* index, std::size_t count) {
                (view.frame.orthographic ? loops.add_parallel : loops.add_pinhole)(
                    batch.splats.far.data(), batch.lights.data(), index, count, polynomials, band);
            });
            for (const NearSplat& splat : batch.splats.near) add_near_light(view, splat, band);
        }
        if (band.pixels.y0 <= band.pixels.y1) composite(band, view.frame, image);
    }
}

/// Model and buffers, kept from picture to picture.
struct SlabModel {
    const Gaussians* gaussians;
    const ScalarField* field;
    SplatModel model;
    KernelPolynomial kernel;
    const SplatKernels* kernels;
    SlabPolynomials polynomials;
    VolumeLook look;
    std::deque<SlabBatch> batches;
    tbb::enumerable_thread_specific<SlabBand> bands;

    SlabModel(const Gaussians& of, const ScalarField& of_model, const SlabOptions& options);
    SlabModel(const SlabModel&) = delete;
    SlabModel& operator=(const SlabModel&) = delete;

    enum class Sums { light, maximum, depth };
    /// light  [gaussians], in place of which value_planes makes a maximum
    void draw(const std::vector<LightQuadratic>& light, Sums sums, const Camera& camera, int width,
              int height, VolumeImage& picture);
};

SlabModel::SlabModel(const Gaussians& of, const ScalarField& of_model, const SlabOptions& options)
    : gaussians(&of), field(&of_model), look(options.look) {
    if (options.slabs < 1 || options.slabs > kMostSlabs)
        throw Error(
            fmt::format("splat: {} depth slabs, expected 1 to {}", options.slabs, kMostSlabs));
    vog::validate(of);
    vog::validate(options.look);
    const double cutoff = cutoff_of_kappa(options.kappa, of.cutoff);
    model = {&of, unit_of(of), static_cast<float>(cutoff), pixel_limits(cutoff), &kernel};
    kernel = fit_kernel(double{model.cutoff});
    polynomials = fit_slab_polynomials(double{model.cutoff});
    kernels =
        options.simd_target.empty() ? &best_splat_kernels() : &splat_kernels(options.simd_target);
    bands = tbb::enumerable_thread_specific<SlabBand>([slabs = options.slabs, scalar = field] {
        SlabBand band;
        band.most_share = static_cast<float>(most_share_per_density(*scalar));
        band.resize(slabs);
        return band;
    });
}

void SlabModel::draw(const std::vector<LightQuadratic>& light, Sums sums, const Camera& camera,
                     int width, int height, VolumeImage& picture) {
    const CameraFrame frame = relative_to(frame_of(camera, width, height), gaussians->origin);
    if (width > kMaxSide || height > kMaxSide)
        throw Error(fmt::format("image size {}x{}: expected at most {} pixels a side", width,
                                height, kMaxSide));
    picture.width = width, picture.height = height;
    picture.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const std::size_t size = gaussians->size();
    if (size == 0) {
        std::ranges::fill(picture.pixel, Rgba{0, 0, 0, 0});
        return;
    }
    const double depth =
        dot(vec_cast<double>(gaussians->mean[size / 2]) - frame.eye, frame.forward);
    const Lighting lighting(look);
    const Clipping clip = relative_to(look.clip, gaussians->origin);
    const SlabView view{*gaussians,
                        *field,
                        light,
                        lighting,
                        frame,
                        clip,
                        double{model.cutoff},
                        model.unit,
                        model.limits.variance,
                        depth};
    const std::size_t most = TileBins::most_splats(width, height);
    batches.resize((size + most - 1) / most);
    const auto composite = sums == Sums::maximum ? maximum_band
                           : sums == Sums::depth ? depth_band
                                                 : slab_kernels(*kernels).composite;
    SlabPicture drawn{view, *kernels, polynomials, batches, composite};
    for (std::size_t n = 0; n < batches.size(); ++n)
        drawn.project(model, batches[n], n * most, std::min((n + 1) * most, size));
    struct Nothing {};
    draw_tiles<Nothing>(batches.front().splats.bins, [&](int t, Nothing) {
        drawn.draw_tile(t, bands.local(), picture.pixel.data());
    });
}

}  // namespace

/// A model and its light.
struct SlabRenderer::State {
    SlabModel slabs;
    std::optional<ValueTransfer> transfer{};  ///< of the light
    std::vector<LightQuadratic> light{};
};

SlabRenderer::SlabRenderer(const Gaussians& gaussians, const std::string& field,
                           const ValueTransfer& transfer, const SlabOptions& options)
    : state_(new State{SlabModel(gaussians, volume_field(gaussians, field), options)}) {
    set_transfer(transfer);
}
SlabRenderer::~SlabRenderer() = default;
SlabRenderer::SlabRenderer(SlabRenderer&&) noexcept = default;
SlabRenderer& SlabRenderer::operator=(SlabRenderer&&) noexcept = default;

void SlabRenderer::set_transfer(const ValueTransfer& transfer) {
    State& s = *state_;
    if (s.transfer == transfer) return;
    s.light = fit_light(*s.slabs.gaussians, *s.slabs.field, transfer);
    s.transfer = transfer;
}

void SlabRenderer::render(const Camera& camera, int width, int height, VolumeImage& picture) {
    state_->slabs.draw(state_->light, SlabModel::Sums::light, camera, width, height, picture);
}
VolumeImage SlabRenderer::render(const Camera& camera, int width, int height) {
    VolumeImage picture;
    render(camera, width, height, picture);
    return picture;
}

VolumeImage render_volume_splat(const Gaussians& gaussians, const std::string& field,
                                const ValueTransfer& transfer, const Camera& camera, int width,
                                int height, const SlabOptions& options) {
    return SlabRenderer(gaussians, field, transfer, options).render(camera, width, height);
}

ValueMap render_maximum_splat(const Gaussians& gaussians, const std::string& field,
                              const Camera& camera, int width, int height,
                              const SlabOptions& options) {
    SlabOptions unlit = options;
    unlit.look.light = false;
    SlabModel slabs(gaussians, volume_field(gaussians, field), unlit);
    VolumeImage shares;
    slabs.draw(value_planes(gaussians, *slabs.field), SlabModel::Sums::maximum, camera, width,
               height, shares);
    ValueMap map{width, height, std::vector<float>(shares.pixel.size())};
    std::ranges::transform(shares.pixel, map.value.begin(), [&](const Rgba& pixel) {
        return pixel.a > 0 ? value_of_share(*slabs.field, double{pixel.r})
                           : std::numeric_limits<float>::quiet_NaN();
    });
    return map;
}

DepthImage by_value::clipped_depth_splat(const Gaussians& gaussians, const Clipping& clip,
                                         double kappa, const Camera& camera, int width,
                                         int height) {
    SlabOptions options{.slabs = 1, .kappa = kappa};
    options.look.clip = clip;
    const ScalarField still = still_field(gaussians);
    SlabModel slabs(gaussians, still, options);
    LightQuadratic one;
    one.c[3][0] = 1;
    const std::vector<LightQuadratic> light(gaussians.size(), one);
    VolumeImage sums;
    slabs.draw(light, SlabModel::Sums::depth, camera, width, height, sums);
    DepthImage depth(width, height);
    std::ranges::transform(sums.pixel, depth.depth.begin(), &Rgba::r);
    return depth;
}

}  // namespace vog
