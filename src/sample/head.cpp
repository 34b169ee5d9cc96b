// head.cpp: synthetic CT of a head: ellipsoids of tissues after Shepp and Logan, "The Fourier Reconstruction of a Head
// Section" (1974), with edges as wide as a voxel and the noise of a scanner.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "sample/noise.h"
#include "vog/error.h"
#include "vog/sample.h"

namespace vog {

using namespace sampling;

namespace {

/// Edge of the sampled cube, mm.
constexpr double kCube = 240;

/// A tissue inside an ellipsoid, mm; x to the left, y to the front, z up.
struct Tissue {
    Vec3f center, radii;
    float value;          ///< Hounsfield units + 1000
    float turn_sine = 0;  ///< of the rotation about z
};

/// Skin and muscle: what lies in none of these is air.
constexpr float kMuscle = 1050;
constexpr std::array<Tissue, 7> kSkin = {{
    {{0, 0, 14}, {79, 98, 100}, kMuscle},    // skull
    {{0, 44, -58}, {50, 54, 46}, kMuscle},   // face and jaw
    {{0, -22, -98}, {46, 50, 70}, kMuscle},  // neck
    {{0, 99, -30}, {9, 12, 15}, kMuscle},    // nose
    {{0, 94, -62}, {20, 8, 7}, kMuscle},     // lips
    {{-80, -2, -14}, {6, 17, 23}, kMuscle},  // ears
    {{80, -2, -14}, {6, 17, 23}, kMuscle},
}};

/// Each replaces those before it.
constexpr std::array<Tissue, 19> kTissues = {{
    {{0, -26, -100}, {12, 12, 62}, 1650},          // spine
    {{0, -22, -100}, {6, 6, 62}, 1020},            // and its canal
    {{0, 26, -96}, {10, 9, 60}, 30},               // air of the throat
    {{0, 58, -74}, {38, 32, 13}, 1800},            // jaw
    {{0, 52, -70}, {30, 28, 16}, 1045},            // tongue
    {{0, 0, 16}, {74, 93, 94}, 2100},              // skull, outer table
    {{0, 0, 16}, {72.5f, 91.5f, 92.5f}, 1700},     // spongy bone
    {{0, 0, 16}, {69, 88, 89}, 2050},              // inner table
    {{0, 0, 16}, {67.5f, 86.5f, 87.5f}, 1036},     // brain
    {{0, 2, 20}, {42, 58, 56}, 1030},              // white matter
    {{-13, 6, 24}, {8, 27, 17}, 1008, 0.309017f},  // ventricles
    {{13, 6, 24}, {8, 27, 17}, 1008, -0.309017f},
    {{29, -42, 38}, {11, 11, 11}, 1075},         // a lesion
    {{29, -42, 38}, {6, 6, 6}, 1020},            // and its core
    {{-22, -20, -4}, {3.5f, 3.5f, 3.5f}, 1350},  // calcium
    {{-31, 84, -14}, {13, 14, 13}, 1015},        // eyes
    {{31, 84, -14}, {13, 14, 13}, 1015},
    {{0, 84, 6}, {15, 7, 11}, 50},    // air of the sinus
    {{0, 84, -32}, {7, 18, 16}, 50},  // and of the nose
}};

/// Noise of a scanner, and structures of tissue.
constexpr std::array<Octave, 2> kTexture = {
    {{Noise::gradient, 14, 7, 51}, {Noise::gradient, 3.5f, 9, 52}}};

/// Distance to an ellipsoid's surface, negative inside; to first order in the distance.
float distance(const Tissue& tissue, Vec3f point) {
    const Vec3f d = point - tissue.center;
    const float sine = tissue.turn_sine, cosine = std::sqrt(1 - sine * sine);
    const Vec3f p{cosine * d.x + sine * d.y, cosine * d.y - sine * d.x, d.z};
    const Vec3f u{p.x / tissue.radii.x, p.y / tissue.radii.y, p.z / tissue.radii.z};
    const Vec3f gradient{u.x / tissue.radii.x, u.y / tissue.radii.y, u.z / tissue.radii.z};
    const float at = std::sqrt(dot(u, u)), slope = std::sqrt(dot(gradient, gradient));
    return slope > 0 ? at * (at - 1) / slope
                     : -std::min({tissue.radii.x, tissue.radii.y, tissue.radii.z});
}

Leaf evaluated(Vec3i origin, const Affine& world_from_index, const Detail& detail) {
    LeafPoints points;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const Vec3i voxel = origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
        const Vec3f at = vec_cast<float>(world_from_index(vec_cast<double>(voxel)));
        const auto place = static_cast<std::size_t>(n);
        points.x[place] = at.x, points.y[place] = at.y, points.z[place] = at.z;
    }
    std::array<float, kLeafVoxels> texture{};
    add_noise(points, kTexture, detail, texture);
    Leaf leaf;
    leaf.origin = origin;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const auto place = static_cast<std::size_t>(n);
        const Vec3f point{points.x[place], points.y[place], points.z[place]};
        if (std::ranges::none_of(kSkin, [&](const Tissue& t) { return distance(t, point) <= 0; }))
            continue;
        float value = kMuscle;
        for (const Tissue& tissue : kTissues) {
            const float inside = 0.5f - distance(tissue, point) / detail.voxel;
            value += std::clamp(inside, 0.0f, 1.0f) * (tissue.value - value);
        }
        leaf.set(n, std::max(0.0f, value + texture[place]));
    }
    return leaf;
}

}  // namespace

Volume sample_head(const SampleOptions& options) {
    if (options.size < 64 || options.size > 1024)
        throw Error(fmt::format("sample head: size {}, expected 64 to 1024 voxels", options.size));
    Volume volume;
    volume.name = "ct";
    volume.standing.up = {0, 0, 1};
    volume.source = "sample head";
    const double voxel = kCube / options.size, first = 0.5 * voxel - 0.5 * kCube;
    volume.world_from_index = {{{Vec3d{voxel, 0, 0}, Vec3d{0, voxel, 0}, Vec3d{0, 0, voxel}}},
                               {first, first, first}};
    const Detail detail{options.seed, static_cast<float>(voxel)};
    const int leaves = (options.size + kLeafEdge - 1) / kLeafEdge;
    // A layer at a time, of which the empty leaves are left out.
    BigVector<Leaf> layer(static_cast<std::size_t>(leaves * leaves));
    for (int x = 0; x < leaves; ++x) {
        vog::parallel_for(std::size_t{0}, layer.size(), [&](std::size_t n) {
            const Vec3i place{x, static_cast<int>(n) / leaves, static_cast<int>(n) % leaves};
            layer[n] = evaluated(kLeafEdge * place, volume.world_from_index, detail);
        });
        for (const Leaf& leaf : layer)
            if (leaf.active_count() > 0) volume.leaves.push_back(leaf);
        if (options.progress) options.progress((x + 1.0) / leaves);
    }
    return volume;
}

}  // namespace vog
