// amr.cpp: synthetic universe on three nested AMR levels: halos, filaments, thin gas. Dense blocks
// of 4^3 cells are refined, as in Enzo; the coarse cells below a refined block stay in their level,
// and the finer level hides them.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/parallel.h"
#include "sample/noise.h"
#include "vog/error.h"
#include "vog/sample.h"

namespace vog {

using namespace sampling;

namespace {

constexpr int kLevels = 3;
constexpr int kHalos = 18;
constexpr int kLinks = 2;  // filaments from each halo to its nearest neighbours
constexpr float kFilamentWidth = 0.016f, kFilamentDensity = 1.6f;
constexpr float kThinGas = 0.05f;
/// Density of a cell above which its block is refined; about a tenth of the volume at each level.
constexpr std::array<float, kLevels - 1> kRefineAbove = {0.35f, 2.0f};

// Lumps in the thin gas and along the filaments.
constexpr std::array<Octave, 3> kLumps = {{{Noise::gradient, 0.23f, 0.8f, 51},
                                           {Noise::gradient, 0.11f, 0.5f, 52},
                                           {Noise::gradient, 0.05f, 0.3f, 53}}};

struct Halo {
    Vec3f center;
    float radius = 0, density = 0;
};
struct Filament {
    Vec3f from, along;  ///< from one halo to another
    float inverse_length2 = 0;
};

/// Density of halos, filaments and gas. Float arithmetic and sqrt only: the same bits everywhere.
class Universe {
  public:
    explicit Universe(std::uint32_t seed) : seed_(seed) {
        Uniform uniform(seed);
        for (int n = 0; n < kHalos; ++n) {
            const float x = uniform(-0.42f, 0.42f), y = uniform(-0.42f, 0.42f);
            const float z = uniform(-0.42f, 0.42f), size = uniform();
            halos_.push_back({{x, y, z}, 0.008f + 0.02f * size * size, uniform(6, 24)});
        }
        for (std::size_t a = 0; a < halos_.size(); ++a) {
            std::vector<std::size_t> nearest;
            for (std::size_t b = 0; b < halos_.size(); ++b)
                if (b != a) nearest.push_back(b);
            const auto distance2 = [&](std::size_t b) {
                const Vec3f d = halos_[b].center - halos_[a].center;
                return dot(d, d);
            };
            std::partial_sort(
                nearest.begin(), nearest.begin() + kLinks, nearest.end(),
                [&](std::size_t b, std::size_t c) { return distance2(b) < distance2(c); });
            for (int n = 0; n < kLinks; ++n) {
                const std::size_t b = nearest[static_cast<std::size_t>(n)];
                filaments_.push_back(
                    {halos_[a].center, halos_[b].center - halos_[a].center, 1 / distance2(b)});
            }
        }
    }

    void evaluate(const LeafPoints& points, LeafValues density) const {
        std::fill(density.begin(), density.end(), 0.0f);
        add_noise(points, kLumps, {seed_, 0}, density);
        for (std::size_t n = 0; n < kLeafVoxels; ++n) {
            const float lumps = std::max(1 + density[n], 0.1f);
            const Vec3f at{points.x[n], points.y[n], points.z[n]};
            density[n] = lumps * lumps * (kThinGas + filaments(at)) + halos(at);
        }
    }

  private:
    float halos(Vec3f at) const {
        float sum = 0;
        for (const Halo& halo : halos_) {
            const Vec3f d = at - halo.center;
            const float r = 1 + dot(d, d) / (halo.radius * halo.radius);
            sum += halo.density / (r * std::sqrt(r));  // King's profile
        }
        return sum;
    }
    float filaments(Vec3f at) const {
        float largest = 0;  // not the sum: filaments meet in halos
        for (const Filament& filament : filaments_) {
            const Vec3f to = at - filament.from;
            const float share =
                std::clamp(dot(to, filament.along) * filament.inverse_length2, 0.0f, 1.0f);
            const Vec3f d = to - share * filament.along;
            const float r = 1 + dot(d, d) / (kFilamentWidth * kFilamentWidth);
            largest = std::max(largest, kFilamentDensity / (r * r));
        }
        return largest;
    }

    std::uint32_t seed_;
    std::vector<Halo> halos_;
    std::vector<Filament> filaments_;
};

/// World from index for `across`^3 cells in [-1/2, 1/2]^3.
Affine cells_of(int across) {
    const double edge = 1.0 / across, first = 0.5 * edge - 0.5;
    return {{{Vec3d{edge, 0, 0}, Vec3d{0, edge, 0}, Vec3d{0, 0, edge}}}, {first, first, first}};
}

Leaf evaluated(const Universe& universe, const Affine& world_from_index, int across, Vec3i origin) {
    LeafPoints points;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const Vec3i cell = origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
        const Vec3f at = vec_cast<float>(world_from_index(vec_cast<double>(cell)));
        const auto place = static_cast<std::size_t>(n);
        points.x[place] = at.x, points.y[place] = at.y, points.z[place] = at.z;
    }
    std::array<float, kLeafVoxels> density;
    universe.evaluate(points, density);
    Leaf leaf;
    leaf.origin = origin;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const Vec3i cell = origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
        if (std::max({cell.x, cell.y, cell.z}) < across)
            leaf.set(n, density[static_cast<std::size_t>(n)]);
    }
    return leaf;
}

/// Origins of finer leaves over the octants of leaves with a density above `above`.
std::vector<Vec3i> refined(std::span<const Leaf> leaves, float above) {
    std::vector<Vec3i> fine;
    for (const Leaf& leaf : leaves)
        for (int octant = 0; octant < 8; ++octant) {
            const Vec3i corner{octant & 4, octant << 1 & 4, octant << 2 & 4};
            float largest = 0;
            for (int n = 0; n < 64; ++n)
                largest = std::max(
                    largest,
                    leaf.value[static_cast<std::size_t>(leaf_offset(
                        corner.x + (n >> 4), corner.y + (n >> 2 & 3), corner.z + (n & 3)))]);
            if (largest > above) fine.push_back(2 * (leaf.origin + corner));
        }
    return fine;
}

}  // namespace

std::vector<Volume> sample_levels(const SampleOptions& options) {
    constexpr int kFinestPerCoarsest = 1 << (kLevels - 1);
    if (options.size < 64 || options.size > 1024)
        throw Error(fmt::format("sample amr: size {}, expected 64 to 1024 voxels", options.size));
    const Universe universe(options.seed);
    int across = options.size / kFinestPerCoarsest;
    std::vector<Vec3i> origins;
    for (int x = 0; x < across; x += kLeafEdge)
        for (int y = 0; y < across; y += kLeafEdge)
            for (int z = 0; z < across; z += kLeafEdge) origins.push_back({x, y, z});

    std::vector<Volume> levels;
    for (int level = 0; level < kLevels; ++level, across *= 2) {
        Volume& volume = levels.emplace_back();
        volume.name = fmt::format("density_L{}", level);
        volume.source = "sample amr";
        volume.world_from_index = cells_of(across);
        volume.leaves.resize(origins.size());
        vog::parallel_for(std::size_t{0}, origins.size(), [&](std::size_t n) {
            volume.leaves[n] = evaluated(universe, volume.world_from_index, across, origins[n]);
        });
        if (level + 1 < kLevels)
            origins = refined(volume.leaves, kRefineAbove[static_cast<std::size_t>(level)]);
        std::erase_if(volume.leaves, [](const Leaf& leaf) { return leaf.active_count() == 0; });
        sort_nodes(volume);
        if (options.progress) options.progress((level + 1.0) / kLevels);
    }
    return levels;
}

}  // namespace vog
