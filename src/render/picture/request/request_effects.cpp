// request_effects.cpp: Members of a request that would change nothing are refused, by the table of members.
#include "render/picture/request/request_effects.h"

#include <iterator>
#include <sstream>

#include "render/picture/request/request_member.h"
#include "vog/picture_record.h"

namespace vog {

namespace {

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}
bool has(const std::string& words, const std::string& one) {
    return words.empty() || std::ranges::count(words_of(words), one) > 0;
}
/// "'splat', 'trace' or 'optix'"
std::string listed(const std::string& words) {
    const std::vector<std::string> all = words_of(words);
    std::string text;
    for (std::size_t n = 0; n < all.size(); ++n)
        text += (n == 0 ? "'" : n + 1 < all.size() ? ", '" : " or '") + all[n] + "'";
    return text;
}

/// Whether a member is not at its default.
bool is_stated(const requests::Entry& entry, const PictureRequest& request) {
    static const PictureRequest unset;
    return entry.values.write(request) != entry.values.write(unset);
}

}  // namespace

void require_effects(const PictureRequest& request) {
    const std::string show = word_of(request.show);
    const auto refuse_beside = [&](const char* key, const std::string& other) {
        if (is_stated(requests::entry_of(key), request))
            throw RequestError(key, " has no effect " + other);
    };
    for (const requests::Entry& entry : requests::entries())
        if (!has(entry.schema.shows, show) && is_stated(entry, request))
            throw RequestError(entry.schema.key,
                               fmt::format(" has no effect on show '{}', expected {}", show,
                                           fmt::join(words_of(entry.schema.shows), ", ")));
    if (request.fit == ScaleFit::symmetric &&
        (is_depth(request.show) || request.show == Show::volume))
        refuse_beside("scale", fmt::format("as 'symmetric' on show '{}'", show));
    const TransferRequest& transfer = request.transfer;
    if (transfer.window && !transfer.bands.empty()) refuse_beside("window", "beside bands");
    if (transfer.window || !transfer.bands.empty())
        for (const char* key : {"tf", "range", "scale"})
            refuse_beside(key, "beside window and bands, which state colours and values");
    if (is_by_value(request.show) && request.renderer && *request.renderer != Renderer::trace &&
        *request.renderer != Renderer::optix)
        refuse_beside("aabb_sigma", fmt::format("on show '{}' with renderer '{}'", show,
                                                info_of(*request.renderer).name));
    const VolumeLook& look = request.look;
    if (!look.is_lit())
        refuse_beside("light_weights", "without `light`, `shadows` or `ambient_occlusion`");
    if (!look.shadows && !look.studio)
        for (const char* key : {"light_from", "scattering"})
            refuse_beside(key, "without `shadows`");
    if (request.renderer) require_renderer_effects(request, *request.renderer, {});
}

void require_renderer_effects(const PictureRequest& request, Renderer renderer,
                              std::optional<RenderInput> input) {
    const RenderOptions& options = request.options;
    for (const requests::Entry& entry : requests::entries()) {
        const std::string &key = entry.schema.key, &names = entry.schema.renderers;
        if (!has(names, info_of(renderer).name) && is_stated(entry, request))
            throw RequestError(key, fmt::format(" is not for renderer '{}', expected {}",
                                                info_of(renderer).name, listed(names)));
        // Renderers of both models and voxels have members that are for models alone.
        if (input && *input != RenderInput::gaussians &&
            !has(names, info_of(Renderer::reference).name) && is_stated(entry, request))
            throw RequestError(key, " is for Gaussians, not for voxels");
    }
    if (options.voxels.step_voxels != VoxelGridOptions{}.step_voxels &&
        options.voxels.interpolation != Interpolation::linear)
        throw RequestError("step", " needs interpolation 'linear'");
    if (options.trace.hits_per_slab != TraceOptions{}.hits_per_slab &&
        options.trace.anyhit != AnyHit::collect)
        throw RequestError("hits_per_slab", " needs anyhit 'collect'");
    if (options.pixel_error && options.aabb_sigma > 0)
        throw RequestError("pixel_error", " has no effect beside `aabb_sigma`");
}

}  // namespace vog
