// splat_models.cpp: the reader of a file of splats by its extension.
#include "io/exchange/splat_models.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "io/exchange/finite_splats.h"
#include "io/exchange/splat_density.h"
#include "io/file_extension.h"
#include "vog/error.h"

namespace vog::exchange {

bool is_splats(const std::filesystem::path& file) {
    constexpr const char* kExtensions[] = {".spz", ".glb", ".usda", ".usdc", ".usd"};
    return std::ranges::find(kExtensions, lower_extension(file)) != std::end(kExtensions);
}

Gaussians read_splats(const std::filesystem::path& file, const SplatRules& rules) {
    const std::string extension = lower_extension(file);
    const bool spz = extension == ".spz", glb = extension == ".glb";
    Gaussians model = spz ? read_spz(file) : glb ? read_glb(file) : read_usd(file);
    model.cutoff = kSplatCutoff;
    model.method = spz ? "SPZ" : glb ? "glTF splats" : "OpenUSD splats";
    model.source = file.filename().string();
    keep_finite(model, file.string(), rules);
    try {
        validate(model);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
    return model;
}

}  // namespace vog::exchange
