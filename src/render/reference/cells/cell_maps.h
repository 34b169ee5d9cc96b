// cell_maps.h: Maps, largest values and slices of a field of cells, exactly: values are linear in each tetrahedron.
#pragma once

#include "render/reference/cells/cell_rays.h"
#include "render/reference/reference.h"
#include "render/slice/slice.h"
#include "vog/field_maps.h"
#include "vog/image.h"

namespace vog::reference {

/// As render_field_reference. part FieldPart::value for scalar fields, another for vector fields.
FieldMaps render_cells_fields(const CellRays& rays, const CellValues& values, FieldPart part,
                              const Camera& camera, int width, int height,
                              const ReferenceOptions& options);
/// As render_maximum_reference, of a scalar field.
ValueMap render_cells_maximum(const CellRays& rays, const CellValues& values, const Camera& camera,
                              int width, int height, const ReferenceOptions& options);
/// As slice_voxels.
/// values  null: the density alone
FieldMaps slice_cells(const CellRays& rays, const CellValues* values, FieldPart part,
                      const Camera& camera, int width, int height, const SliceOptions& options);

}  // namespace vog::reference
