// vog/sample.h: volumes and particles from nothing: deterministic procedural inputs for demos,
// tests and benches.
#pragma once

#include <cstdint>
#include <vector>

#include "vog/points.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

struct SampleOptions {
    int size = 128;  ///< voxels across the longest axis, 64 to 1024
    std::uint32_t seed = 1;
    Progress progress{};
};

/// A cumulus: soft irregular boundary, many partly filled leaves, constant core as active tiles.
/// World extent about 1 unit, whatever the size. The same bytes for any number of threads.
/// throws vog::Error if size is out of range
[[nodiscard]] Volume sample_cloud(const SampleOptions& options = {});

/// An expanding fireball with a turbulent shell, hollow towards the centre.
[[nodiscard]] Volume sample_explosion(const SampleOptions& options = {});

/// A small universe on three nested levels, coarsest first, named density_L0 to density_L2: halos
/// and the filaments between them refined in blocks, two to one. `size` counts the cells across of
/// the finest level, whose world extent is 1 unit. Cells under a finer block are there too.
[[nodiscard]] std::vector<Volume> sample_levels(const SampleOptions& options = {});

struct ParticleSampleOptions {
    int size = 40;  ///< particles along an edge of the lattice they come from, 8 to 512
    std::uint32_t seed = 1;
    Progress progress{};
};

/// size^3 particles of a box of a universe, 100 units wide, with velocities: walls, filaments, and
/// halos where they meet. The same bytes for any number of threads.
/// throws vog::Error if size is out of range
[[nodiscard]] Points sample_particles(const ParticleSampleOptions& options = {});

}  // namespace vog
