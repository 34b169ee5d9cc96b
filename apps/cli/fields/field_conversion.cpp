// field_conversion.cpp: --field of vog convert.
#include "fields/field_conversion.h"

#include "fields/volume_fields.h"
#include "vog/convert_fields.h"

namespace vog::cli {

void check_fields(const ConvertArguments& arguments, FileKind kind) {
    if (arguments.fields.empty()) return;
    if (arguments.no_fields)
        throw CLI::ValidationError("--field and --no-fields exclude each other");
    if (kind == FileKind::points)
        throw CLI::ValidationError("--field does not go with particles yet: expected volumes");
}

void add_fields_of(const ConvertArguments& arguments, const MomentOptions& moments,
                   std::vector<Volume>& volumes, Gaussians& model, std::vector<std::string>& notes,
                   const Progress& progress) {
    const std::vector<std::vector<VoxelField>> fields =
        read_volume_fields({arguments.fields, arguments.volume.grid, true}, volumes, notes);
    FieldOptions options;
    const bool hard = arguments.method == "moments" && moments.block_voxels &&
                      moments.soft_steps == 0 && moments.refine_seconds == 0 && volumes.size() == 1;
    if (hard) options.shares = FieldShares::cells, options.block_voxels = moments.block_voxels;
    options.progress = progress;
    add_fields(model, volumes, fields, options);
}

}  // namespace vog::cli
