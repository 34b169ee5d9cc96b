// splat.cpp: Splatting: projects every Gaussian, bins the splats to tiles, then adds their line
// integrals tile by tile, row by row. No sorting by depth: T is a sum.
#include <fmt/core.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/parallel.h"
#include "render/kernel_polynomial.h"
#include "render/splat/near_splats.h"
#include "render/splat/splat_boxes.h"
#include "render/splat/splat_kernels.h"
#include "render/splat/tile_bins.h"
#include "vog/error.h"
#include "vog/splat.h"

namespace vog {

using namespace splat;

namespace {

/// A run of Gaussians that one task projects, and its splats.
struct Chunk {
    std::size_t first = 0, last = 0;  ///< Gaussians
    std::size_t slot = 0, count = 0;  ///< its far splats: State::far[slot ... slot + count - 1]
    std::vector<NearSplat> near;
};

/// A power of two near the largest T of one Gaussian: peak times largest scale; at most that of two
/// floats.
double unit_of(const Gaussians& gaussians) {
    const double largest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, gaussians.size(), 1 << 16), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double most) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Vec3f s = gaussians.scale[i];
                most = std::max(most, double{gaussians.density[i]} * std::max({s.x, s.y, s.z}));
            }
            return most;
        },
        [](double a, double b) { return std::max(a, b); });
    return largest > 0 ? std::exp2(std::min(std::ilogb(largest), 252)) : 1;
}

}  // namespace

/// Model, options and buffers, kept from picture to picture.
struct SplatRenderer::State {
    const Gaussians* all = nullptr;
    std::optional<ViewCut> cut;
    SplatModel model;  ///< Gaussians of the current picture: all, or a cut
    SplatOptions options;
    KernelPolynomial kernel;
    const SplatKernels* kernels = nullptr;
    std::vector<FarSplat> far;
    std::vector<PixelBounds> bounds;
    std::vector<Chunk> chunks;
    std::size_t chunk_count = 0;
    std::vector<NearSplat> near;
    TileBins bins;

    std::span<const PixelBounds> bounds_of(const Chunk& chunk) const {
        return std::span(bounds).subspan(chunk.slot, chunk.count);
    }
    void split(std::size_t first, std::size_t last);
    void project(const CameraFrame& frame);
    void draw_tile(int t, const CameraFrame& frame, bool add, TilePixels& tile,
                   DepthImage& image) const;
};

/// Splits Gaussians first ... last - 1 into chunks. Their number depends on the Gaussians alone, so
/// the order of splats within a tile is the same for any number of threads.
void SplatRenderer::State::split(std::size_t first, std::size_t last) {
    constexpr std::size_t kLeast = 256, kMost = 32, kGrain = 16;
    const std::size_t count = last - first;
    chunk_count = std::clamp<std::size_t>(count / kLeast, 1, kMost);
    const std::size_t size =
        ((count + chunk_count - 1) / chunk_count + kGrain - 1) / kGrain * kGrain;
    if (chunks.size() < chunk_count) chunks.resize(chunk_count);
    if (far.size() < count) far.resize(count), bounds.resize(count);
    for (std::size_t n = 0; n < chunk_count; ++n) {
        Chunk& chunk = chunks[n];
        chunk.first = std::min(first + n * size, last);
        chunk.last = std::min(chunk.first + size, last);
        chunk.slot = chunk.first - first;
    }
}

/// Projects and bins the chunks.
void SplatRenderer::State::project(const CameraFrame& frame) {
    bins.start(frame.width, frame.height, chunk_count);
    vog::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t n) {
        Chunk& chunk = chunks[n];
        chunk.near.clear();
        SplatRun run{far.data() + chunk.slot, bounds.data() + chunk.slot, 0, &chunk.near};
        kernels->project(model, frame, chunk.first, chunk.last, run);
        chunk.count = run.count;
        bins.count(n, bounds_of(chunk));
    });
    bins.place();
    vog::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t n) {
        bins.fill(n, bounds_of(chunks[n]), static_cast<std::uint32_t>(chunks[n].slot));
    });
    near.clear();
    for (std::size_t n = 0; n < chunk_count; ++n)
        near.insert(near.end(), chunks[n].near.begin(), chunks[n].near.end());
}

/// Draws tile number t. A tile without splats is set to 0 unless `add`.
/// add   add to the image instead of replacing its pixels
/// tile  buffer, all pixels 0 before and after
void SplatRenderer::State::draw_tile(int t, const CameraFrame& frame, bool add, TilePixels& tile,
                                     DepthImage& image) const {
    const int column = t % bins.columns() * kTileWidth, row = t / bins.columns() * kTileHeight;
    const int right = std::min(column + kTileWidth, frame.width) - 1;
    const int bottom = std::min(row + kTileHeight, frame.height) - 1;
    // Splats that touch many tiles are not binned: select those that touch this one.
    constexpr std::size_t kAtOnce = 64;
    std::uint32_t wide[kAtOnce];
    std::size_t wide_count = 0;
    tile.column = column;
    tile.row = row;
    bool touched = !near.empty();
    const auto add_far = [&](const std::uint32_t* index, std::size_t count) {
        if (count == 0) return;
        touched = true;
        kernels->add_far(far.data(), index, count, kernel, tile);
    };
    for (const std::uint32_t n : bins.wide()) {
        const PixelBounds& b = bounds[n];
        if (b.x0 > right || b.x1 < column || b.y0 > bottom || b.y1 < row) continue;
        wide[wide_count++] = n;
        if (wide_count == kAtOnce) {
            add_far(wide, wide_count);
            wide_count = 0;
        }
    }
    add_far(wide, wide_count);
    add_far(bins.of_tile(t).data(), bins.of_tile(t).size());
    for (const NearSplat& splat : near) add_near(splat, model.cutoff, tile);
    if (touched) {
        kernels->finish_tile(tile, frame, model.unit, add, image.depth.data());
    } else if (!add) {
        for (int y = row; y <= bottom; ++y)
            std::fill(&image.at(column, y), &image.at(right, y) + 1, 0.0f);
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
    if (s.options.aabb_sigma > 0)
        return render_boxes(*s.kernels, s.model, s.kernel, frame, s.options.aabb_sigma, report,
                            image);

    if (s.cut) s.model.gaussians = &s.cut->choose(world_frame, s.options.cut);
    // Batches bound the memory of the splats for models of any size.
    const std::size_t size = s.model.gaussians->size();
    const std::size_t batch = TileBins::most_splats(width, height);
    std::size_t first = 0;
    do {
        const std::size_t last = std::min(first + batch, size);
        s.split(first, last);
        s.project(frame);
        // 64 tasks: full tiles lie together, and with 8 tasks, TBB's own choice for two threads, one
        // thread was idle for a third of a small model's time.
        constexpr int kTasks = 64;
        const int grain = std::max(1, s.bins.tiles() / kTasks);
        vog::parallel_for(
            tbb::blocked_range<int>(0, s.bins.tiles(), static_cast<std::size_t>(grain)),
            [&](const tbb::blocked_range<int>& range) {
                TilePixels tile;
                for (int t = range.begin(); t < range.end(); ++t)
                    s.draw_tile(t, frame, first > 0, tile, image);
            },
            tbb::simple_partitioner());
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

CutReport SplatRenderer::cut_report() const {
    return state_->cut ? state_->cut->report() : CutReport{0, 0, state_->all->size()};
}

DepthImage render_splat(const Gaussians& gaussians, const Camera& camera, int width, int height,
                        const SplatOptions& options) {
    return SplatRenderer(gaussians, options).render(camera, width, height);
}

}  // namespace vog
