// vog/cells.h: cells of any shape, as meshes of VTK have them: tetrahedra, hexahedra, wedges, pyramids, thin shells.
// A cell is divided into tetrahedra: about the mean of its corners, and a face of four corners about the mean of these, so that
// two cells agree on a face that they share. Between corners values are linear in each tetrahedron, and so linear data are exact.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/subject.h"

namespace vog {

/// Values at the points of a mesh or in its cells.
struct CellValues {
    std::string name;                           ///< "temperature"
    std::string unit{};                         ///< "K"; empty: not known
    std::vector<BigVector<float>> component{};  ///< 1: scalar, 3: vector, along the world's axes
    bool at_points = false;  ///< [points] linear between; else [cells] constant in each
};

/// Mesh of cells. Types are VTK's: 5 triangle, 8 pixel, 9 quad, 10 tetrahedron, 11 voxel, 12 hexahedron, 13 wedge, 14 pyramid; corners in
/// VTK's order.
struct Cells {
    BigVector<Vec3d> points;          ///< world units
    BigVector<std::uint32_t> corner;  ///< points of the cells, one cell after another
    BigVector<std::uint64_t> end;     ///< [cells] index in `corner` behind a cell's last
    BigVector<std::uint8_t> type;     ///< [cells]
    CellValues density;               ///< scalar, >= 0
    std::vector<CellValues> fields;   ///< values of any sign; names differ
    double thickness = 0;  ///< thickness of triangles and quads, world units; 0: they are left out
    std::string source;    ///< file of origin; empty: none
    Units units{};         ///< as the file states them

    std::size_t size() const { return type.size(); }
};

/// Number of corners of a type of cells; 0: none of those above.
int corner_count(int type);

/// Cells that add nothing.
struct CellNotes {
    std::uint64_t inverted =
        0;  ///< with the corners in the order of a mirrored cell: they count as the others
    std::uint64_t flat = 0;       ///< without volume, and so without mass
    std::uint64_t nonfinite = 0;  ///< with a corner or a value that is not finite
    std::uint64_t others =
        0;  ///< cells of other types: points, lines, surfaces without a thickness
};
/// Notes in words, one line: "a.vtu: of 800 cells 3 flat, 1 not finite left out, 2 inverted"; empty: nothing to say.
std::string notes_text(const CellNotes& notes, const Cells& cells);

/// Cells with mass, of a mesh.
struct CellSource {
    std::shared_ptr<const Cells> cells;
    BigVector<std::uint32_t> kept;  ///< their numbers
};

/// Box of all finite points, world units.
Box bounds(const Cells& cells);
/// Checks the lengths of the arrays, and corners against the number of points.
/// throws  vog::Error naming the source and the first offence
void validate(const Cells& cells);

}  // namespace vog
