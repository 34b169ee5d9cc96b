// noise.h: lattice noise, evaluated at the 512 voxel centres of a leaf at once.
// Sources: Perlin, "Improving Noise" (2002); Worley, "A Cellular Texture Basis Function" (1996).
//
// Float arithmetic, integer hashes and sqrt only: the same bits on every machine. Both noises are
// pure functions of position.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "vog/volume.h"

namespace vog::sampling {

/// World positions of a leaf's voxel centres, in the order of leaf_offset.
struct LeafPoints {
    alignas(64) std::array<float, kLeafVoxels> x, y, z;
};
using LeafValues = std::span<float, kLeafVoxels>;

/// Closed interval.
struct Interval {
    float lower = 0, upper = 0;
};
/// Smallest and largest of some values, whose number is a multiple of eight.
Interval interval_of(std::span<const float> values);

/// Kinds of noise.
enum class Noise {
    gradient,  ///< smooth, mean 0
    humps,  ///< round humps with sharp creases, mean near 0: maximum of paraboloids around one random
            ///< feature point per lattice cell
};

/// One band of noise.
struct Octave {
    Noise noise = Noise::gradient;
    float cell = 1;       ///< edge of a lattice cell, world units
    float amplitude = 1;  ///< bound of the absolute value
    std::uint32_t seed = 0;
};

/// Parameters that all octaves of a field share.
struct Detail {
    std::uint32_t seed = 0;  ///< combined with each octave's seed
    float voxel = 0;         ///< edge of a voxel, world units; finer octaves are left out
};

/// Integer hash, a bijection (lowbias32 of Chris Wellons).
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

/// Adds the octaves to `out`, but returns false as soon as no sum can exceed 0.
bool add_noise_above_zero(const LeafPoints& points, std::span<const Octave> octaves,
                          const Detail& detail, LeafValues out);

/// Adds independent noise, evaluated at `points`, to each coordinate of `moved`.
void add_warp(const LeafPoints& points, const Octave& octave, const Detail& detail,
              LeafPoints& moved);

/// Mean of humps of amplitude 1 (0.569 over 2 million points). Subtracted, so that octaves do not
/// change the mass.
inline constexpr float kHumpMean = 0.57f;

/// Upper bound of an octave, or of the sum of several.
constexpr float upper_bound_of(const Octave& octave) {
    return octave.amplitude * (octave.noise == Noise::humps ? 1 - kHumpMean : 1);
}
constexpr float upper_bound_of(std::span<const Octave> octaves) {
    float sum = 0;
    for (const Octave& octave : octaves) sum += upper_bound_of(octave);
    return sum;
}

}  // namespace vog::sampling
