// request_file.cpp: requests from files, with what the command line states in their place.
#include "pictures/request_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "files/sequence.h"
#include "options/input_options.h"
#include "pictures/views.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/scan_io.h"
#include "vog/text.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Options of reading, first those of particles, then those of volumes.
constexpr const char* kOfPoints[] = {"--columns", "--value", "--radius", "--periodic",
                                     "--neighbours"};
constexpr const char* kOfVolumes[] = {
    "--grid", "--mask", "--combine", "--level-set-to-fog", "--field", "--set.background-value"};
constexpr const char* kOfAll[] = {"--skip-nonfinite", "--clip-negative"};

template <class Names>
bool has(const Names& names, const std::string& one) {
    return std::ranges::find(names, std::string_view(one)) != std::end(names);
}
/// Whether a text of --field names a file: "heat=FILE:GRID".
bool names_file(const std::string& field) { return field.find_first_of(":=") != field.npos; }

/// The file's request, without what the command line's words replace.
PictureRequest kept(const PictureRequest& file, const RequestWords& words, FileKind kind) {
    Json json = Json::parse(request_json(file));
    const auto drop = [&](const char* keys) {
        std::istringstream named(keys);
        for (std::string key; named >> key;) json.erase(key);
    };
    // Another quantity has other values.
    if (words.has("show") || words.has("field"))
        drop(
            "field tf range scale window bands threshold unit_distance gradient_opacity units "
            "extinction light light_weights shadows light_from clip_lights ambient_occlusion "
            "scattering asymmetry slabs layers");
    if (words.has("layers"))
        drop("field tf range scale window bands threshold unit_distance gradient_opacity");
    if (words.has("window") || words.has("bands")) drop("tf range scale");
    if (words.has("window")) drop("bands");
    if (words.has("bands")) drop("window");
    if (words.has("tf")) drop("window bands");
    if (words.has("scale")) drop("range");
    const RenderInput input =
        kind == FileKind::volume ? RenderInput::volumes : RenderInput::gaussians;
    if (words.has("renderer") || (file.renderer && !draws(*file.renderer, input)))
        drop(
            "renderer slabs precision anyhit hits_per_slab stop_transmittance aabb_sigma "
            "pixel_error interpolation step samples");
    return request_of_json(json.dump());
}

/// Gives an option the values that it has in a file, as if the command line stated them; options of other kinds of data are left out.
/// throws  vog::Error for another option than those of reading
void read_as(const std::string& name, const std::vector<std::string>& values, GivenOptions& command,
             FileKind kind) {
    if (!has(kOfPoints, name) && !has(kOfVolumes, name) && !has(kOfAll, name))
        throw Error(fmt::format("'{}' is not an option for reading inputs", printable(name, 60)));
    if (values.empty()) throw Error(fmt::format("'{}' in 'reading' has no value", name));
    const bool fits = kind == FileKind::points   ? !has(kOfVolumes, name)
                      : kind == FileKind::volume ? !has(kOfPoints, name)
                                                 : has(kOfAll, name);
    if (fits && !command.has(name)) command.state(name, values);
}

/// throws  vog::Error unless the inputs that a record names are there
void require_inputs(const std::vector<std::string>& inputs) {
    if (inputs.empty()) throw Error("names no inputs; add them to the command line");
    for (const std::string& input : inputs)
        if (std::error_code code;
            input.find_first_of("*?[") == input.npos && !std::filesystem::exists(input, code))
            throw Error(fmt::format(
                "its input {} is not in {}: no such file; name the inputs on the command line",
                printable(input, 200), std::filesystem::current_path(code).string()));
}

/// Draws the channels of an image as layers where the command line states neither a grid nor colours.
void take_channels(RenderArguments& arguments) {
    const DrawingArguments& drawing = arguments.drawing;
    PictureRequest& request = arguments.request;
    const RequestWords& words = arguments.words;
    const bool stated = std::ranges::any_of(
        std::initializer_list<const char*>{"field", "tf", "range", "scale", "window", "bands",
                                           "threshold", "gradient_opacity", "unit_distance",
                                           "layers", "renderer"},
        [&](const char* key) { return words.has(key); });
    // Steps in time, which a pattern or a folder of pictures states, show one channel each.
    const bool steps =
        !arguments.turntable && (is_sequence(arguments.output) || is_numbered(arguments.output));
    if (request.show != Show::volume || stated || steps || !drawing.volume.grid.empty() ||
        drawing.inputs.size() != 1)
        return;
    const std::string& input = drawing.inputs.front();
    if (std::error_code code;
        !std::filesystem::is_regular_file(input, code) || kind_of(input, {}) != FileKind::volume)
        return;
    std::vector<Channel> grids;
    for (const std::string& grid : grid_names(input)) grids.push_back({grid, 1});
    if (layers_of_channels(grids).empty()) return;
    const std::vector<VolumeInfo> infos = inspect_volume(input);
    for (std::size_t n = 0; n < grids.size(); ++n) grids[n].most = infos.at(n).grid.max;
    request.layers = layers_of_channels(grids);
    if (request.layers.empty()) return;
    std::string channels;
    for (const Layer& layer : request.layers)
        channels += fmt::format("{}{} {}", channels.empty() ? "" : ", ", layer.grid,
                                layer.transfer.points.points.name);
    print_notes({fmt::format(
        "{}: drawing channels as layers: {}; --grid draws one, --layer grid=NAME,... others", input,
        channels)});
}

/// Whether --request is JSON or a page's link itself, not a file.
bool is_text(const std::string& request) {
    const std::size_t first = request.find_first_not_of(" \t\r\n");
    std::error_code code;
    return first != request.npos &&
           (request[first] == '{' ||
            (request.find('#') != request.npos && !std::filesystem::exists(request, code)));
}

/// throws  vog::Error for text or a file that states no picture
PictureRecord record_in(const std::string& request) {
    if (!is_text(request)) return read_record(request);
    return request.find('{') < request.find('#') ? record_of_json(request)
                                                 : record_of_link(request);
}

}  // namespace

void place_layers(DrawingArguments& drawing, PictureRequest& request) {
    if (request.layers.empty()) return;
    // The command's input becomes a layer with defaults unless a layer draws it.
    if (std::ranges::none_of(request.layers, [&](const Layer& l) {
            return l.file.empty() ? l.input == 0 : l.file == drawing.inputs.front();
        }))
        request.layers.emplace(request.layers.begin());
    std::vector<std::string>& all = drawing.layer_inputs = drawing.inputs;
    for (Layer& layer : request.layers) {
        if (!layer.file.empty()) {
            layer.input =
                static_cast<std::size_t>(std::ranges::find(all, layer.file) - all.begin());
            if (layer.input == all.size()) all.push_back(layer.file);
            layer.file.clear();
        }
    }
    const std::size_t needed = std::ranges::max(request.layers, {}, &Layer::input).input + 1;
    if (needed > all.size())
        throw UsageError(
            fmt::format("--request: the picture has {} inputs, but {} given, expected all of them",
                        needed, all.size() == 1 ? "1 is" : fmt::format("{} are", all.size())));
    for (std::size_t n = 0; n < all.size(); ++n)
        if (std::ranges::none_of(request.layers, [&](const Layer& l) { return l.input == n; }))
            throw UsageError(
                fmt::format("--layer: no layer uses {}; add --layer {},... (for files of one mesh "
                            "use a quoted pattern, 'level*.vdb')",
                            all[n], all[n]));
    drawing.inputs.resize(1);
}

void take_request(RenderArguments& arguments, GivenOptions& command) try {
    if (!command.has("--request")) {
        arguments.request = arguments.words.over();
        take_channels(arguments);
        return place_layers(arguments.drawing, arguments.request);
    }
    const PictureRecord record = record_in(arguments.request_file);
    std::vector<std::string>& inputs = arguments.drawing.inputs;
    if (inputs.empty()) require_inputs(inputs = record.inputs);
    if (names_file(record.request.field))
        throw Error("'field' names a file, expected it as '--field' in 'reading'");
    const bool same_field = !arguments.words.has("field") && !arguments.words.has("show");
    const auto grid = record.reading.find("--grid");
    const bool has_grid = grid != record.reading.end() && !grid->second.empty();
    const std::vector<std::string> kinds(
        inputs.begin(), record.request.layers.empty() ? inputs.end() : inputs.begin() + 1);
    const FileKind kind = common_kind(expanded(kinds), command.has("--grid") || !has_grid
                                                           ? arguments.drawing.volume.grid
                                                           : grid->second.front());
    PictureRequest& request = arguments.request;
    request = arguments.words.over(kept(record.request, arguments.words, kind));
    require_effects(request);
    for (const auto& [name, values] : record.reading)
        if (name != "--field") read_as(name, values, command, kind);
    // A field of another file has its name in the request, and its place among the options of reading.
    if (const auto field = record.reading.find("--field"); field != record.reading.end() &&
                                                           same_field && !field->second.empty() &&
                                                           kind == FileKind::volume)
        request.field = field->second.front(), arguments.reading["--field"] = field->second;
    // Another plane of a slice has a view of its own.
    if (record.request.plane && arguments.words.has("plane")) request.camera.reset();
    arguments.view.stored = request.camera;
    place_layers(arguments.drawing, request);
} catch (const Error& error) {
    const std::string text = error.what(), file = arguments.request_file;
    const std::string name = is_text(file) ? "--request" : file;
    throw Error(text.starts_with(name) ? text : name + ": " + text);
}

std::map<std::string, std::vector<std::string>> reading_options(const GivenOptions& command) {
    std::map<std::string, std::vector<std::string>> given;
    for (const std::string& name : command.names()) {
        const bool reads = has(kOfPoints, name) || has(kOfVolumes, name) || has(kOfAll, name);
        const std::vector<std::string> values = command.values(name);
        if (!reads || (name == "--field" && !names_file(values.front()))) continue;
        given[name] = values;
    }
    return given;
}

}  // namespace vog::cli
