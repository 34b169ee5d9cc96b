// vog/convert_cells.h: conversion of cells of any shape to Gaussians, without a grid between.
// A cell is a mass distribution with mass, mean and covariance in closed form. Gaussians overlap and share cells, as those of voxels share
// these (vog/convert_moments.h): windows over boxes that hold several cells, then steps of expectation-maximisation. Mass, mean, covariance
// and joint moments of the whole stay exact.
#pragma once

#include <cstddef>
#include <memory>

#include "vog/cells.h"
#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/progress.h"
#include "vog/scene.h"

namespace vog {

/// Options of convert_cells: a budget, an error, or neither.
struct CellOptions {
    std::size_t budget = 0;  ///< largest number of Gaussians; 0: no
    /// Largest measured error, (0, 1), with the fewest Gaussians: relative L2 of T beside exact chords through the cells. 0 without a budget:
    /// kDefaultError, but at most default_count of the cells.
    double error = 0;
    bool measure = false;        ///< report the measured error of a budget too
    bool clip_negative = false;  ///< set negative densities to 0, which are an error otherwise
    bool own_field = true;       ///< carry the density itself as a field
    Progress progress{};         ///< called with the finished fraction; empty: not
};

/// Converts cells to Gaussians truncated at kMomentCutoff, whose masses sum to that of the cells, with all fields.
/// notes   receives the numbers of bad cells; null: not reported
/// report  receives the results; null: not reported
/// throws  vog::Error as validate does, for negative densities (their number and the first cell), for options out of range, and if no cell
///         has mass
/// cost    4 us a tetrahedron at 2 %, 8 us with one Gaussian each, parallel
[[nodiscard]] Gaussians convert_cells(const Cells& cells, const CellOptions& options = {},
                                      CellNotes* notes = nullptr, MomentReport* report = nullptr);

/// Scene of cells, which the reference draws exactly, with all their fields and the density.
/// throws  vog::Error as convert_cells does
[[nodiscard]] Scene scene_of(std::shared_ptr<const Cells> cells, CellNotes* notes = nullptr);

}  // namespace vog
