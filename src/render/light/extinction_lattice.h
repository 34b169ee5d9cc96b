// extinction_lattice.h: Extinction of a model, voxels or cells under a transfer function, averaged over the cells of a lattice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/by_value/light_of_moments.h"
#include "vog/cells.h"
#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/value_transfer.h"
#include "vog/voxel_field.h"

namespace vog {
struct Collective;
}

namespace vog::lights {

/// Averages over cubic cells along the world's axes.
struct ExtinctionLattice {
    Vec3d first{};            ///< centre of the first cell, world units
    double edge = 1;          ///< of a cell, world units
    int cells = 1;            ///< along the longest edge of the box
    Vec3i size{};             ///< cells along each axis, at least 4
    std::vector<double> sum;  ///< [size.z][size.y][size.x] extinction, 1 / world unit
    /// [cells] the same without what clear matter beside opaque matter lets pass; empty: that is `sum`
    std::vector<double> whole{};
    bool surfaces = false;  ///< whether matter under has_surface() was added

    /// Lattice around a box, with two cells of empty space on each side.
    /// most_cells  along the longest edge of the box
    ExtinctionLattice(const Box& box, int most_cells);

    std::size_t at(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size.x) +
               static_cast<std::size_t>(x);
    }
    /// Empties the cells whose centres a clip cuts off.
    void clip(const Clipping& clip);
};

/// Adds a model: moments of its values in each cell, classified as those of a picture's slabs.
/// light      of the field's values
/// unit       factor of the light
/// processes  that hold parts of the model; null: this one alone
void add_extinction(const Gaussians& gaussians, const ScalarField& field,
                    const by_value::LightOfMoments& light, double unit, const Collective* processes,
                    ExtinctionLattice& lattice);
/// Adds voxels of constant value, to a lattice without models.
/// field  scalar; without values the volume's own
void add_extinction(const Volume& volume, const VoxelField& field, const ValueTransfer& transfer,
                    ExtinctionLattice& lattice);

/// Adds cells of any shape, to a lattice without models.
/// kept    those with mass
/// values  scalar, of the cells; their density itself: its extinction is not weighed by density
void add_extinction(const Cells& cells, std::span<const std::uint32_t> kept,
                    const CellValues& values, const ValueTransfer& transfer,
                    ExtinctionLattice& lattice);

}  // namespace vog::lights
