// volume_field.h: The field of a volume picture.
#pragma once

#include <string>

#include "vog/gaussians.h"

namespace vog::by_value {

/// The scalar field of this name.
/// throws  vog::Error naming the fields of a model that lacks it
const ScalarField& volume_field(const Gaussians& gaussians, const std::string& name);

}  // namespace vog::by_value
