// mesh.h: meshes of Conduit (Blueprint), which Ascent and Catalyst 2 pass, as data of vog.
//
// Ascent:      the node of ascent.publish(mesh)
// Catalyst 2:  conduit::cpp_node(params)["catalyst/channels/NAME/data"] in catalyst_execute(params)
#pragma once

#include <conduit.hpp>
#include <span>
#include <string>
#include <vector>

#include <vog/vog.h>

namespace conduit_mesh {

/// Gaussians of a mesh.
/// mesh     one domain or several: uniform, rectilinear, structured or unstructured, of tetrahedra, hexahedra, wedges and pyramids, also mixed
/// density  name of a scalar field >= 0, of the elements or of the vertices
/// fields   names of further fields, scalars and vectors of any sign. Without any, elements of uniform domains are voxels: domains of one spacing
///          are parts of a level, those of other spacings finer and coarser levels, of which the finest counts
/// budget   largest number of Gaussians
/// Elements that ascent_ghosts or vtkGhostType mark do not count. Arrays of float are not copied where the domains are voxels.
/// throws   vog::Error for what a mesh lacks, for other elements, and for levels with further fields
vog::Gaussians convert(const conduit::Node& mesh, const std::string& density,
                       std::span<const std::string> fields, std::size_t budget);

/// The same as cells of any shape.
vog::Cells cells_of(const conduit::Node& mesh, const std::string& density,
                    std::span<const std::string> fields);

/// Elements of uniform domains as levels, of which the finest counts.
vog::Levels levels_of(const conduit::Node& mesh, const std::string& density);

}  // namespace conduit_mesh
