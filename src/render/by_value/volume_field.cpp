// volume_field.cpp: The field of a volume picture, by name.
#include "render/by_value/volume_field.h"

#include "vog/error.h"
#include "vog/field_maps.h"

namespace vog::by_value {

const ScalarField& volume_field(const Gaussians& gaussians, const std::string& name) {
    if (const ScalarField* field = gaussians.fields.find_scalar(name)) return *field;
    const FieldChoice choice = field_choice(name, gaussians.fields);  // throws for unknown names
    throw Error("field '" + choice.field + "': a vector field, expected a scalar one");
}

}  // namespace vog::by_value
