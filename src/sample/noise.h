// noise.h: noise on an integer hash lattice, evaluated for the 512 voxel centres of a leaf at once.
// Sources: Perlin, "Improving Noise" (2002); Worley, "A Cellular Texture Basis Function" (1996).
//
// Plain float arithmetic and integer hashes only, no library functions but sqrt: the same bits on
// every machine. Both noises are pure functions of position, whatever leaf asks for them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "vog/volume.h"

namespace vog::sampling {

/// World positions of a leaf's voxel centres, by leaf_offset.
struct LeafPoints {
    alignas(64) std::array<float, kLeafVoxels> x, y, z;
};
using LeafValues = std::span<float, kLeafVoxels>;

/// Smallest and largest of some values; interval_of takes a multiple of eight.
struct Interval {
    float lower = 0, upper = 0;
};
Interval interval_of(std::span<const float> values);

enum class Noise {
    gradient,  ///< smooth, mean 0
    humps,     ///< round humps with sharp creases between them, mean near 0: the largest of the
               ///< paraboloids about one random feature point in each lattice cell
};

/// One band of noise.
struct Octave {
    Noise noise = Noise::gradient;
    float cell = 1;       ///< edge of a lattice cell, world units
    float amplitude = 1;  ///< the noise stays within +/- amplitude
    std::uint32_t seed = 0;
};

/// What all octaves of a field share.
struct Detail {
    std::uint32_t seed = 0;  ///< changes all of them
    float voxel = 0;         ///< edge of a voxel: octaves too fine for it are left out
};

/// Mixes the bits of x: a bijection without visible pattern (lowbias32 of Chris Wellons).
constexpr std::uint32_t mixed(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/// Deterministic uniform numbers in [0, 1): 24 bits of a hashed counter.
class Uniform {
  public:
    explicit Uniform(std::uint32_t seed) : state_(mixed(seed ^ 0x9e3779b9u)) {}
    float operator()() { return static_cast<float>(mixed(state_ += 0x9e3779b9u) >> 8) * 0x1p-24f; }
    float operator()(float low, float high) { return low + (high - low) * (*this)(); }

  private:
    std::uint32_t state_;
};

/// Adds the octaves to `out`.
void add_noise(const LeafPoints& points, std::span<const Octave> octaves, const Detail& detail,
               LeafValues out);

/// The same, but gives up and returns false as soon as no value can end above 0.
bool add_noise_above_zero(const LeafPoints& points, std::span<const Octave> octaves,
                          const Detail& detail, LeafValues out);

/// Adds to each coordinate of `moved` noise of its own, looked up at `points`.
void add_warp(const LeafPoints& points, const Octave& octave, const Detail& detail,
              LeafPoints& moved);

/// Mean of humps of amplitude 1 (0.569 over 2 million points). It is taken off, so that finer
/// octaves leave the mass as it is.
inline constexpr float kHumpMean = 0.57f;

/// The most that an octave adds.
constexpr float reach_of(const Octave& octave) {
    return octave.amplitude * (octave.noise == Noise::humps ? 1 - kHumpMean : 1);
}
constexpr float reach_of(std::span<const Octave> octaves) {
    float sum = 0;
    for (const Octave& octave : octaves) sum += reach_of(octave);
    return sum;
}

}  // namespace vog::sampling
