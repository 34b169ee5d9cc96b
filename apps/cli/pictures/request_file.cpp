// request_file.cpp: requests from files, with what the command line states in their place.
#include "pictures/request_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "shared/sequence.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Options of reading, first those of particles, then those of volumes.
constexpr const char* kOfPoints[] = {"--columns", "--value", "--radius", "--periodic",
                                     "--neighbours"};
constexpr const char* kOfVolumes[] = {"--grid", "--mask", "--sum", "--mesh", "--level-set-to-fog",
                                      "--field"};
constexpr const char* kOfAll[] = {"--skip-nonfinite", "--clip-negative"};

template <class Names>
bool has(const Names& names, const std::string& one) {
    return std::ranges::find(names, std::string_view(one)) != std::end(names);
}
/// Whether a text of --field names a file: "heat=FILE:GRID".
bool names_file(const std::string& field) { return field.find_first_of(":=") != field.npos; }

/// Options that state a member of a request, where they have not its name.
const std::map<std::string, std::vector<std::string>> kStatedBy = {
    {"scale", {"--scale", "--log"}},
    {"bands", {"--band", "--iso"}},
    {"clip_planes", {"--clip-plane"}},
    {"hits_per_slab", {"--slab-hits"}},
    {"camera", {}},
};

bool states(const CLI::App& command, const std::string& key) {
    std::string name = "--" + key;
    std::ranges::replace(name, '_', '-');
    const auto found = kStatedBy.find(key);
    const std::vector<std::string> options =
        found == kStatedBy.end() ? std::vector{name} : found->second;
    return std::ranges::any_of(options,
                               [&](const std::string& one) { return command.count(one) > 0; });
}

/// The file's request, with the members that options state.
PictureRequest merged(const PictureRequest& file, const PictureRequest& stated,
                      const CLI::App& command, FileKind kind) {
    Json json = Json::parse(request_json(file)), given = Json::parse(request_json(stated));
    const auto drop = [&](std::initializer_list<const char*> keys) {
        for (const char* key : keys) json.erase(key);
    };
    // Another quantity has other values.
    if (states(command, "show") || states(command, "field"))
        drop({"field", "tf", "range", "scale", "window", "bands", "threshold", "unit_distance",
              "units", "extinction", "light", "light_weights", "slabs"});
    if (states(command, "window") || states(command, "bands")) drop({"tf", "range", "scale"});
    if (states(command, "window")) drop({"bands"});
    if (states(command, "bands")) drop({"window"});
    if (states(command, "tf")) drop({"window", "bands"});
    if (states(command, "scale") && !states(command, "range")) drop({"range"});
    const RenderInput input =
        kind == FileKind::volume ? RenderInput::volumes : RenderInput::gaussians;
    if (states(command, "renderer") || (file.renderer && !draws(*file.renderer, input)))
        drop({"renderer", "slabs", "anyhit", "hits_per_slab", "stop_transmittance", "aabb_sigma",
              "pixel_error", "interpolation", "step", "samples"});
    for (const std::string& key : request_keys()) {
        if (!states(command, key)) continue;
        json.erase(key);
        if (given.contains(key)) json[key] = given[key];
    }
    PictureRequest request = request_of_json(json.dump());
    require_effects(request);
    return request;
}

/// Gives an option the values that it has in a file, as if the command line stated them; options of other kinds of data are left out.
/// throws  vog::Error for another option than those of reading
void read_as(const std::string& name, const std::vector<std::string>& values, CLI::App& command,
             FileKind kind) {
    if (!has(kOfPoints, name) && !has(kOfVolumes, name) && !has(kOfAll, name))
        throw Error(fmt::format("'{}' is no option of reading inputs", printable(name, 60)));
    if (values.empty()) throw Error(fmt::format("'{}' in 'reading' has no value", name));
    CLI::Option& option = *command.get_option(name);
    const bool fits = kind == FileKind::points   ? !has(kOfVolumes, name)
                      : kind == FileKind::volume ? !has(kOfPoints, name)
                                                 : has(kOfAll, name);
    if (option.count() > 0 || !fits) return;
    for (const std::string& value : values) option.add_result(value);
    option.run_callback();
}

/// throws  vog::Error unless the inputs that a record names are there
void require_inputs(const std::vector<std::string>& inputs) {
    if (inputs.empty()) throw Error("names no inputs, expected them on the command line");
    for (const std::string& input : inputs)
        if (std::error_code code;
            input.find_first_of("*?[") == input.npos && !std::filesystem::exists(input, code))
            throw Error(
                fmt::format("its input {} is not in {}: no such file; expected the inputs on "
                            "the command line",
                            printable(input, 200), std::filesystem::current_path(code).string()));
}

/// Whether --request is JSON itself, not a file.
bool is_json(const std::string& request) {
    const std::size_t first = request.find_first_not_of(" \t\r\n");
    return first != request.npos && request[first] == '{';
}

}  // namespace

void add_request_option(CLI::App& command, RenderArguments& arguments) {
    command
        .add_option(
            "--request", arguments.request_file,
            "Draw a picture again: a PNG or EXR that vog wrote, or its JSON (\"request\" of "
            "--json). It states its inputs and all options; those given beside it take "
            "their place")
        ->each([&command](const std::string&) { command.get_option("inputs")->required(false); });
}

PictureRequest stated_request(const RenderArguments& arguments) {
    if (arguments.request) return *arguments.request;
    PictureRequest request = picture_request(arguments.quantity, arguments.color, arguments.value);
    const Size size = parse_size(arguments.size);
    request.width = size.width, request.height = size.height;
    request.options = render_options(arguments.drawing);
    if (!arguments.drawing.renderer.empty())
        request.renderer = renderer_named(arguments.drawing.renderer);
    return request;
}

void take_request(RenderArguments& arguments, CLI::App& command) try {
    if (command.count("--request") == 0) return;
    const PictureRecord record = is_json(arguments.request_file)
                                     ? record_of_json(arguments.request_file)
                                     : read_record(arguments.request_file);
    std::vector<std::string>& inputs = arguments.drawing.inputs;
    if (inputs.empty()) require_inputs(inputs = record.inputs);
    if (names_file(record.request.field))
        throw Error("'field' names a file, expected it as '--field' in 'reading'");
    const PictureRequest stated = stated_request(arguments);
    const bool same_field = command.count("--field") + command.count("--show") == 0;
    const auto grid = record.reading.find("--grid");
    const bool has_grid = grid != record.reading.end() && !grid->second.empty();
    const FileKind kind = common_kind(expanded(inputs), command.count("--grid") || !has_grid
                                                            ? arguments.drawing.volume.grid
                                                            : grid->second.front());
    PictureRequest request = merged(record.request, stated, command, kind);
    for (const auto& [name, values] : record.reading)
        if (name != "--field") read_as(name, values, command, kind);
    // A field of another file has its name in the request, and its place among the options of reading.
    if (const auto field = record.reading.find("--field"); field != record.reading.end() &&
                                                           same_field && !field->second.empty() &&
                                                           kind == FileKind::volume)
        request.field = field->second.front(), arguments.reading["--field"] = field->second;
    arguments.view.stored = request.camera;
    // What checks of options ask for.
    arguments.quantity.show = word_of(request.show);
    arguments.quantity.field = request.field;
    arguments.quantity.axes = request.marks.axes;
    arguments.drawing.renderer = request.renderer ? info_of(*request.renderer).name : "";
    arguments.drawing.pixel_error = request.options.pixel_error;
    arguments.size = fmt::format("{}x{}", request.width, request.height);
    arguments.request = std::move(request);
} catch (const Error& error) {
    const std::string text = error.what(), file = arguments.request_file;
    const std::string name = is_json(file) ? "--request" : file;
    throw Error(text.starts_with(name) ? text : name + ": " + text);
}

std::map<std::string, std::vector<std::string>> reading_options(const CLI::App& command) {
    std::map<std::string, std::vector<std::string>> given;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const bool reads = has(kOfPoints, name) || has(kOfVolumes, name) || has(kOfAll, name);
        if (!reads || option->count() == 0) continue;
        if (name == "--field" && !names_file(option->results().front())) continue;
        given[name] = option->results();
    }
    return given;
}

}  // namespace vog::cli
