// fields.cpp: look-up of fields by name.
#include "vog/fields.h"

#include "vog/error.h"

namespace vog {

const ScalarField* Fields::find_scalar(const std::string& name) const {
    for (const ScalarField& field : scalar)
        if (field.name == name) return &field;
    return nullptr;
}

const VectorField* Fields::find_vector(const std::string& name) const {
    for (const VectorField& field : vector)
        if (field.name == name) return &field;
    return nullptr;
}

}  // namespace vog
