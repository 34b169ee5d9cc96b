// request_layers.cpp: layers of a request, in JSON and as words of a command line.
#include "render/picture/request/request_effects.h"
#include "render/picture/request/request_member.h"
#include "vog/picture_record.h"
#include "vog/text.h"

namespace vog::requests {

namespace {

/// Members of requests that a layer has, too.
constexpr const char* kKeys[] = {"field",         "tf",    "range",     "scale",
                                 "window",        "bands", "threshold", "gradient_opacity",
                                 "unit_distance", "plane"};

/// Those of a command line.
constexpr const char* kWords =
    "a file first, then grid, field, tf, range, scale, window, band, iso, threshold, "
    "gradient-opacity, unit-distance, plane, color or opacity, each with = and a value";

bool is_key(const std::string& key) { return std::ranges::count(kKeys, key) > 0; }

[[noreturn]] void refuse_key(const std::string& key, const std::string& others) {
    throw RequestError("layers", fmt::format(" '{}': expected {}", printable(key, 40), others));
}

/// A layer as a request of its own.
PictureRequest request_of(const Layer& layer) {
    PictureRequest request;
    request.show = Show::volume;
    request.field = layer.field, request.transfer = layer.transfer, request.fit = layer.fit;
    request.plane = layer.plane;
    return request;
}
/// throws  RequestError for members without effect beside each other
void set(Layer& layer, PictureRequest request) {
    layer.plane = std::move(request.plane), request.plane.reset();
    require_effects(request);
    layer.field = std::move(request.field), layer.transfer = std::move(request.transfer);
    layer.fit = request.fit;
}

Json layer_json(const Layer& layer) {
    const PictureRequest request = request_of(layer), unset = request_of({});
    Json json = {{"input", layer.input}};
    if (!layer.grid.empty()) json["grid"] = layer.grid;
    if (!layer.visible) json["visible"] = false;
    if (layer.color) json["color"] = *layer.color;
    if (layer.opacity) json["opacity"] = *layer.opacity;
    for (const char* key : kKeys) {
        const Values& values = entry_of(key).values;
        if (Json value = values.write(request); value != values.write(unset))
            json[key] = std::move(value);
    }
    return json;
}

/// Sets a member that layers alone have.
/// returns  whether it is one
bool set_own(Layer& layer, const std::string& key, const Json& value) {
    if (key == "color")
        layer.color = rgb_of(key, value);
    else if (key == "opacity")
        layer.opacity = checked<double>(key, value, {1e-4, 1, "a number from 0.0001 to 1"});
    else
        return false;
    return true;
}

Layer layer_of(const Json& json) {
    if (!json.is_object()) refuse("layers", json, "an object for each layer");
    Layer layer;
    PictureRequest request = request_of({});
    for (const auto& [key, value] : json.items()) {
        if (key == "input")
            layer.input = checked<std::size_t>("layers", value, {0, 1e6, "an input, from 0"});
        else if (key == "grid")
            layer.grid = checked<std::string>("layers", value, {});
        else if (key == "visible")
            layer.visible = checked<bool>("layers", value, {});
        else if (value.is_null() || set_own(layer, key, value))
            continue;
        else if (!is_key(key))
            refuse_key(key, fmt::format("input, grid, visible, color, opacity, {}",
                                        fmt::join(kKeys, ", ")));
        else
            entry_of(key).values.read(key, value, request);
    }
    set(layer, std::move(request));
    return layer;
}

}  // namespace

Values layers_values() {
    return {[](const PictureRequest& r) {
                Json rows;
                for (const Layer& layer : r.layers) rows.push_back(layer_json(layer));
                return rows;
            },
            [](const std::string& key, const Json& value, PictureRequest& r) {
                r.layers.clear();
                if (value.is_null()) return;
                if (!value.is_array() || value.empty()) refuse(key, value, "a list of layers");
                for (const Json& row : value) r.layers.push_back(layer_of(row));
            }};
}

Layer layer_of_words(const std::string& text) try {
    if (text.empty()) refuse_key(text, kWords);
    Layer layer;
    using Word = std::pair<std::string, std::string>;
    std::vector<Word> members;
    for (std::size_t at = 0, comma = 0; comma != text.npos; at = comma + 1) {
        comma = text.find(',', at);
        const std::string word = text.substr(at, comma - at);
        const bool has_value = word.find('=') != word.npos;
        std::string key = word.substr(0, word.find('='));
        std::ranges::replace(key, '-', '_');
        if (key == "band" || key == "iso") key = "bands";
        if (key == "colour") key = "color";
        if (has_value) {
            if (!is_key(key) && key != "grid" && key != "color" && key != "opacity")
                refuse_key(key, kWords);
            if (key != "bands" && std::ranges::count(members, key, &Word::first) > 0)
                throw RequestError("layers",
                                   fmt::format(" {}: {} twice", printable(text, 80), key));
            members.emplace_back(key, word.substr(word.find('=') + 1));
        } else if (!members.empty()) {
            members.back().second += "," + word;
        } else if (at == 0) {
            layer.file = word;
        } else {
            refuse_key(word, kWords);
        }
    }
    PictureRequest request = request_of({});
    std::vector<std::string> bands;
    for (const auto& [key, value] : members) {
        if (key == "bands")
            bands.push_back(value);
        else if (key == "grid")
            layer.grid = value;
        else if (!set_own(layer, key, words_value(value)))
            set_member(request, key, {value});
    }
    if (!bands.empty()) set_member(request, "bands", bands);
    set(layer, std::move(request));
    return layer;
} catch (const RequestError& error) {
    if (error.member() == "layers") throw;
    throw RequestError("layers",
                       fmt::format(" {}: {}{}", printable(text, 80), error.member(), error.text()));
}

}  // namespace vog::requests

namespace vog {

std::vector<Layer> layers_of_channels(std::span<const Channel> grids) {
    const std::vector<std::string> primaries{"red", "green", "blue"};
    const bool rgb =
        grids.size() >= 3 && std::ranges::equal(grids.first(3), primaries, {}, &Channel::grid);
    std::vector<Layer> layers;
    if (grids.size() < 2) return layers;
    if (rgb) grids = grids.first(3);
    const double most = std::ranges::max(grids, {}, &Channel::most).most;
    // Two channels in colours that the colour-blind tell apart.
    const char* const colors[] = {"magenta", "lime", "cyan", "yellow", "red", "blue", "orange"};
    const char* const of_rgb[] = {"red", "lime", "blue"};
    for (std::size_t n = 0; n < grids.size(); ++n) {
        if (!rgb && grids[n].grid != "c" + std::to_string(n)) return {};
        if (!(grids[n].most > 0)) continue;
        Layer& layer = layers.emplace_back();
        layer.grid = grids[n].grid;
        layer.transfer.points = transfer_points(rgb ? of_rgb[n] : colors[n % std::size(colors)]);
        if (rgb) layer.transfer.range.emplace(0, most);
    }
    return layers;
}

void require_layer_effects(const Layer& layer, bool is_surface) {
    const TransferRequest& t = layer.transfer;
    const bool has_values = !layer.field.empty() || layer.plane || t.range || t.log || t.window ||
                            !t.bands.empty() || t.threshold || t.unit_distance ||
                            !t.gradient.empty() || !t.points.points.color.empty() ||
                            layer.fit != ScaleFit::automatic;
    if (is_surface && has_values)
        throw RequestError("layers", ": a surface has no values, expected color or opacity");
    if (layer.plane && has_gradient(t))
        throw RequestError("layers", ": a plane shows values, without gradient opacity");
    if (!is_surface && layer.color)
        throw RequestError("layers", ": only a surface has a color; use tf or band");
    if (!is_surface && layer.opacity && !layer.plane)
        throw RequestError("layers",
                           ": only planes and surfaces have an opacity; use unit_distance, the "
                           "length that opacities refer to");
}

}  // namespace vog
