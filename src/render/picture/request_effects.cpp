// request_effects.cpp: Which members of a request change the quantity that it shows.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "vog/picture_record.h"

namespace vog {

namespace {

/// Members that have an effect on some quantities alone.
struct Effect {
    const char *keys, *shows;
};
constexpr Effect kEffects[] = {
    {"field", "mean, deviation, volume, maximum"},
    {"range scale", "column, mean, deviation, volume, maximum"},
    {"window bands threshold unit_distance light light_weights", "volume"},
    {"units", "column, mean, deviation, maximum"},
    {"least_column", "mean, deviation"},
    {"extinction blend stop_transmittance", "T"},
    {"anyhit hits_per_slab", "T, column"},
    {"pixel_error", "T, column, mean, deviation"},
    {"slabs", "volume, maximum"},
};
bool names(const char* words, const std::string& one) {
    const std::string all = words;
    for (std::size_t at = 0; (at = all.find(one, at)) != std::string::npos; ++at) {
        const bool begins = at == 0 || all[at - 1] == ' ';
        const char after = at + one.size() < all.size() ? all[at + one.size()] : ' ';
        if (begins && (after == ' ' || after == ',')) return true;
    }
    return false;
}

}  // namespace

void require_effects(const PictureRequest& request) {
    const std::string show = word_of(request.show);
    const auto stated = nlohmann::ordered_json::parse(request_json(request));
    const auto refuse_beside = [&](const char* key, const std::string& other) {
        if (stated.contains(key)) throw RequestError(key, " has no effect " + other);
    };
    for (const auto& [keys, shows] : kEffects)
        for (const auto& [key, value] : stated.items())
            if (names(keys, key) && !names(shows, show))
                throw RequestError(key, fmt::format(" has no effect on show '{}', expected {}",
                                                    show, std::string(shows)));
    if (request.fit == ScaleFit::symmetric &&
        (is_depth(request.show) || request.show == Show::volume))
        refuse_beside("scale", fmt::format("as 'symmetric' on show '{}'", show));
    const TransferRequest& transfer = request.transfer;
    if (transfer.window && !transfer.bands.empty()) refuse_beside("window", "beside bands");
    if (transfer.window || !transfer.bands.empty())
        for (const char* key : {"tf", "range", "scale"})
            refuse_beside(key, "beside window and bands, which state colours and values");
    if (request.renderer == Renderer::trace || request.renderer == Renderer::reference)
        refuse_beside("slabs", fmt::format("with renderer '{}'", info_of(*request.renderer).name));
    if (is_by_value(request.show) && request.renderer && *request.renderer != Renderer::trace &&
        *request.renderer != Renderer::optix)
        refuse_beside("aabb_sigma", fmt::format("on show '{}' with renderer '{}'", show,
                                                info_of(*request.renderer).name));
    if (!request.look.light) refuse_beside("light_weights", "without light");
}

}  // namespace vog
