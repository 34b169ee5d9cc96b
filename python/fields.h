// fields.h: fields of a model as Python objects.
#pragma once

#include "bindings.h"
#include "vog/gaussians.h"

namespace vog::python {

/// A mapping from the name of each field of a Gaussians object to its vog.Field.
py::object fields_of(const py::object& model);
/// Fields of N Gaussians from a mapping of names to vog.Field objects, or to dicts of their attributes; None: none.
/// throws  vog::Error for other shapes and unknown attributes
Fields fields_from(const py::object& fields, std::size_t size);
/// The mapping that fields_from takes, of plain dicts: for pickles.
py::dict plain_fields(const py::object& model);

}  // namespace vog::python
