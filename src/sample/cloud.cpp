// cloud.cpp: synthetic cumulus cloud: lobes from spheres budding on spheres, cauliflower relief
// from cellular humps, wisps and uneven density from warped gradient noise.
#include <algorithm>
#include <array>
#include <vector>

#include "sample/billow.h"
#include "sample/density_field.h"

namespace vog {

using namespace sampling;

namespace {

constexpr float kBase = -0.21f;  // y of the flat base, world units

// Distortion of the spheres.
constexpr std::array<Octave, 2> kWarp = {
    {{Noise::gradient, 0.19f, 0.04f, 11}, {Noise::gradient, 0.071f, 0.015f, 12}}};

// Cauliflower humps, then wisps. Amplitudes of the wisps fall more slowly than their cells, so that
// the boundary frays.
constexpr std::array<Octave, 8> kRelief = {{{Noise::humps, 0.093f, 0.05f, 21},
                                            {Noise::humps, 0.047f, 0.028f, 22},
                                            {Noise::humps, 0.0235f, 0.014f, 23},
                                            {Noise::gradient, 0.08f, 0.034f, 31},
                                            {Noise::gradient, 0.041f, 0.028f, 32},
                                            {Noise::gradient, 0.0205f, 0.022f, 33},
                                            {Noise::gradient, 0.0104f, 0.017f, 34},
                                            {Noise::gradient, 0.0052f, 0.012f, 35}}};
constexpr float kReliefLimit = 0.07f;  // largest outward displacement, world units
constexpr float kSoftness = 0.032f;    // depth at which the density has its full value, world units

// Variation of the density inside.
constexpr std::array<Octave, 2> kPockets = {
    {{Noise::gradient, 0.15f, 0.7f, 41}, {Noise::gradient, 0.07f, 0.35f, 42}}};

// Core of density 1 around [0, 1/8]^3, so that the leaf at index 0 is constant from size 64 on, and
// the 128^3 tile there at size 1024: the radius exceeds sqrt(3)/16 = 0.108.
constexpr Sphere kCore = {{0.0625f, 0.0625f, 0.0625f}, 0.109f};
constexpr float kCoreFringe = 0.05f;  // width of the transition to the rest, world units

/// Lobes along z, largest in the middle and flat at the base; towers on top; buds on all.
std::vector<Sphere> grow_lobes(std::uint32_t seed) {
    Uniform uniform(seed);
    std::vector<Sphere> lobes = {{{0.05f, 0.03f, 0.05f}, 0.21f}};
    constexpr int kCount = 11;
    for (int i = 0; i < kCount; ++i) {
        const float along = (static_cast<float>(i) + uniform(0.2f, 0.8f)) / kCount * 2 - 1;
        const float slimming = 1 - 0.6f * along * along;
        const float radius = 0.168f * slimming * uniform(0.75f, 1.25f);
        const float x = uniform(-0.24f, 0.24f) * slimming;
        const float y = kBase + radius * uniform(0.25f, 0.7f);
        lobes.push_back({{x, y, 0.41f * along}, radius});
    }
    const auto add_tower = [&](float half_width, Interval y, Interval z) {
        const float tower_x = uniform(-half_width, half_width);
        const float tower_y = uniform(y.lower, y.upper);
        lobes.push_back({{tower_x, tower_y, uniform(z.lower, z.upper)}, 0.135f});
    };
    add_tower(0.06f, {0.12f, 0.16f}, {-0.12f, 0.0f});
    add_tower(0.08f, {0.04f, 0.1f}, {0.1f, 0.2f});

    const std::vector<Sphere> grown = buds(lobes, {16, 0.85f, 0.3f, 0.52f, -0.2f}, uniform);
    lobes.insert(lobes.end(), grown.begin(), grown.end());
    return lobes;
}

/// Density of the cloud.
class Cloud final : public DensityField {
  public:
    Cloud(std::uint32_t seed, float voxel)
        : billow_{SphereUnion(grow_lobes(seed)),
                  kWarp,
                  0.6f * upper_bound_of(kWarp),
                  kRelief,
                  kReliefLimit,
                  kBase,
                  0.5f,
                  {seed, voxel}} {}

    Interval range(Vec3f center, float radius) const override {
        const float to_core = distance(kCore, center);
        if (to_core + radius <= 0) return {1, 1};
        const bool empty = to_core - radius > 0 && !may_hold(billow_, center, radius);
        return {0, empty ? 0.0f : 1.0f};
    }

    void evaluate(const LeafPoints& points, LeafValues density) const override {
        std::fill(density.begin(), density.end(), 0.0f);
        const auto to_core = [&](std::size_t n) {
            return distance(kCore, {points.x[n], points.y[n], points.z[n]});
        };
        BillowPoints at;
        if (find_depths(billow_, points, at)) {
            alignas(64) std::array<float, kLeafVoxels> inner;
            inner.fill(0.48f);
            add_noise(at.bent, kPockets, billow_.detail, inner);
            for (std::size_t n = 0; n < kLeafVoxels; ++n) {
                // Density follows the relief also inside: dense humps, thin creases.
                const float texture = std::clamp(inner[n] + 14 * at.relief[n], 0.0f, 1.0f);
                const float fog = 0.03f + 0.97f * texture * texture;
                // The relief makes the fringe of the core ragged, unlike a ball.
                const float fringe = std::max(kCoreFringe + 1.2f * at.relief[n], 0.01f);
                const float core = std::clamp(1 - to_core(n) / fringe, 0.0f, 1.0f);
                density[n] = smooth_step(at.depth[n] / kSoftness) * (fog + (1 - fog) * core * core);
            }
        }
        // range() guarantees density 1 in the core, even where the relief cuts deeper.
        for (std::size_t n = 0; n < kLeafVoxels; ++n)
            if (to_core(n) <= 0) density[n] = 1;
    }

  private:
    Billow billow_;
};

}  // namespace

std::unique_ptr<DensityField> sampling::cloud_field(std::uint32_t seed, float voxel) {
    return std::make_unique<Cloud>(seed, voxel);
}

Volume sample_cloud(const SampleOptions& options) {
    const auto field = cloud_field(options.seed, 1.0f / static_cast<float>(options.size));
    return sample_field(*field, "sample cloud", options);
}

}  // namespace vog
