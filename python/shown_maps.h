// shown_maps.h: maps of a field as vog.render returns them.
#pragma once

#include <string>

#include "bindings.h"
#include "vog/field_maps.h"

namespace vog::python {

/// Maps of a field, one of which is shown.
struct ShownMaps {
    FieldMaps maps;
    std::string show;  ///< "column", "mean" or "deviation"
    std::string name;  ///< of the shown number: "velocity along the view"
    std::string unit;  ///< of the field; empty: not known

    const std::vector<float>& shown() const {
        return show == "column" ? maps.column : show == "mean" ? maps.mean : maps.deviation;
    }
};

}  // namespace vog::python
