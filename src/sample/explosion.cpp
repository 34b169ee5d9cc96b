// explosion.cpp: synthetic explosion: a fireball with a thick shell around thin constant gas, its
// rim, a stem, and dust on the ground.
#include <algorithm>
#include <array>
#include <vector>

#include "sample/billow.h"
#include "sample/density_field.h"

namespace vog {

using namespace sampling;

namespace {

constexpr float kGround = -0.475f;  // y of the flat ground, world units
constexpr Sphere kFireball = {{0.03f, 0.12f, 0.03f}, 0.27f};

// Distortion of the spheres.
constexpr std::array<Octave, 2> kWarp = {
    {{Noise::gradient, 0.14f, 0.03f, 11}, {Noise::gradient, 0.06f, 0.018f, 12}}};

// Larger humps and weaker wisps than in a cloud.
constexpr std::array<Octave, 8> kRelief = {{{Noise::humps, 0.11f, 0.075f, 21},
                                            {Noise::humps, 0.053f, 0.038f, 22},
                                            {Noise::humps, 0.0265f, 0.019f, 23},
                                            {Noise::gradient, 0.08f, 0.018f, 31},
                                            {Noise::gradient, 0.041f, 0.017f, 32},
                                            {Noise::gradient, 0.0205f, 0.014f, 33},
                                            {Noise::gradient, 0.0104f, 0.011f, 34},
                                            {Noise::gradient, 0.0052f, 0.008f, 35}}};
constexpr float kReliefLimit = 0.07f;  // largest outward displacement, world units
constexpr float kSoftness = 0.022f;    // depth at which the density has its full value, world units

// Variation of the shell's density.
constexpr std::array<Octave, 2> kPockets = {
    {{Noise::gradient, 0.12f, 0.6f, 41}, {Noise::gradient, 0.055f, 0.4f, 42}}};

// Hollow of constant thin gas around [0, 1/8]^3, so that the leaf at index 0 is constant from size
// 64 on: the farthest corner (1/8, 0, 1/8) is 0.180 from the centre.
constexpr Sphere kHollow = {kFireball.center, 0.195f};
constexpr float kHollowFringe = 0.09f;  // width of the transition to the shell, world units
constexpr float kGas = 0.04f;           // density in the hollow

/// Adds spheres around the axis of the fireball, with random distance, height and radius.
void add_ring(std::vector<Sphere>& spheres, int count, Interval distance, Interval y,
              Interval radius, Uniform& uniform) {
    // Directions turn by the golden angle, 137.5 degrees, which spreads them evenly. Its cosine and
    // sine are literals: library results may differ between machines.
    Vec3f direction{1, 0, 0};
    for (int i = 0; i < count; ++i) {
        const float away = uniform(distance.lower, distance.upper);
        const float height = uniform(y.lower, y.upper);
        spheres.push_back({{kFireball.center.x + away * direction.x, height,
                            kFireball.center.z + away * direction.z},
                           uniform(radius.lower, radius.upper)});
        direction = {-0.737369f * direction.x - 0.675490f * direction.z, 0,
                     0.675490f * direction.x - 0.737369f * direction.z};
    }
}

/// Spheres of fireball, rim, stem and dust, with buds on all.
std::vector<Sphere> grow_lobes(std::uint32_t seed) {
    Uniform uniform(seed);
    std::vector<Sphere> cap = {kFireball};
    add_ring(cap, 11, {0.19f, 0.24f}, {0.02f, 0.1f}, {0.1f, 0.135f}, uniform);
    std::vector<Sphere> lobes = buds(cap, {20, 0.85f, 0.25f, 0.42f, -0.7f}, uniform);
    lobes.insert(lobes.end(), cap.begin(), cap.end());

    std::vector<Sphere> stem;
    constexpr int kRise = 9;
    for (int i = 0; i < kRise; ++i) {
        const float up = static_cast<float>(i) / (kRise - 1);
        add_ring(stem, 1, {-0.02f, 0.02f}, {kGround + 0.42f * up, kGround + 0.42f * up},
                 {0.062f + 0.035f * up, 0.077f + 0.035f * up}, uniform);
    }
    add_ring(stem, 24, {0.06f, 0.25f}, {kGround, kGround + 0.01f}, {0.03f, 0.055f}, uniform);
    const std::vector<Sphere> grown = buds(stem, {7, 0.85f, 0.3f, 0.55f, -0.3f}, uniform);
    lobes.insert(lobes.end(), stem.begin(), stem.end());
    lobes.insert(lobes.end(), grown.begin(), grown.end());
    return lobes;
}

/// Density of the explosion.
class Explosion final : public DensityField {
  public:
    Explosion(std::uint32_t seed, float voxel)
        : billow_{SphereUnion(grow_lobes(seed)),
                  kWarp,
                  0.6f * upper_bound_of(kWarp),
                  kRelief,
                  kReliefLimit,
                  kGround,
                  0.3f,
                  {seed, voxel}} {}

    Interval range(Vec3f center, float radius) const override {
        const float to_hollow = distance(kHollow, center);
        if (to_hollow + radius <= 0) return {kGas, kGas};
        const bool empty =
            to_hollow - radius >= kHollowFringe && !may_hold(billow_, center, radius);
        return {0, empty ? 0.0f : 1 + kGas};
    }

    void evaluate(const LeafPoints& points, LeafValues density) const override {
        std::fill(density.begin(), density.end(), 0.0f);
        BillowPoints at;
        if (find_depths(billow_, points, at)) {
            alignas(64) std::array<float, kLeafVoxels> inner;
            inner.fill(0.5f);
            add_noise(at.bent, kPockets, billow_.detail, inner);
            for (std::size_t n = 0; n < kLeafVoxels; ++n) {
                const float texture = std::clamp(inner[n] + 14 * at.relief[n], 0.0f, 1.0f);
                const float shell =
                    smooth_step(at.depth[n] / kSoftness) * (0.05f + 0.95f * texture * texture);
                // The enlarged relief of the boundary makes the inner side of the shell ragged.
                const float fringe = std::max(kHollowFringe + 1.2f * at.relief[n], 0.01f);
                density[n] = shell * (1 - hollowness(points, n, fringe));
            }
        }
        for (std::size_t n = 0; n < kLeafVoxels; ++n)
            density[n] += kGas * hollowness(points, n, kHollowFringe);
    }

  private:
    /// 1 in the hollow, falling to 0 at a distance of `fringe` from it.
    static float hollowness(const LeafPoints& points, std::size_t n, float fringe) {
        return smooth_step(1 - distance(kHollow, {points.x[n], points.y[n], points.z[n]}) / fringe);
    }

    Billow billow_;
};

}  // namespace

std::unique_ptr<DensityField> sampling::explosion_field(std::uint32_t seed, float voxel) {
    return std::make_unique<Explosion>(seed, voxel);
}

Volume sample_explosion(const SampleOptions& options) {
    const auto field = explosion_field(options.seed, 1.0f / static_cast<float>(options.size));
    return sample_field(*field, "sample explosion", options);
}

}  // namespace vog
