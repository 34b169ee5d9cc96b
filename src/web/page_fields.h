// page_fields.h: Names, ranges and histograms of a model's fields in the JSON of a page.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "vog/camera.h"
#include "vog/export_html.h"
#include "vog/fields.h"
#include "vog/gaussians.h"

namespace vog::web {

/// A field's numbers in the page: (value - reference) / unit.
struct PageUnit {
    double reference = 0, unit = 1;
};
/// Of a scalar field the middle of the data's range and half of it; of a vector field 0 and the largest magnitude.
PageUnit page_unit(const ScalarField& field);
PageUnit page_unit(const VectorField& field);

/// Fields of a model: names, units, ranges of their maps, histograms.
/// view  for the ranges of maps
nlohmann::ordered_json fields_json(const Gaussians& model, const Camera& view);

}  // namespace vog::web
