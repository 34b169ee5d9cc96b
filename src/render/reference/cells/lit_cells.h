// lit_cells.h: A field of cells under a transfer function as pieces of light, for volume pictures.
#pragma once

#include <vector>

#include "render/reference/cells/cell_rays.h"
#include "render/reference/fields/ray_light.h"

namespace vog::reference {

/// Values at points are linear in each tetrahedron and classified in up to 16 steps between two points of the transfer function; values of
/// cells are constant. Surfaces are shaded by the mean gradient of each cell.
class LitCells : public LitRays {
  public:
    /// values      scalar; the density itself: its extinction is not weighed by density
    /// reached     light at points of the world; all must outlive this
    LitCells(const CellRays& rays, const CellValues& values, const ValueTransfer& transfer,
             const VolumeLook& look, const lights::Illumination& reached);
    void add(Vec3d origin, Vec3d direction, Segment& within,
             std::vector<LitPiece>& pieces) const override;

  private:
    const CellRays& rays_;
    const CellValues& values_;
    bool own_;
    FieldLight light_;
    std::vector<Vec3f> gradient_;  ///< [cells] of the values; empty: not needed
};

}  // namespace vog::reference
