// fire.cpp: temperature of the synthetic explosion: hot where the gas is thin, cooler in the smoke and outwards.
#include <algorithm>

#include "core/parallel.h"
#include "sample/billow.h"
#include "vog/sample.h"

namespace vog {

using namespace sampling;

namespace {

constexpr Vec3d kCenter{0.03, 0.12, 0.03};     // of the fireball, world units
constexpr double kCore = 0.195;                // radius of even temperature
constexpr double kReach = 0.27;                // from there to where the heat ends
constexpr float kCold = 400, kHottest = 1900;  // K
constexpr float kShade = 0.55f;                // share of the heat that smoke of density 1 takes

float temperature(Vec3d at, float density) {
    const auto away = static_cast<float>((length(at - kCenter) - kCore) / kReach);
    const float heat = smooth_step(1 - away);
    return kCold + (kHottest - kCold) * heat * (1 - kShade * std::min(density, 1.0f));
}

}  // namespace

std::vector<Volume> sample_fire(const SampleOptions& options) {
    Volume density = sample_explosion(options);
    density.source = "sample fire";
    Volume heat = density;
    heat.name = "temperature";
    const auto at = [&](Vec3d index) { return heat.world_from_index(index); };
    vog::parallel_for(std::size_t{0}, heat.leaves.size(), [&](std::size_t i) {
        Leaf& leaf = heat.leaves[i];
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n)) {
                const Vec3i voxel = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
                float& value = leaf.value[static_cast<std::size_t>(n)];
                value = temperature(at(vec_cast<double>(voxel)), value);
            }
    });
    // Tiles lie in the hollow around the centre, where the temperature is even.
    for (Tile& tile : heat.tiles) {
        const double half = 0.5 * (tile.edge - 1);
        tile.value =
            temperature(at(vec_cast<double>(tile.origin) + Vec3d{half, half, half}), tile.value);
    }
    std::vector<Volume> volumes;
    volumes.push_back(std::move(density));
    volumes.push_back(std::move(heat));
    return volumes;
}

}  // namespace vog
