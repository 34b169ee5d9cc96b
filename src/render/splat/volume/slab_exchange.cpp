// slab_exchange.cpp: Sums of tiles from the processes that make them to those that composite them.
#include "render/splat/volume/slab_exchange.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include "core/parallel.h"

namespace vog::splat {

namespace {

constexpr int kCells = kCellColumns * kCellRows;
using Packets = std::vector<std::vector<float>>;  ///< [processes]

/// Most bytes of sums that a process holds for others.
constexpr std::size_t kMostBytes = std::size_t{64} << 20;

/// Tiles with a Gaussian of any part.
/// everywhere  all tiles
std::vector<int> shared_tiles(std::span<const SlabPart> models, const Collective& processes,
                              bool everywhere) {
    std::vector<double> any(static_cast<std::size_t>(models.front().drawn->tiles().bins.tiles()),
                            everywhere);
    vog::parallel_for(std::size_t{0}, any.size(), [&](std::size_t t) {
        for (const auto& [drawn, buffers] : models)
            if (!(any[t] > 0)) any[t] = drawn->find(static_cast<int>(t), buffers->local());
    });
    processes.max(any);
    std::vector<int> tiles;
    for (std::size_t t = 0; t < any.size(); ++t)
        if (any[t] > 0) tiles.push_back(static_cast<int>(t));
    return tiles;
}

/// Sums of the slabs of a cell, as numbers: place of the tile in its run, cell of the tile, model, slabs; of each slab its
/// number and the pixels of each channel.
constexpr std::size_t kHead = 4;
std::size_t block_size(int channels) {
    return 1 + static_cast<std::size_t>(channels) * kCellPixels;
}

/// Factors of sums from this process's unit (SplatModel::unit) to that of all, and back.
struct SumUnits {
    float to_all, to_own;
};

/// Appends the sums of a cell, and sets them to 0.
void pack(SlabCell& cell, float factor, std::size_t place, int n, std::size_t model,
          std::vector<float>& to) {
    const std::size_t head = to.size();
    to.insert(to.end(),
              {static_cast<float>(place), static_cast<float>(n), static_cast<float>(model), 0});
    for (int slab = cell.lowest; slab <= cell.highest; ++slab) {
        const std::span<const SlabPlane> planes(cell.slab(slab),
                                                static_cast<std::size_t>(cell.channels));
        if (std::ranges::all_of(planes.front().pixel, [](float tau) { return tau == 0; })) continue;
        ++to[head + 3];
        to.push_back(static_cast<float>(slab));
        for (const SlabPlane& plane : planes)
            for (const float sum : plane.pixel) to.push_back(factor * sum);
    }
    cell.clear();
}

/// Adds slabs of a cell.
void unpack(std::span<const float> blocks, float factor, SlabCell& cell) {
    for (; !blocks.empty(); blocks = blocks.subspan(block_size(cell.channels))) {
        const auto slab = static_cast<int>(blocks[0]);
        cell.touch(slab, slab);
        const float* from = &blocks[1];
        for (int n = 0; n < cell.channels; ++n)
            for (float& sum : cell.slab(slab)[n].pixel) sum += factor * *from++;
    }
}

/// A run of tiles in progress.
struct SlabRunOfTiles {
    std::span<const SlabPart> models;
    const Collective& processes;
    const FinishCell& finish;
    bool everywhere;
    std::vector<SumUnits> units;  ///< [models]
    std::span<const int> tiles;
    std::size_t first;  ///< place of the first among all: owners take turns

    std::size_t owner(std::size_t place) const {
        return (first + place) % static_cast<std::size_t>(processes.count);
    }
    bool is_own(std::size_t place) const {
        return owner(place) == static_cast<std::size_t>(processes.index);
    }
    /// Calls body with the first pixel and the number of pixels of each row of a tile.
    template <class Body>
    void each_row(int t, Rgba* image, const Body& body) const {
        const SlabPicture& drawn = *models.front().drawn;
        const CameraFrame& frame = drawn.view.frame;
        const int top = drawn.tiles().row_of(t), left = drawn.tiles().column_of(t);
        for (int y = top; y < std::min(top + kTileHeight, frame.height); ++y)
            body(image + static_cast<std::ptrdiff_t>(y) * frame.width + left,
                 static_cast<std::size_t>(std::min(kTileWidth, frame.width - left)));
    }
    Packets sums() const;
    void composite(const Packets& from) const;
    void collect(Rgba* image) const;
};

Packets SlabRunOfTiles::sums() const {
    std::vector<std::vector<float>> packed(tiles.size());
    vog::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t n) {
        for (std::size_t model = 0; model < models.size(); ++model) {
            const SlabPicture& drawn = *models[model].drawn;
            SlabBuffers& own = models[model].buffers->local();
            if (!drawn.find(tiles[n], own)) continue;
            drawn.divide(tiles[n], own);
            for (int cell = 0; cell < kCells; ++cell) {
                if (!drawn.begin_cell(tiles[n], cell, own)) continue;
                drawn.sum_cell(own);
                pack(own.cell, units[model].to_all, n, cell, model, packed[n]);
            }
        }
    });
    Packets to(static_cast<std::size_t>(processes.count));
    for (std::size_t n = 0; n < tiles.size(); ++n) {
        std::vector<float>& packet = to[owner(n)];
        packet.insert(packet.end(), packed[n].begin(), packed[n].end());
        packed[n] = {};
    }
    return to;
}

void SlabRunOfTiles::composite(const Packets& from) const {
    const std::size_t count = models.size();
    // [tiles][cells][models]
    std::vector<std::vector<std::span<const float>>> blocks(tiles.size() * kCells * count);
    const std::size_t block = block_size(models.front().buffers->local().cell.channels);
    for (const std::vector<float>& packet : from)
        for (std::span<const float> rest = packet; !rest.empty();) {
            const auto place = static_cast<std::size_t>(rest[0]);
            const auto cell = static_cast<std::size_t>(rest[1]);
            const auto model = static_cast<std::size_t>(rest[2]);
            const std::size_t numbers = block * static_cast<std::size_t>(rest[3]);
            blocks[(place * kCells + cell) * count + model].push_back(rest.subspan(kHead, numbers));
            rest = rest.subspan(kHead + numbers);
        }
    vog::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t n) {
        if (!is_own(n)) return;
        for (int c = 0; c < kCells; ++c) {
            bool any = everywhere;
            for (std::size_t model = 0; model < count; ++model) {
                const auto& parts =
                    blocks[(n * kCells + static_cast<std::size_t>(c)) * count + model];
                if (parts.empty()) continue;
                SlabCell& cell = models[model].buffers->local().cell;
                (void)models[model].drawn->place_cell(tiles[n], c, cell);
                for (const std::span<const float> part : parts)
                    unpack(part, units[model].to_own, cell);
                any = true;
            }
            if (any) finish(tiles[n], c);
        }
    });
}

/// Sends the pixels of own tiles to the root.
void SlabRunOfTiles::collect(Rgba* image) const {
    Packets to(static_cast<std::size_t>(processes.count));
    for (std::size_t n = 0; n < tiles.size(); ++n)
        if (is_own(n) && !processes.is_root())
            each_row(tiles[n], image, [&](const Rgba* row, std::size_t count) {
                for (std::size_t x = 0; x < count; ++x)
                    to[0].insert(to[0].end(), {row[x].r, row[x].g, row[x].b, row[x].a});
            });
    const Packets from = processes.exchange(to);
    std::vector<const float*> next;
    for (const std::vector<float>& packet : from) next.push_back(packet.data());
    for (std::size_t n = 0; n < tiles.size() && processes.is_root(); ++n) {
        if (is_own(n)) continue;
        const float*& at = next[owner(n)];
        each_row(tiles[n], image, [&](Rgba* row, std::size_t count) {
            for (std::size_t x = 0; x < count; ++x, at += 4) row[x] = {at[0], at[1], at[2], at[3]};
        });
    }
}

}  // namespace

double middle_depth(const Gaussians& part, const CameraFrame& frame, const Collective& processes,
                    std::size_t& size) {
    std::vector<double> sizes(static_cast<std::size_t>(processes.count));
    const auto own = static_cast<std::size_t>(processes.index);
    sizes[own] = static_cast<double>(part.size());
    processes.sum(sizes);
    const auto before = std::accumulate(sizes.begin(), sizes.begin() + processes.index, 0.0);
    size = static_cast<std::size_t>(std::accumulate(sizes.begin(), sizes.end(), 0.0));
    const double middle = static_cast<double>(size / 2) - before;
    double depth = -std::numeric_limits<double>::infinity();
    if (middle >= 0 && middle < sizes[own])
        depth = dot(vec_cast<double>(part.mean[static_cast<std::size_t>(middle)]) - frame.eye,
                    frame.forward);
    processes.max({&depth, 1});
    return depth;
}

DepthRange joint_depths(const DepthRange& own, const Collective& processes) {
    double ends[2] = {-double{own.near}, double{own.far}};
    processes.max(ends);
    return {static_cast<float>(-ends[0]), static_cast<float>(ends[1])};
}

void draw_parts(std::span<const SlabPart> models, const Collective& processes,
                const FinishCell& finish, bool everywhere, Rgba* image) {
    const CameraFrame& frame = models.front().drawn->view.frame;
    std::fill_n(image,
                static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height),
                Rgba{0, 0, 0, 0});
    const std::vector<int> tiles = shared_tiles(models, processes, everywhere);
    std::size_t tile_bytes = 0;
    std::vector<SumUnits> units;
    for (const auto& [drawn, buffers] : models) {
        tile_bytes += buffers->local().cell.planes.size() * sizeof(SlabPlane) * kCells;
        // Powers of two: no rounding.
        double unit[1] = {drawn->view.gaussians.size() > 0 ? drawn->unit : 0};
        processes.max(unit);
        units.push_back(
            {static_cast<float>(drawn->unit / unit[0]), static_cast<float>(unit[0] / drawn->unit)});
    }
    const std::size_t run = std::max<std::size_t>(kMostBytes / tile_bytes, 1);
    for (std::size_t first = 0; first < tiles.size(); first += run) {
        const SlabRunOfTiles one{
            models, processes,
            finish, everywhere,
            units,  std::span(tiles).subspan(first, std::min(run, tiles.size() - first)),
            first};
        one.composite(processes.exchange(one.sums()));
        one.collect(image);
    }
}

}  // namespace vog::splat
