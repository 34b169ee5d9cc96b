// field_error.cpp: maps of a field of voxels and of a model, and the largest difference.
#include "compare/values/field_error.h"

#include <algorithm>

#include "render/reference/reference.h"
#include "render/splat/fields/field_splat.h"
#include "vog/compare_maps.h"

namespace vog::comparison {

double field_error(std::span<const Volume> volumes, std::span<const VoxelField> field,
                   const Gaussians& model, std::span<const Camera> views) {
    constexpr int kSize = kFieldErrorSize_px;
    const FieldChoice choice = field_choice(field.front().name, model.fields);
    double worst = 0;
    for (const Camera& view : views) {
        const FieldMaps reference =
            render_field_reference(volumes, field, choice.part, view, kSize, kSize);
        if (std::ranges::none_of(reference.column, [](float column) { return column > 0; }))
            continue;
        const FieldMaps maps = render_field_splat(model, choice, view, kSize, kSize);
        worst = std::max(worst, compare(reference, maps).mean_l2);
    }
    return worst;
}

}  // namespace vog::comparison
