// level_volumes.h: nested cubes of voxels of constant density, at any ratio and offset of lattices.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "support/moment_volumes.h"
#include "vog/levels.h"

namespace vog::test {

/// Placement of a level in the next coarser one.
struct Nesting {
    double ratio = 2;            ///< coarse voxel edge / fine voxel edge
    Vec3d lower{4.5, 4.5, 4.5};  ///< lower corner, index of the coarse level
    int across = 16;             ///< voxels along each edge
};

/// Cube of `across`^3 voxels of one density, from index 0 on.
inline Volume cube_of(int across, float density, const Affine& world_from_index) {
    VolumeMaker maker;
    maker.volume.world_from_index = world_from_index;
    maker.box({0, 0, 0}, {across - 1, across - 1, across - 1}, density);
    return maker.finish();
}

/// World from index of a level with the lower corner of voxel 0 at `lower` of the outer index
/// space.
inline Affine nested_map(const Affine& outer, double ratio, Vec3d lower) {
    Affine map;
    for (Vec3d& row : map.linear.row) row = (1 / ratio) * row;
    const double half = 0.5 / ratio;
    map.translation = lower + Vec3d{half, half, half};
    return {outer.linear * map.linear, outer(map.translation)};
}

/// A coarsest cube with transform `outer`, and levels that are each nested in the one before.
inline Levels nested_cubes(int across, const Affine& outer, const std::vector<Nesting>& inner,
                           float density = 0.7f) {
    Levels levels;
    levels.volumes.push_back(cube_of(across, density, outer));
    for (const Nesting& nesting : inner)
        levels.volumes.push_back(cube_of(
            nesting.across, density,
            nested_map(levels.volumes.back().world_from_index, nesting.ratio, nesting.lower)));
    return levels;
}

/// A rotation with a uniform scale.
inline Affine turned_map() {
    const Mat3 turn = matrix_from_quat({0.8f, 0.2f, -0.4f, 0.4f});
    return {{{0.5 * turn.row[0], 0.5 * turn.row[1], 0.5 * turn.row[2]}}, {3, -1, 2}};
}

/// Parameters of nested levels.
struct NestedScene {
    std::string name;
    Affine outer;
    std::vector<Nesting> inner;
    bool parallel = true;  ///< lattices are parallel, so that composite() is exact
    bool fits = true;      ///< voxels are divided evenly by finer ones
};

inline void PrintTo(const NestedScene& scene, std::ostream* out) { *out << scene.name; }

/// Three levels from 20^3 voxels on: ratios 2, 3, 4 and odd ones; aligned or off by parts of a
/// voxel; along the world axes or rotated.
inline std::vector<NestedScene> nested_scenes() {
    const Vec3d inside{4.5, 3.5, 5.5},
        cutting{4.5 + 0.5 * 0.37, 3.5 + 0.5 * 0.61, 5.5 + 0.5 * 0.11};
    const std::vector<Nesting> twos{{2, inside, 18}, {2, inside, 16}};
    const std::vector<Nesting> fours{{4, inside, 32}, {4, inside, 40}};
    const std::vector<Nesting> threes{{3, inside, 21}, {3, inside, 24}};
    const std::vector<Nesting> half_way{{2, {4, 3, 5}, 17}, {2, {4, 3, 5}, 13}};
    const std::vector<Nesting> cut_twos{{2, cutting, 17}, {2, cutting, 15}};
    const std::vector<Nesting> cut_fours{{4, cutting, 31}, {4, cutting, 33}};
    const std::vector<Nesting> odd_ratio{{2.6, cutting, 21}, {1.7, cutting, 15}};
    const Affine plain{{}, {0.25, 0, -3}}, turned = turned_map();
    return {{"ratio_2", plain, twos},
            {"ratio_4", plain, fours},
            {"ratio_3", plain, threes},
            {"half_a_coarse_voxel_off", plain, half_way},
            {"ratio_2_unaligned", plain, cut_twos, true, false},
            {"ratio_4_unaligned", plain, cut_fours, true, false},
            {"odd_ratio_unaligned", plain, odd_ratio, true, false},
            {"ratio_2_turned", turned, twos},
            {"ratio_4_turned", turned, fours},
            {"ratio_2_unaligned_turned", turned, cut_twos, true, false},
            {"ratio_4_unaligned_turned", turned, cut_fours, true, false}};
}

}  // namespace vog::test
