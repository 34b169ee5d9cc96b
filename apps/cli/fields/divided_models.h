// divided_models.h: models whose parts lie on several ranks of vog-mpi, and pictures of all parts.
#pragma once

#include "shared/render_run.h"
#include "vog/field_maps.h"
#include "vog/volume_picture.h"

namespace vog::cli {

/// throws  CLI::ValidationError where several ranks hold parts of inputs whose pictures do not add
void require_addable(const RenderArguments& arguments, const Drawing& drawing,
                     const RenderRanks& ranks);

/// Reads this rank's part of a model, or all of it; ranges of its fields, box and count of the drawing are those of
/// all parts.
/// hierarchy  of a single process: receives the model's; null: not read
Gaussians load_model_part(const RenderArguments& arguments, Drawing& drawing,
                          const RenderRanks& ranks, Hierarchy* hierarchy = nullptr);

/// Maps of all parts from maps of each, on the root: columns add, means and deviations by the columns.
void join_maps(FieldMaps& maps, const RenderRanks& ranks);

}  // namespace vog::cli
