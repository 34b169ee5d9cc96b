// sampled_fields.h: fields of Python calls at the voxels of their data.
#pragma once

#include <string>
#include <vector>

#include "data.h"
#include "vog/voxel_field.h"

namespace vog::python {

/// fields=False: not even the data's own values.
inline bool no_fields(const py::object& fields) { return fields.is(py::bool_(false)); }

/// Fields at the voxels of a Volume, or of the visible parts of Levels.
struct SampledFields {
    std::vector<Volume> volumes;                  ///< tiles inside which a field varies are divided
    std::vector<std::vector<VoxelField>> values;  ///< [fields][volumes]
};
/// Samples `fields` of a call, and the data's own values unless one has their name, before any other work: errors
/// come early.
/// fields  None: the own values alone; False: nothing
SampledFields sampled_fields(const py::object& data, const py::object& fields, const char* call);

/// Part of a Volume by the labels at its voxels.
struct LabelledPart {
    py::object volume, label;  ///< Volumes of its voxels: the data, and the label at each
    double share = 0;          ///< of the voxels
};
/// Parts with mass, in the order of their labels.
/// labels  whole numbers, as a field of `fields`; 0 beyond them
/// throws  vog::Error for other numbers, and without mass
std::vector<LabelledPart> labelled_parts(const py::object& data, const py::object& labels,
                                         const char* call);

/// The mapping with the one of `fields` that has a name or whose part it is: "velocity.x".
/// throws  vog::Error where there is none
py::dict one_field(const py::object& fields, const std::string& name, const std::string& call);

}  // namespace vog::python
