// cell_division.cpp: voxels of the cells of a hard uniform cut.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "convert/fields/division.h"
#include "core/parallel.h"

namespace vog::joint {

namespace {

using moments::kRun;
using moments::RunKernel;

struct CellHash {
    std::size_t operator()(Vec3i v) const {
        std::uint64_t sum = 0;
        for (int axis = 0; axis < 3; ++axis)
            sum = (sum ^ static_cast<std::uint32_t>(v[axis])) * 0x9e3779b97f4a7c15u;
        return sum ^ sum >> 29;
    }
};

class CellDivision : public Division {
  public:
    CellDivision(const Gaussians& model, const Volume& volume, int block)
        : bricks_(field_bricks(volume)), block_(block) {
        const Affine index_from_world = inverse(volume.world_from_index);
        mean_.reserve(model.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            mean_.push_back(index_from_world(world_mean(model, i)));
            gaussian_.emplace(cell_at(mean_.back()), static_cast<std::uint32_t>(i));
        }
    }

    void add(std::size_t width, const PartsOfBrick& parts_of,
             std::span<double> sums) const override {
        constexpr std::size_t kAtOnce = 512;
        struct Result {
            std::vector<std::uint32_t> gaussian;
            std::vector<double> parts;
        };
        std::vector<Result> results(std::min(kAtOnce, bricks_.size()));
        for (std::size_t first = 0; first < bricks_.size(); first += kAtOnce) {
            const std::size_t count = std::min(kAtOnce, bricks_.size() - first);
            vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
                Result& result = results[n];
                moments::BrickScratch scratch;
                result.gaussian.clear();
                divide(bricks_[first + n], scratch, result.gaussian);
                result.parts.assign(width * result.gaussian.size(), 0);
                parts_of({&bricks_[first + n], &scratch, {}}, result.gaussian, result.parts);
            });
            for (std::size_t n = 0; n < count; ++n)
                for (std::size_t k = 0; k < results[n].gaussian.size(); ++k)
                    for (std::size_t s = 0; s < width; ++s)
                        sums[width * results[n].gaussian[k] + s] += results[n].parts[width * k + s];
        }
    }

  private:
    Vec3i cell_at(Vec3d index) const {
        const auto along = [&](double at) {
            return static_cast<std::int32_t>(std::floor((at + 0.5) / block_));
        };
        return {along(index.x), along(index.y), along(index.z)};
    }
    /// The Gaussian of a cell of `side` voxels; null: dropped.
    const std::uint32_t* find(Vec3d center, double side) const {
        if (side <= block_) {
            const auto place = gaussian_.find(cell_at(center));
            return place == gaussian_.end() ? nullptr : &place->second;
        }
        // A cell of a large tile is wider than the block. Its mean, the centre, is a corner of blocks, and rounding
        // decides in which of them it lies.
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d off{corner & 1 ? 0.25 : -0.25, corner & 2 ? 0.25 : -0.25,
                            corner & 4 ? 0.25 : -0.25};
            const auto place = gaussian_.find(cell_at(center + off));
            if (place != gaussian_.end()) return &place->second;
        }
        return nullptr;
    }
    /// Sets the scratch's runs, one for each cell of a brick that has a Gaussian, with values 1 inside.
    void divide(const FieldBrick& field_brick, moments::BrickScratch& scratch,
                std::vector<std::uint32_t>& gaussian) const;

    std::vector<FieldBrick> bricks_;
    int block_;
    std::vector<Vec3d> mean_;  ///< index space
    std::unordered_map<Vec3i, std::uint32_t, CellHash> gaussian_;
};

void CellDivision::divide(const FieldBrick& field_brick, moments::BrickScratch& scratch,
                          std::vector<std::uint32_t>& gaussian) const {
    const moments::Brick& brick = field_brick.brick;
    // Cells of tiles are not smaller than a sample; those beyond a brick not smaller than the brick.
    const int samples = std::clamp(static_cast<int>(block_ / brick.spacing), 1, kLeafEdge);
    const bool whole = block_ > kLeafEdge;
    const int edge = whole ? kLeafEdge : samples, across = kLeafEdge / edge;
    for (int n = 0; n < kLeafVoxels; ++n)
        scratch.sum[static_cast<std::size_t>(n)] =
            brick.sample(n) * static_cast<float>(brick.sample_volume());
    const Vec3d first = moments::brick_cell_center(brick, 0, 1);
    std::vector<float> values;
    for (int cell = 0; cell < across * across * across; ++cell) {
        const Vec3i at{cell / (across * across), cell / across % across, cell % across};
        const Vec3d center = first + brick.spacing * (double(edge) * vec_cast<double>(at) +
                                                      0.5 * (edge - 1) * Vec3d{1, 1, 1});
        const std::uint32_t* found = find(center, edge * brick.spacing);
        if (!found) continue;
        const Vec3f d = vec_cast<float>(first - mean_[*found]);
        RunKernel run;
        run.dx = d.x, run.dy = d.y, run.dz = d.z;
        run.step = static_cast<float>(brick.spacing);
        run.x0 = edge * at.x, run.x1 = run.x0 + edge - 1;
        const int y0 = edge * at.y, y1 = y0 + edge - 1, z0 = edge * at.z, z1 = z0 + edge - 1;
        run.y0 = y0 / 2, run.y1 = y1 / 2;
        run.first_run = values.size() / kRun;
        for (int pair = run.y0; pair <= run.y1; ++pair)
            for (int x = run.x0; x <= run.x1; ++x)
                for (int lane = 0; lane < kRun; ++lane) {
                    const int y = 2 * pair + lane / kLeafEdge, z = lane % kLeafEdge;
                    values.push_back(y >= y0 && y <= y1 && z >= z0 && z <= z1 ? 1.0f : 0.0f);
                }
        scratch.runs.push_back(run);
        gaussian.push_back(*found);
    }
    scratch.values = hwy::AllocateAligned<float>(std::max<std::size_t>(values.size(), kRun));
    std::ranges::copy(values, scratch.values.get());
}

}  // namespace

std::unique_ptr<Division> cell_division(const Gaussians& model, const Volume& volume, int block) {
    return std::make_unique<CellDivision>(model, volume, block);
}

}  // namespace vog::joint
