// splat.cpp: Splatting: projects every Gaussian, bins the splats to tiles, then adds their line
// integrals tile by tile, row by row. No sorting by depth: T is a sum.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/kernel_polynomial.h"
#include "render/splat/near/near_splats.h"
#include "render/splat/splat.h"
#include "render/splat/splat_boxes.h"
#include "render/splat/splat_kernels.h"
#include "vog/error.h"

namespace vog {

using namespace splat;
using clipping::GaussianClip;

namespace {

/// Buffers of a task.
struct SplatTile {
    TilePixels pixels;
    TileRays rays;
};

}  // namespace

/// Model, options and buffers, kept from picture to picture.
struct SplatRenderer::State {
    const Gaussians* all = nullptr;
    std::optional<ViewCut> cut;
    SplatModel model;  ///< Gaussians of the current picture: all, or a cut
    SplatOptions options;
    Clipping clip;                ///< of the next pictures
    std::optional<Box> supports;  ///< of all Gaussians that may be drawn; found for the first clip
    KernelPolynomial kernel;
    const SplatKernels* kernels = nullptr;
    ProjectedSplats splats;

    Clipping cutting();
    void draw_tile(int t, const SplatClip& kept, bool add, SplatTile& work,
                   DepthImage& image) const;
};

/// The clip without planes that cut nothing: a picture is then drawn as without them. Boxes may reach beyond supports.
Clipping SplatRenderer::State::cutting() {
    if (clip.empty() || options.aabb_sigma > 0) return clip;
    if (!supports) {
        supports = clipping::support_box(*all, double{model.cutoff});
        if (options.hierarchy)
            supports->include(
                clipping::support_box(options.hierarchy->nodes, double{model.cutoff}));
    }
    return clipping::cutting(clip, moved(*supports, all->origin));
}

/// Draws tile number t. A tile without splats is set to 0 unless `add`.
/// add   add to the image instead of replacing its pixels
/// work  buffer, all pixels 0 before and after
void SplatRenderer::State::draw_tile(int t, const SplatClip& kept, bool add, SplatTile& work,
                                     DepthImage& image) const {
    TilePixels& tile = work.pixels;
    const CameraFrame& frame = kept.frame;
    tile.column = splats.column_of(t);
    tile.row = splats.row_of(t);
    LazyRays rays(kept, tile.column, tile.row, work.rays);
    const bool touched = splats.visit(
        t, frame,
        [&](const std::uint32_t* index, std::size_t count) {
            kernels->add_far(splats.far.data(), index, count, kernel, tile);
        },
        [&](const NearSplat& splat) {
            kernels->add_near(splat, double{model.cutoff}, rays.of(splat), tile);
        });
    if (touched) {
        kernels->finish_tile(tile, frame, model.unit, add, image.depth.data());
    } else if (!add) {
        const int right = std::min(tile.column + kTileWidth, frame.width) - 1;
        const int bottom = std::min(tile.row + kTileHeight, frame.height) - 1;
        for (int y = tile.row; y <= bottom; ++y)
            std::fill(&image.at(tile.column, y), &image.at(right, y) + 1, 0.0f);
    }
}

SplatRenderer::SplatRenderer(const Gaussians& gaussians, const SplatOptions& options)
    : state_(std::make_unique<State>()) {
    if (!(options.aabb_sigma >= 0 && std::isfinite(options.aabb_sigma)))
        throw Error(fmt::format("splat: aabb_sigma {}, expected a finite number >= 0, 0: no boxes",
                                options.aabb_sigma));
    if (options.hierarchy && options.aabb_sigma > 0)
        throw Error(
            "splat: aabb_sigma and a hierarchy, expected one of them: bounding boxes are of the "
            "model's own Gaussians");
    validate(gaussians);
    const double cutoff = cutoff_of_kappa(options.kappa, gaussians.cutoff);
    state_->all = &gaussians;
    state_->model = {&gaussians, unit_of(gaussians), static_cast<float>(cutoff), {}, nullptr};
    // The paper's boxes are met by single rays, as in the paper.
    if (options.aabb_sigma == 0) state_->model.limits = pixel_limits(state_->model.cutoff);
    state_->options = options;
    state_->kernels =
        options.simd_target.empty() ? &best_splat_kernels() : &splat_kernels(options.simd_target);
    if (options.hierarchy) state_->cut.emplace(gaussians, *options.hierarchy, cutoff);
    state_->kernel = fit_kernel(state_->model.cutoff);
    state_->model.kernel = &state_->kernel;
}
SplatRenderer::~SplatRenderer() = default;
SplatRenderer::SplatRenderer(SplatRenderer&&) noexcept = default;
SplatRenderer& SplatRenderer::operator=(SplatRenderer&&) noexcept = default;

void SplatRenderer::render(const Camera& camera, int width, int height, DepthImage& image,
                           const Progress& progress) {
    State& s = *state_;
    const CameraFrame world_frame = frame_of(camera, width, height);
    const CameraFrame frame = relative_to(world_frame, s.all->origin);
    if (width > kMaxSide || height > kMaxSide)
        throw Error(fmt::format("image size {}x{}: expected at most {} pixels a side", width,
                                height, kMaxSide));
    image.width = width;
    image.height = height;
    image.extinction = 1;
    image.depth.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const Progress& report = progress ? progress : s.options.progress;
    if (s.cut) s.model.gaussians = &s.cut->choose(world_frame, s.options.cut);
    const GaussianClip clip(s.cutting(), *s.model.gaussians, double{s.model.cutoff});
    const SplatClip kept{clip, s.model, frame};
    if (s.options.aabb_sigma > 0)
        return render_boxes(*s.kernels, s.kernel, kept, s.options.aabb_sigma, report, image);
    s.splats.keep_origin = !kept.empty();
    // Batches bound the memory of the splats for models of any size.
    const std::size_t size = s.model.gaussians->size();
    const std::size_t batch = TileBins::most_splats(width, height);
    std::size_t first = 0;
    do {
        const std::size_t last = std::min(first + batch, size);
        s.splats.project(*s.kernels, s.model, frame, first, last, [&](SplatChunk& chunk) {
            if (!kept.empty()) kept.keep(s.splats, chunk);
        });
        draw_tiles<SplatTile>(s.splats.bins, [&](int t, SplatTile& work) {
            s.draw_tile(t, kept, first > 0, work, image);
        });
        if (report) report(size > 0 ? static_cast<double>(last) / static_cast<double>(size) : 1);
        first = last;
    } while (first < size);
}

DepthImage SplatRenderer::render(const Camera& camera, int width, int height) {
    DepthImage image;
    render(camera, width, height, image);
    return image;
}

void SplatRenderer::set_cut(const CutOptions& cut) { state_->options.cut = cut; }
void SplatRenderer::set_clip(const Clipping& clip) {
    validate(clip);
    state_->clip = clip;
}

CutReport SplatRenderer::cut_report() const {
    return state_->cut ? state_->cut->report() : CutReport{0, 0, state_->all->size()};
}

DepthImage render_splat(const Gaussians& gaussians, const Camera& camera, int width, int height,
                        const SplatOptions& options) {
    return SplatRenderer(gaussians, options).render(camera, width, height);
}

}  // namespace vog
