// trace_field.h: A shown field on the Gaussians of a packed model.
#pragma once

#include <vector>

#include "render/device/field_hit.h"
#include "render/shown_field.h"

namespace vog::trace {

/// A field on the Gaussians of a model, in scene units: one of the arrays.
struct TraceField {
    std::vector<device::ScalarPlane> scalar;
    std::vector<device::VectorPlane> vector;  ///< of which the component along the ray counts
};
/// The field with gradients per scene unit.
/// size  number of Gaussians
TraceField trace_field(const ShownField& shown, std::size_t size, double scene_unit);

}  // namespace vog::trace
