// request_file.cpp: requests from files, with what the command line states in their place.
#include "pictures/request_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReading[] = {
    "--grid",          "--mask",    "--sum",   "--mesh",   "--level-set-to-fog", "--skip-nonfinite",
    "--clip-negative", "--columns", "--value", "--radius", "--periodic",         "--neighbours"};

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
                      const CLI::App& command, bool same_inputs) {
    Json json = Json::parse(request_json(file)), given = Json::parse(request_json(stated));
    const auto drop = [&](std::initializer_list<const char*> keys) {
        for (const char* key : keys) json.erase(key);
    };
    // Another quantity has other values; other data may be of another kind.
    if (states(command, "show") || states(command, "field"))
        drop({"field", "tf", "range", "scale", "window", "bands", "threshold", "unit_distance",
              "units", "extinction", "light", "light_weights", "slabs"});
    if (states(command, "window") || states(command, "bands")) drop({"tf", "range", "scale"});
    if (states(command, "window")) drop({"bands"});
    if (states(command, "bands")) drop({"window"});
    if (states(command, "tf")) drop({"window", "bands"});
    if (states(command, "scale") && !states(command, "range")) drop({"range"});
    if (!same_inputs || states(command, "renderer"))
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

/// Gives an option the values that it has in a file, as if the command line stated them.
/// throws  vog::Error for another option than those of reading
void read_as(const std::string& name, const std::vector<std::string>& values, CLI::App& command,
             const std::string& file) {
    if (std::ranges::find(kReading, std::string_view(name)) == std::end(kReading))
        throw Error(
            fmt::format("{}: '{}' is no option of reading inputs", file, printable(name, 60)));
    CLI::Option& option = *command.get_option(name);
    if (option.count() > 0) return;
    for (const std::string& value : values) option.add_result(value);
    option.run_callback();
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

void take_request(RenderArguments& arguments, CLI::App& command) {
    if (arguments.request_file.empty()) return;
    const PictureRecord record = arguments.request_file.starts_with('{')
                                     ? record_of_json(arguments.request_file)
                                     : read_record(arguments.request_file);
    std::vector<std::string>& inputs = arguments.drawing.inputs;
    const bool same_inputs = inputs.empty();
    if (same_inputs) {
        inputs = record.inputs;
        if (inputs.empty())
            throw Error(arguments.request_file +
                        ": names no inputs, expected them on the command line");
        for (const auto& [name, values] : record.reading)
            read_as(name, values, command, arguments.request_file);
    }
    PictureRequest request =
        merged(record.request, stated_request(arguments), command, same_inputs);
    // --save-camera, of the same group, states none.
    if (view_given(command) &&
        !(command.count("--save-camera") && command.get_options([](const CLI::Option* option) {
                                                       return option->get_group() == "View" &&
                                                              option->count() > 0;
                                                   })
                                                    .size() == 1))
        request.camera.reset();
    // What checks of options ask for.
    arguments.quantity.show = word_of(request.show);
    arguments.quantity.field = request.field;
    arguments.quantity.axes = request.marks.axes;
    arguments.drawing.renderer = request.renderer ? info_of(*request.renderer).name : "";
    arguments.drawing.pixel_error = request.options.pixel_error;
    arguments.size = fmt::format("{}x{}", request.width, request.height);
    arguments.request = std::move(request);
}

std::map<std::string, std::vector<std::string>> reading_options(const CLI::App& command) {
    std::map<std::string, std::vector<std::string>> given;
    for (const char* name : kReading)
        if (command.count(name) > 0) given[name] = command.get_option(name)->results();
    return given;
}

}  // namespace vog::cli
