// splat_models.cpp: the reader of a file of splats by its extension.
#include "io/exchange/splat_models.h"

#include <fmt/core.h>

#include "io/exchange/splat_density.h"
#include "io/file_extension.h"
#include "vog/error.h"

namespace vog::exchange {

bool is_splats(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".spz" || extension == ".glb";
}

Gaussians read_splats(const std::filesystem::path& file) {
    const bool spz = lower_extension(file) == ".spz";
    Gaussians model = spz ? read_spz(file) : read_glb(file);
    model.cutoff = kSplatCutoff;
    model.method = spz ? "SPZ" : "glTF splats";
    model.source = file.filename().string();
    try {
        validate(model);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
    return model;
}

}  // namespace vog::exchange
