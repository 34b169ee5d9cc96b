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

void add_fields_of(const FieldTexts& texts, const std::optional<UniformCells>& cells,
                   std::span<Volume> volumes, Gaussians& model, std::vector<std::string>& notes) {
    if (model.size() == 0) return;
    const auto fields = read_volume_fields(texts, volumes, notes);
    add_fields(model, volumes, fields, {cells});
}

}  // namespace vog::cli
