// value_inputs.h: models and volumes with a scalar field, for pictures by value and maxima.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fields/divided_volumes.h"
#include "shared/render_run.h"
#include "vog/picture.h"

namespace vog::cli {

/// Inputs with a scalar field.
struct ValueInputs {
    Drawing drawing;                           ///< for views and reports, not for drawing T
    std::string label;                         ///< of the field
    std::string unit;                          ///< of the field
    ValueData data;                            ///< of all ranks
    std::shared_ptr<const Gaussians> model{};  ///< or
    std::shared_ptr<const PartsWithField> volumes{};
};
/// The field of this name, else the model's density, else its only scalar field.
/// input, show  file and quantity, for messages
/// throws       vog::Error naming the fields there are, and how to make one
const ScalarField& scalar_field_of(const Fields& fields, const std::string& name,
                                   const std::string& input, const std::string& show);

/// Reads the inputs with the field of --field, or their own values.
/// throws  vog::Error for inputs without it; CLI::ValidationError for options without effect
ValueInputs load_values(const RenderArguments& arguments, const CLI::App& command,
                        const RenderRanks& ranks);

}  // namespace vog::cli
