// slab_layers.cpp: cells of a picture, each with the slabs of all layers.
#include "render/layers/slab_layers.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/reference/reference_grid.h"
#include "render/splat/splat_kernels.h"
#include "render/splat/volume/slab_exchange.h"
#include "render/splat/volume/slab_picture.h"

namespace vog::layers {

using namespace splat;
using reference::LitPiece, reference::Segment;

namespace {

/// Depths of a box from the eye, in front of it.
DepthRange depths_of(const Box& box, const CameraFrame& frame) {
    DepthRange range = kNoDepths;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3d at = box.lower;
        for (int axis = 0; axis < 3; ++axis)
            if (corner >> axis & 1) at[axis] = box.upper[axis];
        const auto depth = static_cast<float>(dot(at - frame.eye, frame.forward));
        range.include({depth, depth});
    }
    range.near = std::max(range.near, 0.0f);
    return range;
}

/// Light of a pixel's pieces in each slab, composited in their order.
class PixelSlabs {
  public:
    PixelSlabs(SlabCell& cell, std::uint32_t pixel, std::vector<SlabSurface>& surfaces)
        : cell_(cell), pixel_(pixel), surfaces_(surfaces) {}
    ~PixelSlabs() { finish(); }
    PixelSlabs(const PixelSlabs&) = delete;
    PixelSlabs& operator=(const PixelSlabs&) = delete;

    /// Adds a run of one light, behind those before.
    void add(const Segment& run, const ValueLight& light, double stretch) {
        const SlabDepths& depths = cell_.depths;
        const int first = cell_.slab_at(static_cast<float>(run.first));
        const int last = cell_.slab_at(static_cast<float>(run.last));
        const auto front = [&](int slab) {
            return double{depths.first} + slab * double{depths.thickness};
        };
        if (reference::is_surface(run)) {
            if (first != slab_) finish(), slab_ = first;
            const double depth = light.extinction * (run.last - run.first) * stretch;
            const double share = (run.first - front(first)) / double{depths.thickness};
            surfaces_.push_back({first,
                                 pixel_,
                                 static_cast<float>(std::clamp(share, 0.0, 1.0)),
                                 take(),
                                 {static_cast<float>(light.r), static_cast<float>(light.g),
                                  static_cast<float>(light.b)},
                                 static_cast<float>(-std::expm1(-depth))});
            cell_.touch(first, first);
            return;
        }
        for (int slab = first; slab <= last; ++slab) {
            if (slab != slab_) finish(), slab_ = slab;
            const double from = slab == first ? run.first : front(slab);
            const double to = slab == last ? run.last : front(slab + 1);
            light_.add(light.extinction * std::max(to - from, 0.0) * stretch, light.r, light.g,
                       light.b);
        }
    }

  private:
    /// Colour times the optical depth of the runs since the last call, and that depth.
    std::array<float, 4> take() {
        const double absorbed = 1 - light_.transmittance;
        std::array<float, 4> sums{};
        if (absorbed > 0) {
            const double tau = -std::log(std::max(light_.transmittance, 1e-30)),
                         per = tau / absorbed;
            sums = {static_cast<float>(per * light_.r), static_cast<float>(per * light_.g),
                    static_cast<float>(per * light_.b), static_cast<float>(tau)};
        }
        light_ = {};
        return sums;
    }
    /// Writes the sums of the slab.
    void finish() {
        const std::array<float, 4> sums = take();
        if (!(sums[3] > 0)) return;
        for (std::size_t c = 0; c < 4; ++c) cell_.slab(slab_)[c].pixel[pixel_] = sums[c];
        cell_.touch(slab_, slab_);
    }

    SlabCell& cell_;
    std::uint32_t pixel_;
    std::vector<SlabSurface>& surfaces_;
    int slab_ = 0;
    reference::Compositor light_;
};

/// Adds voxels and surfaces in front of the pixels of a cell.
/// surfaces  receives those, as composite_layers takes them
void add_rays(std::span<const std::unique_ptr<reference::LitRays>> rays, const CameraFrame& frame,
              const Clipping& clip, SlabCell& cell, std::vector<SlabSurface>& surfaces) {
    thread_local std::vector<LitPiece> pieces;
    surfaces.clear();
    for (int y = 0; y < std::min(kCellHeight, frame.height - cell.row); ++y)
        for (int x = 0; x < std::min(kCellWidth, frame.width - cell.column); ++x) {
            const Vec3d origin = frame.origin(cell.column + x, cell.row + y);
            const Vec3d direction = frame.direction(cell.column + x, cell.row + y);
            Segment within = reference::visible_segment(clip, origin, direction);
            if (within.empty()) continue;
            pieces.clear();
            for (const auto& layer : rays) layer->add(origin, direction, within, pieces);
            PixelSlabs slabs(cell, static_cast<std::uint32_t>(y * kCellWidth + x), surfaces);
            reference::for_each_run_of_light(pieces,
                                             [&](const Segment& run, const ValueLight& light) {
                                                 slabs.add(run, light, length(direction));
                                                 return true;
                                             });
        }
    std::ranges::stable_sort(surfaces, {}, &SlabSurface::slab);
}

/// Buffers of a thread.
struct Buffers {
    SlabCell of_rays;
    std::vector<SlabSurface> surfaces;
    std::vector<LayerCell> cells;
    alignas(64) std::array<CellPixels, 4> seen;
};

void write(const Buffers& of, int column, int row, VolumeImage& picture) {
    const auto& [red, green, blue, transmittance] = of.seen;
    for (int y = 0; y < std::min(kCellHeight, picture.height - row); ++y)
        for (int x = 0; x < std::min(kCellWidth, picture.width - column); ++x) {
            const auto n = static_cast<std::size_t>(y * kCellWidth + x);
            const auto at =
                static_cast<std::size_t>(row + y) * static_cast<std::size_t>(picture.width) +
                static_cast<std::size_t>(column + x);
            picture.pixel[at] = {red[n], green[n], blue[n], 1 - transmittance[n]};
        }
}

}  // namespace

void draw_slabs(std::span<SlabRenderer* const> models,
                std::span<const std::unique_ptr<reference::LitRays>> rays, const Box& box,
                const Camera& camera, int slabs, const Clipping& clip,
                const lights::Illumination& reached, const Collective* processes,
                VolumeImage& picture) {
    const int width = picture.width, height = picture.height;
    const CameraFrame frame = frame_of(camera, width, height);
    picture.pixel.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                         Rgba{0, 0, 0, 0});
    DepthRange range = kNoDepths;
    std::vector<SlabRenderer*> seen;
    for (SlabRenderer* model : models)
        if (model->begin(camera, width, height, reached, range)) seen.push_back(model);
    if (!box.empty()) range.include(depths_of(box, frame));
    if (range.empty()) range = {0, 1};  // of surfaces
    const SlabDepths depths = slab_depths(range, slabs);
    for (SlabRenderer* model : seen) model->set_depths(depths);
    const SlabKernels& kernels = models.front()->kernels();
    tbb::enumerable_thread_specific<Buffers> buffers([&] {
        Buffers made;
        made.of_rays.resize(slabs, 4);
        made.of_rays.depths = depths;
        return made;
    });
    const int columns = (width + kTileWidth - 1) / kTileWidth;
    const int rows = (height + kTileHeight - 1) / kTileHeight;
    const auto finish = [&](int t, int n, std::span<SlabRenderer* const> here,
                            const auto& cell_of) {
        Buffers& own = buffers.local();
        const int column = t % columns * kTileWidth + n % kCellColumns * kCellWidth;
        const int row = t / columns * kTileHeight + n / kCellColumns * kCellHeight;
        if (column >= width || row >= height) return;
        own.cells.clear();
        for (SlabRenderer* model : here)
            if (const LayerCell cell = cell_of(*model); cell.cell && cell.cell->touched())
                own.cells.push_back(cell);
        own.of_rays.column = column, own.of_rays.row = row;
        add_rays(rays, frame, clip, own.of_rays, own.surfaces);
        if (own.of_rays.touched()) own.cells.push_back({&own.of_rays, nullptr});
        if (own.cells.empty()) return;
        kernels.composite_layers(own.cells, own.surfaces, own.seen);
        write(own, column, row, picture);
        for (const LayerCell& cell : own.cells) cell.cell->clear();
    };
    if (processes && !seen.empty()) {
        std::vector<SlabPart> parts;
        for (SlabRenderer* model : seen) parts.push_back(model->part());
        const auto received = [](SlabRenderer& model) { return model.received(); };
        return draw_parts(
            parts, *processes, [&](int t, int n) { finish(t, n, seen, received); }, !rays.empty(),
            picture.pixel.data());
    }
    vog::parallel_for(0, columns * rows, [&](int t) {
        std::vector<SlabRenderer*> here;
        for (SlabRenderer* model : seen)
            if (model->begin_tile(t)) here.push_back(model);
        for (int n = 0; n < kCellColumns * kCellRows; ++n)
            finish(t, n, here, [&](SlabRenderer& model) { return model.sum_cell(t, n); });
    });
}

}  // namespace vog::layers
