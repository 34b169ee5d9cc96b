// request_effects.cpp: Members of a request that would change nothing are refused, by the table of members.
#include "render/picture/request/request_effects.h"

#include <iterator>
#include <sstream>
#include <tuple>

#include "render/picture/request/request_member.h"
#include "shade/values/label_table.h"
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
std::string listed(const std::string& words, const char* quote = "'") {
    const std::vector<std::string> all = words_of(words);
    std::string text;
    for (std::size_t n = 0; n < all.size(); ++n)
        text += fmt::format("{}{}{}{}",
                            n == 0               ? ""
                            : n + 1 < all.size() ? ", "
                                                 : " or ",
                            quote, all[n], quote);
    return text;
}

/// Whether a member is not at its default.
bool is_stated(const requests::Entry& entry, const PictureRequest& request) {
    static const PictureRequest unset;
    return entry.values.write(request) != entry.values.write(unset);
}

/// Rules on the members of a request.
/// renderer  the one that draws it; none: the one of the request
void require_rules(const PictureRequest& request, std::optional<Renderer> renderer) {
    require_rules(
        request_rules(), word_of(request.show),
        [&](const std::string& key) { return is_stated(requests::entry_of(key), request); },
        [&](const std::string& key) {
            const requests::Json value = requests::entry_of(key).values.write(request);
            if (key == "renderer" && renderer) return std::string(info_of(*renderer).name);
            return value.is_string() ? value.get<std::string>() : std::string();
        });
}

}  // namespace

void require_rules(std::span<const OptionRule> rules, const std::string& of,
                   const std::function<bool(const std::string&)>& is_stated,
                   const std::function<std::string(const std::string&)>& value_of) {
    // "key" is stated, or "key=word" has this value.
    const auto holds = [&](const std::string& member) {
        const std::size_t equals = member.find('=');
        return equals == member.npos
                   ? is_stated(member)
                   : value_of(member.substr(0, equals)) == member.substr(equals + 1);
    };
    const auto reason_of = [&](const OptionRule& rule) -> std::string {
        const bool any = std::ranges::any_of(words_of(rule.beside), holds);
        if (rule.values == "-")
            return any ? fmt::format(" has no effect beside {}", listed(rule.beside, "`")) : "";
        if (rule.values == "*")
            return any ? "" : fmt::format(" has no effect without {}", listed(rule.beside, "`"));
        const std::string value = value_of(rule.beside);
        if (value.empty() || has(rule.values, value)) return "";
        return fmt::format(" needs {} {}{}", rule.beside, listed(rule.values),
                           rule.of.empty() ? "" : " on show " + listed(of));
    };
    for (const OptionRule& rule : rules) {
        if (!has(rule.of, of)) continue;
        const std::string reason = reason_of(rule);
        if (reason.empty()) continue;
        for (const std::string& member : words_of(rule.members)) {
            const std::size_t equals = member.find('=');
            const std::string value =
                equals == member.npos ? "" : fmt::format(" '{}'", member.substr(equals + 1));
            if (holds(member)) throw RequestError(member.substr(0, equals), value + reason);
        }
    }
}

std::span<const OptionRule> request_rules() {
    static const std::vector<OptionRule> all = {
        {"show=slice", "plane", "*"},
        {"scale=symmetric", "show", "mean deviation maximum slice"},
        {"interpolation=linear", "show", "T column mean deviation volume"},
        {"light_weights", "light shadows ambient_occlusion", "*"},
        {"light_from scattering asymmetry", "shadows light=studio", "*"},
        {"clip_lights", "shadows ambient_occlusion light=studio", "*"},
        {"clip_lights", "clip clip_planes", "*"},
        {"tf range scale", "window", "-"},
        {"tf range scale window", "bands", "-"},
        {"field tf range scale window bands threshold gradient_opacity unit_distance", "layers",
         "-"},
        {"step", "interpolation", "linear"},
        {"hits_per_slab stop_transmittance", "anyhit", "collect"},
        {"pixel_error", "aabb_sigma", "-"},
        {"aabb_sigma", "renderer", "trace optix", "mean deviation volume maximum"},
    };
    return all;
}

void require_effects(const PictureRequest& request) {
    const std::string show = word_of(request.show);
    for (const requests::Entry& entry : requests::entries())
        if (!has(entry.schema.shows, show) && is_stated(entry, request))
            throw RequestError(entry.schema.key,
                               fmt::format(" has no effect on show '{}', expected {}", show,
                                           fmt::join(words_of(entry.schema.shows), ", ")));
    require_rules(request, {});
    if (request.renderer) require_renderer_effects(request, *request.renderer, {});
}

void require_renderer_effects(const PictureRequest& request, Renderer renderer,
                              std::optional<RenderInput> input) {
    for (const requests::Entry& entry : requests::entries()) {
        const std::string &key = entry.schema.key, &names = entry.schema.renderers;
        const bool of_voxels = key == "interpolation" || key == "step";
        if (of_voxels && !request.layers.empty()) continue;  // require_interpolation checks them
        if (!has(names, info_of(renderer).name) && is_stated(entry, request))
            throw RequestError(key, fmt::format(" is not for renderer '{}', expected {}",
                                                info_of(renderer).name, listed(names)));
        // Renderers of both models and voxels have members that are for models alone.
        if (input && *input != RenderInput::gaussians &&
            !has(names, info_of(Renderer::reference).name) && is_stated(entry, request))
            throw RequestError(key, input == RenderInput::cells
                                        ? " is for Gaussians, not for cells"
                                        : " is for Gaussians, not for voxels");
        if (input == RenderInput::cells && of_voxels && is_stated(entry, request))
            throw RequestError(key, " is for voxels, not for cells, which are drawn exactly");
    }
    require_rules(request, renderer);
    const TransferPoints& points = request.transfer.points;
    if (request.show == Show::maximum && input == RenderInput::gaussians &&
        shading::is_label_table(points))
        throw RequestError("tf", fmt::format(": {} is a table of labels, and maxima of a model lie "
                                             "between them; expected `show` slice or volume",
                                             points.points.name));
}

void require_interpolation(const ResolvedPicture& picture) {
    const auto is_linear = [](const ResolvedPicture& one) {
        return one.request.options.voxels.interpolation == Interpolation::linear;
    };
    if (is_linear(picture) && std::ranges::none_of(picture.layers, is_linear))
        throw RequestError("interpolation",
                           " 'linear' has no effect: no layer draws voxels other than labels and "
                           "planes; expected constant");
}

namespace {

/// throws  RequestError for averages of labels, which are other labels
void require_whole_labels(const PictureRequest& request) {
    const TransferPoints& points = request.transfer.points;
    if (!shading::is_label_table(points)) return;
    const bool of_map = request.show == Show::slice || request.show == Show::maximum;
    const auto refuse = [&](const char* key, const char* expected) {
        throw RequestError(
            key,
            fmt::format(": {} is a table of labels, whose averages are other labels; expected {}",
                        points.points.name, expected));
    };
    if (request.options.voxels.interpolation == Interpolation::linear)
        refuse("interpolation", "constant");
    if (of_map && request.options.samples > 1) refuse("samples", "1");
    if (of_map && request.thickness) refuse("thickness", "none");
}

}  // namespace

std::optional<ColorScale> stated_scale(const PictureRequest& request) {
    const auto& [show, points, range] =
        std::tie(request.show, request.transfer.points, request.transfer.range);
    const bool of_values = show == Show::mean || show == Show::slice || is_by_value(show);
    if ((!of_values || show == Show::mean) && shading::is_label_table(points))
        throw RequestError("tf", fmt::format(": {} is a table of labels; `show` {} shows none, "
                                             "expected `show` slice, volume or maximum",
                                             points.points.name, word_of(show)));
    require_whole_labels(request);
    if (of_values && points.at_values) {
        if (range || request.fit != ScaleFit::automatic)
            throw RequestError(range ? "range" : "scale",
                               fmt::format(": {} states values of its own, expected one of them",
                                           points.points.name));
        return ColorScale{ColorScale::Kind::linear, points.lower, points.upper};
    }
    if (!range) return std::nullopt;
    return ColorScale{
        request.fit == ScaleFit::log ? ColorScale::Kind::log : ColorScale::Kind::linear,
        range->first, range->second};
}

}  // namespace vog
