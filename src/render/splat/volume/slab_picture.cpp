// slab_picture.cpp: splats of tiles sorted by slab, and their sums.
#include "render/splat/volume/slab_picture.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <numeric>

#include "core/parallel.h"

namespace vog::splat {

SlabDepths slab_depths(const DepthRange& range, int slabs) {
    // A margin keeps rounded depths inside.
    const float margin = 1e-5f * (range.far - range.near) + std::numeric_limits<float>::min();
    return {range.near - margin, (range.far - range.near + 2 * margin) / static_cast<float>(slabs)};
}

void SplatExtent::add(const FarSplat& splat) {
    const PixelBounds& at = splat.bounds;
    const double pixels = (at.x1 - at.x0 + 1.0) * (at.y1 - at.y0 + 1.0);
    const float axis = least_half_axis(splat);
    area += pixels;
    for (int n = 0; n < kMostHalves; ++n)
        if (axis < kWideHalfAxis * static_cast<float>(1 << n)) narrow[n] += pixels;
}

void SplatExtent::include(const SplatExtent& other) {
    depths.include(other.depths);
    area += other.area;
    for (int n = 0; n < kMostHalves; ++n) narrow[n] += other.narrow[n];
}

int SplatExtent::halves() const {
    int count = 0;
    while (count < kMostHalves && narrow[count] <= 0.5 * area) ++count;
    return area > 0 ? count : 0;
}

SplatExtent SlabPicture::project(const SplatModel& model, SlabBatch& batch, std::size_t first,
                                 std::size_t last) const {
    ProjectedSplats& splats = batch.splats;
    splats.keep_origin = true;
    batch.fields.resize(std::max(batch.fields.size(), last - first));
    SplatExtent all;
    std::mutex joining;
    splats.project(kernels, model, view.frame, first, last, [&](SplatChunk& chunk) {
        SplatExtent extent;
        for (std::size_t n = chunk.slot; n < chunk.slot + chunk.count; ++n) {
            SlabSplat& field = batch.fields[n];
            field = slab_splat(view, splats.origin[n], splats.far[n]);
            extent.depths.include({field.near, field.far});
            extent.add(splats.far[n]);
        }
        for (const NearSplat& splat : chunk.near)
            extent.depths.include(depths_of(view, splat.index));
        const std::scoped_lock lock(joining);
        all.include(extent);
    });
    return all;
}

void KeptSums::begin(int tiles, const SlabDepths& depths) {
    depths_ = depths;
    tiles_.clear();
    tiles_.resize(static_cast<std::size_t>(tiles));
    bytes_ = 0;
}

void KeptSums::add(int t, const SlabCell& cell) {
    if (!cell.touched()) return;
    const auto planes = static_cast<std::size_t>((cell.highest - cell.lowest + 1) * cell.channels);
    if ((bytes_ += planes * sizeof(SlabPlane)) > kMostBytes) return;
    const SlabPlane* first = cell.slab(cell.lowest);
    tiles_[static_cast<std::size_t>(t)].push_back(
        {cell.column, cell.row, cell.lowest, cell.highest, {first, first + planes}});
}

bool SlabPicture::find(int t, SlabBuffers& buffers) const {
    bool any = false;
    buffers.near.clear();
    buffers.of_batch.resize(std::max(buffers.of_batch.size(), batches.size()));
    for (std::size_t b = 0; b < batches.size(); ++b) {
        std::vector<std::uint32_t>& found = buffers.of_batch[b].found;
        found.clear();
        any |= batches[b].splats.visit(
            t, view.frame,
            [&](const std::uint32_t* index, std::size_t count) {
                found.insert(found.end(), index, index + count);
            },
            [&](const NearSplat& splat) { buffers.near.push_back(&splat); });
    }
    return any;
}

void SlabPicture::divide(int t, SlabBuffers& buffers) const {
    SlabCell& cell = buffers.cell;
    cell.depths = depths;
    const int left = tiles().column_of(t), top = tiles().row_of(t);
    const auto slabs = static_cast<std::size_t>(cell.slabs);
    for (std::size_t b = 0; b < batches.size(); ++b) {
        // Two counting sorts, stable: sums have one order for any number of threads.
        const SlabBatch& batch = batches[b];
        SlabBuffers::TileSplats& of = buffers.of_batch[b];
        const auto slab_of = [&](float depth) {
            return static_cast<std::uint16_t>(cell.slab_at(depth));
        };
        of.begin.assign(slabs + 1, 0);
        for (const std::uint32_t n : of.found) ++of.begin[slab_of(batch.fields[n].near) + 1u];
        std::partial_sum(of.begin.begin(), of.begin.end(), of.begin.begin());
        of.sorted.resize(of.found.size());
        for (const std::uint32_t n : of.found) {
            const std::uint16_t first = slab_of(batch.fields[n].near);
            of.sorted[of.begin[first]++] = {n, first, slab_of(batch.fields[n].far)};
        }
        const auto each_cell = [&](const CellSplat& splat, const auto& visit) {
            const PixelBounds& at = batch.splats.bounds[splat.splat];
            const int x0 = std::max(at.x0 - left, 0) / kCellWidth;
            const int x1 = std::min(at.x1 - left, kTileWidth - 1) / kCellWidth;
            const int y0 = std::max(at.y0 - top, 0) / kCellHeight;
            const int y1 = std::min(at.y1 - top, kTileHeight - 1) / kCellHeight;
            for (int y = y0; y <= y1; ++y)
                for (int x = x0; x <= x1; ++x)
                    visit(static_cast<std::size_t>(y * kCellColumns + x));
        };
        auto& begin = of.cell_begin;
        begin.fill(0);
        for (const CellSplat& splat : of.sorted)
            each_cell(splat, [&](std::size_t n) { ++begin[n + 1]; });
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        of.in_cells.resize(begin.back());
        auto next = begin;
        for (const CellSplat& splat : of.sorted)
            each_cell(splat, [&](std::size_t n) { of.in_cells[next[n]++] = splat; });
    }
}

bool SlabPicture::place_cell(int t, int n, SlabCell& cell) const {
    cell.column = tiles().column_of(t) + n % kCellColumns * kCellWidth;
    cell.row = tiles().row_of(t) + n / kCellColumns * kCellHeight;
    cell.rows = kAllRows;
    if (cell.column >= view.frame.width || cell.row >= view.frame.height) return false;
    if (rows) cell.rows = rows->of(cell.column, cell.row);
    return true;
}

/// Adds the rows of splats that may lie between the pixels at half the resolution.
void SlabPicture::add_narrow(const SlabBuffers& buffers, int t) const {
    const int left = tiles().column_of(t), top = tiles().row_of(t);
    const int right = std::min(left + kTileWidth, view.frame.width) - 1;
    const int bottom = std::min(top + kTileHeight, view.frame.height) - 1;
    for (std::size_t b = 0; b < batches.size(); ++b)
        for (const std::uint32_t n : buffers.of_batch[b].found) {
            const ProjectedSplats& splats = batches[b].splats;
            if (!(least_half_axis(splats.far[n]) < kLeastHalfAxis)) continue;
            const PixelBounds& at = splats.bounds[n];
            for (int y = std::max<int>(at.y0, top); y <= std::min<int>(at.y1, bottom); ++y)
                for (int x = std::max<int>(at.x0, left) / kCellWidth;
                     x <= std::min<int>(at.x1, right) / kCellWidth; ++x)
                    rows->of(x * kCellWidth, y) |= std::uint32_t{1} << (y % kCellHeight);
        }
}

bool SlabPicture::draws_in(int t) const {
    const int left = tiles().column_of(t), top = tiles().row_of(t);
    for (int y = top; y < std::min(top + kTileHeight, view.frame.height); y += kCellHeight)
        for (int x = left; x < std::min(left + kTileWidth, view.frame.width); x += kCellWidth)
            if (rows->of(x, y) != 0) return true;
    return false;
}

bool SlabPicture::begin_cell(int t, int n, SlabBuffers& buffers) const {
    SlabCell& cell = buffers.cell;
    if (!place_cell(t, n, cell)) return false;
    bool any = !buffers.near.empty();
    buffers.runs.clear();
    for (std::size_t b = 0; b < batches.size(); ++b) {
        const SlabBuffers::TileSplats& of = buffers.of_batch[b];
        const auto at = static_cast<std::size_t>(n);
        const std::uint32_t first = of.cell_begin[at], last = of.cell_begin[at + 1];
        buffers.runs.push_back({batches[b].splats.far.data(), batches[b].fields.data(),
                                std::span(of.in_cells).subspan(first, last - first)});
        any |= first < last;
    }
    if (!any) return false;
    set_clip(view, cell);
    for (const NearSplat* splat : buffers.near) add_near_splat(view, *splat, cell);
    return true;
}

void SlabPicture::sum_cell(SlabBuffers& buffers) const {
    slab_kernels(kernels).sum({buffers.runs, polynomials, view.frame}, buffers.cell);
}

void SlabPicture::write(const SlabCell& cell, Rgba* image) const {
    const auto& [red, green, blue, transmittance] = cell.seen;
    for (int y = 0; y < std::min(kCellHeight, view.frame.height - cell.row); ++y) {
        if (!cell.draws(static_cast<std::size_t>(y))) continue;
        Rgba* row =
            image + static_cast<std::ptrdiff_t>(cell.row + y) * view.frame.width + cell.column;
        for (int x = 0; x < std::min(kCellWidth, view.frame.width - cell.column); ++x) {
            const auto n = static_cast<std::size_t>(y * kCellWidth + x);
            row[x] = {red[n], green[n], blue[n], 1 - transmittance[n]};
        }
    }
}

void SlabPicture::finish_cell(SlabCell& cell, Rgba* image) const {
    cell.depths = depths;  // of sums that another thread or process added up
    if (light)
        slab_kernels(kernels).composite(*light, cell);
    else
        slab_kernels(kernels).maximum(most_share, cell);
    write(cell, image);
    cell.clear();
}

void SlabPicture::draw_tile(int t, SlabBuffers& buffers, Rgba* image) const {
    const bool any = find(t, buffers);
    if (any && rows) add_narrow(buffers, t);
    if (rows && !draws_in(t)) return;
    if (any) divide(t, buffers);
    SlabCell& cell = buffers.cell;
    for (int n = 0; n < kCellColumns * kCellRows; ++n) {
        if (!place_cell(t, n, cell) || cell.rows == 0) continue;
        if (!any || !begin_cell(t, n, buffers)) {
            cell.seen = {};
            cell.seen[3].fill(1);
            write(cell, image);
            continue;
        }
        if (light && !kept) {
            slab_kernels(kernels).draw({buffers.runs, polynomials, view.frame}, *light, cell);
            write(cell, image);
            cell.clear();
        } else {
            sum_cell(buffers);
            if (kept) kept->add(t, cell);
            finish_cell(cell, image);
        }
    }
}

void SlabPicture::draw_kept(tbb::enumerable_thread_specific<SlabBuffers>& buffers,
                            Rgba* image) const {
    const CameraFrame& frame = view.frame;
    std::fill_n(image,
                static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height),
                Rgba{0, 0, 0, 0});
    vog::parallel_for(0, kept->tiles(), [&](int t) {
        SlabCell& cell = buffers.local().cell;
        kept->each_cell(t, cell, [&] { finish_cell(cell, image); });
    });
}

}  // namespace vog::splat
