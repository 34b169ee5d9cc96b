// usd_read.cpp: Gaussians of the splats of an OpenUSD layer of text, .usda or .usd.
#include <fmt/core.h>

#include <algorithm>

#include "io/exchange/splat_density.h"
#include "io/exchange/splat_frame.h"
#include "io/exchange/splat_models.h"
#include "io/exchange/usd/usd_prims.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::exchange {

namespace usd {

std::optional<AttributeName> attribute_named(std::string_view name) {
    const auto among = [](std::string_view plain) {
        return static_cast<std::size_t>(std::ranges::find(kAttributes, plain) -
                                        kAttributes.begin());
    };
    if (const std::size_t index = among(name); index < kAttributes.size())
        return AttributeName{index, false};
    if (!name.ends_with('h')) return std::nullopt;
    const std::size_t index = among(name.substr(0, name.size() - 1));
    if (index == kAttributes.size()) return std::nullopt;
    return AttributeName{index, true};
}

void set_numbers(Prim& prim, AttributeName name, std::vector<float> numbers) {
    std::vector<float>& own = prim.numbers[name.index];
    if (numbers.empty() || (!own.empty() && name.half && !prim.half[name.index])) return;
    own = std::move(numbers);
    prim.half[name.index] = name.half;
}

namespace {

std::string path_of(const std::vector<Prim>& prims, std::size_t index) {
    std::string path;
    for (auto at = static_cast<std::ptrdiff_t>(index); at >= 0;) {
        const Prim& prim = prims[static_cast<std::size_t>(at)];
        path = "/" + prim.name + path;
        at = prim.parent;
    }
    return printable(path);
}

/// Whether a prim is drawn.
/// throws  vog::Error where the prim or one above is moved
bool drawn(const std::vector<Prim>& prims, std::size_t index) {
    for (auto at = static_cast<std::ptrdiff_t>(index); at >= 0;
         at = prims[static_cast<std::size_t>(at)].parent)
        if (prims[static_cast<std::size_t>(at)].absent) return false;
    for (auto at = static_cast<std::ptrdiff_t>(index); at >= 0;) {
        const Prim& prim = prims[static_cast<std::size_t>(at)];
        if (prim.moved)
            throw Error(fmt::format(
                "{} is moved by xformOpOrder, expected splats in the coordinates of the world",
                path_of(prims, static_cast<std::size_t>(at))));
        at = prim.parent;
    }
    return true;
}

void add_splats(const Prim& prim, Gaussians& model) {
    if (!prim.sampled.empty())
        throw Error(fmt::format("{} at several times, expected one default", prim.sampled));
    const std::size_t count = prim.numbers.front().size() / kComponents.front();
    for (std::size_t k = 0; k < kAttributes.size(); ++k)
        if (prim.numbers[k].size() != count * kComponents[k] || count == 0)
            throw Error(fmt::format("{} {} of {} splats", prim.numbers[k].size() / kComponents[k],
                                    kAttributes[k], count));
    const auto& [mean, turn, scale, opacity] = prim.numbers;
    for (std::size_t i = 0; i < count; ++i) {
        model.mean.push_back({mean[3 * i], mean[3 * i + 1], mean[3 * i + 2]});
        model.rotation.push_back({turn[4 * i], turn[4 * i + 1], turn[4 * i + 2], turn[4 * i + 3]});
        model.scale.push_back({scale[3 * i], scale[3 * i + 1], scale[3 * i + 2]});
        if (opacity[i] < 0 || opacity[i] > 1)
            throw Error(fmt::format("opacity {} of splat {}, expected 0 to 1", opacity[i], i));
        model.density.push_back(splat_density(double{opacity[i]}, model.scale.back()));
    }
}

}  // namespace

}  // namespace usd

std::string text_layer(std::filesystem::path file) {
    return file.replace_extension(".usda").string();
}

Gaussians read_usd(const std::filesystem::path& file) {
    FileBytes in(file);
    constexpr std::string_view kText = "#usda ", kCrate = "PXR-USDC";
    const std::string head(in.take(std::min<std::uint64_t>(in.size(), kCrate.size())),
                           std::min<std::uint64_t>(in.size(), kCrate.size()));
    in.seek(0);
    if (head == kCrate)
        throw Error(fmt::format("{}: OpenUSD's binary layer, expected one of text: usdcat {} -o {}",
                                file.string(), file.string(), text_layer(file)));
    if (!head.starts_with(kText))
        throw Error(fmt::format("{}: not a layer of OpenUSD as text ('#usda 1.0')", file.string()));
    const std::vector<usd::Prim> prims = usd::read_text(in, file.string());
    Gaussians model;
    for (std::size_t n = 0; n < prims.size(); ++n) try {
            if (!prims[n].splats || !usd::drawn(prims, n)) continue;
            Gaussians own;
            usd::add_splats(prims[n], own);
            restore_frame(own, prims[n].frame, Upright::y);
            append(model, own);
        } catch (const Error& error) {
            throw Error(
                fmt::format("{}: {}: {}", file.string(), usd::path_of(prims, n), error.what()));
        }
    if (model.size() == 0)
        throw Error(
            fmt::format("{}: no splats, expected a prim {} in this file; usdcat --flatten follows "
                        "references, payloads and variants",
                        file.string(), usd::kSplatType));
    return model;
}

}  // namespace vog::exchange
