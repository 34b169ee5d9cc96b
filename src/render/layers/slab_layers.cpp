// slab_layers.cpp: cells of a picture, each with the slabs of all layers.
#include "render/layers/slab_layers.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/reference/reference_grid.h"
#include "render/splat/splat_kernels.h"
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
    PixelSlabs(SlabCell& cell, std::size_t pixel) : cell_(cell), pixel_(pixel) {}
    ~PixelSlabs() { finish(); }
    PixelSlabs(const PixelSlabs&) = delete;
    PixelSlabs& operator=(const PixelSlabs&) = delete;

    /// Adds a run of one light, behind those before.
    void add(const Segment& run, const ValueLight& light, double stretch) {
        const SlabDepths& depths = cell_.depths;
        const int first = cell_.slab_at(static_cast<float>(run.first));
        const int last = cell_.slab_at(static_cast<float>(run.last));
        for (int slab = first; slab <= last; ++slab) {
            if (slab != slab_) finish(), slab_ = slab;
            const double front = double{depths.first} + slab * double{depths.thickness};
            const double from = slab == first ? run.first : front;
            const double to = slab == last ? run.last : front + double{depths.thickness};
            light_.add(light.extinction * std::max(to - from, 0.0) * stretch, light.r, light.g,
                       light.b);
        }
    }

  private:
    /// Optical depth of the slab, and its colour times that.
    void finish() {
        const double absorbed = 1 - light_.transmittance;
        if (absorbed > 0) {
            const double tau = -std::log(std::max(light_.transmittance, 1e-30)),
                         per = tau / absorbed;
            const double sums[4] = {per * light_.r, per * light_.g, per * light_.b, tau};
            for (int c = 0; c < 4; ++c)
                cell_.slab(slab_)[c].pixel[pixel_] = static_cast<float>(sums[c]);
            cell_.touch(slab_, slab_);
        }
        light_ = {};
    }

    SlabCell& cell_;
    std::size_t pixel_;
    int slab_ = 0;
    reference::Compositor light_;
};

/// Adds the voxels in front of the pixels of a cell.
void add_voxels(const VoxelLayer& layer, const CameraFrame& frame, const Clipping& clip,
                SlabCell& cell) {
    thread_local std::vector<LitPiece> pieces;
    for (int y = 0; y < std::min(kCellHeight, frame.height - cell.row); ++y)
        for (int x = 0; x < std::min(kCellWidth, frame.width - cell.column); ++x) {
            const Vec3d origin = frame.origin(cell.column + x, cell.row + y);
            const Vec3d direction = frame.direction(cell.column + x, cell.row + y);
            const Segment within = reference::visible_segment(clip, origin, direction);
            if (within.empty()) continue;
            pieces.clear();
            layer.rays.add(origin, direction, within, pieces);
            PixelSlabs slabs(cell, static_cast<std::size_t>(y * kCellWidth + x));
            reference::for_each_run_of_light(pieces,
                                             [&](const Segment& run, const ValueLight& light) {
                                                 slabs.add(run, light, length(direction));
                                                 return true;
                                             });
        }
}

/// Buffers of a thread.
struct Buffers {
    std::vector<SlabCell> voxels;  ///< [layers]
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

void draw_slabs(std::span<SlabRenderer* const> models, std::span<const VoxelLayer> voxels,
                const Camera& camera, int slabs, const Clipping& clip,
                const lights::Illumination& reached, VolumeImage& picture) {
    const int width = picture.width, height = picture.height;
    const CameraFrame frame = frame_of(camera, width, height);
    picture.pixel.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                         Rgba{0, 0, 0, 0});
    DepthRange range = kNoDepths;
    std::vector<SlabRenderer*> seen;
    for (SlabRenderer* model : models)
        if (model->begin(camera, width, height, reached, range)) seen.push_back(model);
    for (const VoxelLayer& layer : voxels) range.include(depths_of(layer.box, frame));
    if (range.empty()) return;
    const SlabDepths depths = slab_depths(range, slabs);
    for (SlabRenderer* model : seen) model->set_depths(depths);
    const SlabKernels& kernels = models.front()->kernels();
    tbb::enumerable_thread_specific<Buffers> buffers([&] {
        Buffers made;
        made.voxels.resize(voxels.size());
        for (SlabCell& cell : made.voxels) {
            cell.resize(slabs, 4);
            cell.depths = depths;
        }
        return made;
    });
    const int columns = (width + kTileWidth - 1) / kTileWidth;
    const int rows = (height + kTileHeight - 1) / kTileHeight;
    vog::parallel_for(0, columns * rows, [&](int t) {
        Buffers& own = buffers.local();
        std::vector<SlabRenderer*> here;
        for (SlabRenderer* model : seen)
            if (model->begin_tile(t)) here.push_back(model);
        for (int n = 0; n < kCellColumns * kCellRows; ++n) {
            const int column = t % columns * kTileWidth + n % kCellColumns * kCellWidth;
            const int row = t / columns * kTileHeight + n / kCellColumns * kCellHeight;
            if (column >= width || row >= height) continue;
            own.cells.clear();
            for (SlabRenderer* model : here)
                if (const LayerCell cell = model->sum_cell(t, n); cell.cell)
                    own.cells.push_back(cell);
            for (std::size_t v = 0; v < voxels.size(); ++v) {
                SlabCell& cell = own.voxels[v];
                cell.column = column, cell.row = row;
                add_voxels(voxels[v], frame, clip, cell);
                if (cell.touched()) own.cells.push_back({&cell, nullptr});
            }
            if (own.cells.empty()) continue;
            kernels.composite_layers(own.cells, own.seen);
            write(own, column, row, picture);
            for (const LayerCell& cell : own.cells) cell.cell->clear();
        }
    });
}

}  // namespace vog::layers
