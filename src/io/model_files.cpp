// model_files.cpp: the format of a model's file, by its extension.
#include "vog/model_io.h"

#include <fmt/core.h>

#include <string>

#include "core/atomic_file.h"
#include "io/file_extension.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/ply.h"
#include "vog/vogz.h"

namespace vog {

namespace {

enum class Format { ply, vogz };

Format format_of(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".ply") return Format::ply;
    if (extension == ".vogz") return Format::vogz;
    throw Error(fmt::format("{}: extension '{}', expected .ply or .vogz (model)", file.string(),
                            extension));
}

}  // namespace

Gaussians read_model(const std::filesystem::path& file, Hierarchy* hierarchy) {
    require_readable(file);
    return format_of(file) == Format::ply ? read_ply(file, hierarchy) : read_vogz(file, hierarchy);
}

Gaussians read_model(const std::filesystem::path& file, const ModelPart& part) {
    require_readable(file);
    return format_of(file) == Format::ply ? read_ply(file, part) : read_vogz(file, part);
}

void write_model(const std::filesystem::path& file, const Gaussians& gaussians,
                 const Hierarchy& hierarchy) {
    if (format_of(file) == Format::ply)
        write_ply(file, gaussians, hierarchy);
    else
        write_vogz(file, gaussians, hierarchy);
}

}  // namespace vog
