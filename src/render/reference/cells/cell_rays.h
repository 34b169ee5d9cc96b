// cell_rays.h: Ground truth of meshes: exact chords of rays through the tetrahedra of each cell (vog/cells.h), in which values are linear.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "data/cells/cell_moments.h"
#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference.h"
#include "vog/cells.h"

namespace vog::reference {

using unstructured::CellPoint;

/// Piece of a ray in a tetrahedron of a cell.
struct CellPiece {
    Segment segment;
    std::uint32_t cell = 0;
    /// At the ends, linear between; densities are below 0 in the inverted parts of a tangled cell.
    CellPoint first{}, last{};

    /// share  of the way from the first end to the last, [0, 1]
    CellPoint at(double share) const;
};

/// Cells prepared for rays: Embree's bounding volume hierarchy.
class CellRays {
  public:
    /// cells  must outlive it
    /// kept   those that count, with corners and densities that are finite; negative densities count as 0
    CellRays(const Cells& cells, std::span<const std::uint32_t> kept);
    ~CellRays();
    /// Appends the pieces on a ray, in any order.
    /// values  of the field at their ends; null: none
    void add(Vec3d origin, Vec3d direction, Segment within, std::vector<CellPiece>& pieces,
             const CellValues* values = nullptr) const;
    const Cells& cells() const;
    std::span<const std::uint32_t> kept() const;
    /// World units: half of the diagonal of the box of all points.
    double radius() const;

  private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
};

/// Optical depth T per pixel at extinction 1.
/// returns  within 1e-6 relative of the exact sum; the same bytes for any number of threads
DepthImage render_cells_reference(const CellRays& rays, const Camera& camera, int width, int height,
                                  const ReferenceOptions& options = {});

}  // namespace vog::reference
