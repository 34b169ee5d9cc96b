// vog/sample.h: procedural volumes and particles, as inputs for demos, tests and benches.
#pragma once

#include <cstdint>
#include <vector>

#include "vog/points.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

/// Options of the volume samples. Each gives the same bytes for any number of threads.
struct SampleOptions {
    int size = 128;          ///< voxels along an edge of the sampled cube, 64 to 1024
    std::uint32_t seed = 1;  ///< any number; another one gives another shape
    Progress progress{};     ///< called with the finished fraction; empty: not
};

/// Cumulus cloud, density (0.01, 1]: soft irregular boundary, many partly filled leaves, a constant
/// core of active tiles. Voxel edge 1 / size world units, so the extent is about 1 for any size.
/// throws  vog::Error if size is out of range
[[nodiscard]] Volume sample_cloud(const SampleOptions& options = {});

/// Expanding fireball, density (0.01, 1.04]: a turbulent shell around a hollow of density 0.04.
/// Voxel edge 1 / size world units.
/// throws  vog::Error if size is out of range
[[nodiscard]] Volume sample_explosion(const SampleOptions& options = {});

/// The explosion with its temperature: grids `density` of sample_explosion and `temperature`, K, of the same voxels, about
/// 1,900 in the thin gas of the core, 400 in the cold smoke.
/// throws  vog::Error if size is out of range
[[nodiscard]] std::vector<Volume> sample_fire(const SampleOptions& options = {});

/// Computed tomography of a head: grid `ct` of Hounsfield units + 1000 (air 0, water 1000, bone 1700 to 2100), with skull,
/// brain, ventricles, a lesion, calcium, eyes and an air-filled sinus. World units are mm, x to the left, y to the front,
/// z up; voxels of 240 / size mm.
/// throws  vog::Error if size is out of range
[[nodiscard]] Volume sample_head(const SampleOptions& options = {});

/// Adaptive mesh of a small universe in the world cube [-1/2, 1/2]^3: three nested levels, coarsest
/// first, named density_L0 to density_L2, each of half the voxel edge of the one before. Halos and
/// the filaments between them are refined in blocks; coarse voxels under a finer block are kept.
/// `size` counts the finest voxels along an edge of the cube.
/// throws  vog::Error if size is out of range
[[nodiscard]] std::vector<Volume> sample_levels(const SampleOptions& options = {});

/// Options of sample_particles.
struct ParticleSampleOptions {
    int size = 40;           ///< cube root of the number of particles, 8 to 512
    std::uint32_t seed = 1;  ///< any number; another one gives another universe
    Progress progress{};     ///< called with the finished fraction; empty: not
};

/// Particles of a cosmological box, size^3 of them: walls, filaments, and halos where they meet.
/// Positions in [0, 100] world units, as Mpc/h; velocities as km/s, root mean square 300. The same
/// bytes for any number of threads.
/// throws  vog::Error if size is out of range
[[nodiscard]] Points sample_particles(const ParticleSampleOptions& options = {});

}  // namespace vog
