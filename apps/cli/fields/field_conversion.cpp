// field_conversion.cpp: --field of vog convert.
#include "fields/field_conversion.h"

namespace vog::cli {

void check_fields(const ConvertArguments& arguments, FileKind kind) {
    if (arguments.fields.empty()) return;
    if (arguments.no_fields)
        throw CLI::ValidationError("--field and --no-fields exclude each other");
    if (kind == FileKind::points && !arguments.output.ends_with(".ply"))
        throw CLI::ValidationError(
            "--field does not go with unconverted particles: expected -o "
            "model.ply");
}

FieldTexts field_texts(const ConvertArguments& arguments, const std::string& own) {
    return {arguments.fields, arguments.volume.grid, arguments.inputs, arguments.volume.ones, own};
}

FieldOptions field_options(const VolumeConversion& conversion, std::size_t volumes) {
    const MomentOptions& moments = conversion.moments;
    const bool hard = conversion.by_moments && moments.block_voxels && moments.soft_steps == 0 &&
                      moments.refine_seconds == 0 && volumes == 1;
    if (!hard) return {};
    return {FieldShares::cells, moments.block_voxels};
}

void add_fields_of(const FieldTexts& texts, const VolumeConversion& conversion,
                   std::span<Volume> volumes, Gaussians& model, std::vector<std::string>& notes) {
    if (model.size() == 0) return;
    const auto fields = read_volume_fields(texts, volumes, notes);
    add_fields(model, volumes, fields, field_options(conversion, volumes.size()));
}

}  // namespace vog::cli
