// export_html.cpp: assembly of the page from its files, models, transfer functions and texts.
#include "vog/export_html.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "core/atomic_file.h"
#include "core/html_text.h"
#include "render/pixel_limits.h"
#include "shade/named_extinction.h"
#include "shade/transfer_function.h"
#include "vog/error.h"
#include "vog/splat.h"
#include "web/web_codec.h"
#include "web/web_files.h"

namespace vog {

using namespace shading;
using namespace web;

namespace {

using Json = nlohmann::ordered_json;

/// Modules in the order of their dependencies.
constexpr const char* kModules[] = {"vectors.js", "camera.js",   "gaussians.js",
                                    "colors.js",  "renderer.js", "link.js",
                                    "input.js",   "controls.js", "main.js"};
constexpr const char* kShaders[] = {"splat.vert", "splat.frag", "screen.vert", "shade.frag"};

/// Name declared by a line such as "const x = 1;" or "async function x() {".
std::string declared_name(std::string_view line) {
    for (const std::string_view word : {"async ", "function ", "class ", "const "})
        if (line.starts_with(word)) line.remove_prefix(word.size());
    return std::string(line.substr(0, line.find_first_of(" (={;")));
}

/// All modules as one script: each becomes a function that returns its exports to the later ones.
/// Imports and exported declarations must start a line.
std::string bundle() {
    std::string script;
    for (const char* name : kModules) {
        const std::string text = web_file(name);
        std::string body, exported;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
            std::string_view line = std::string_view(text).substr(at, end - at);
            at = end;
            if (line.starts_with("import ")) continue;
            if (line.starts_with("export ")) {
                line.remove_prefix(7);
                exported += (exported.empty() ? "" : ", ") + declared_name(line);
            }
            body += line;
        }
        if (exported.empty())
            script += "(() => {\n" + body + "})();\n";
        else
            script += fmt::format("const {{ {} }} = (() => {{\n", exported) + body +
                      fmt::format("return {{ {} }};\n}})();\n", exported);
    }
    return script;
}

/// JSON for a script element, with '<' escaped: no text ends the element or starts a comment.
std::string script_json(const Json& data) {
    const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    }
    return safe;
}

/// Replaces every {{name}} of a page in one pass: inserted text is not searched again.
std::string filled(const std::string& page, const std::map<std::string, std::string>& parts) {
    std::string out;
    std::size_t at = 0;
    for (std::size_t open; (open = page.find("{{", at)) != std::string::npos;) {
        const std::size_t close = page.find("}}", open);
        out.append(page, at, open - at);
        out += parts.at(page.substr(open + 2, close - open - 2));
        at = close + 2;
    }
    return out.append(page, at);
}

Json json_of(const PixelLimits& limits) {
    return {limits.least2, limits.sampled2, limits.variance, limits.mass};
}
Json json_of(Vec3d v) { return {v.x, v.y, v.z}; }

Json json_of(const TransferFunction& tf) {
    Json colors = Json::array(), opacity = Json::array();
    // Four digits are finer than the 8 bits of the display.
    const auto rounded = [](float v) { return std::round(double{v} * 1e4) / 1e4; };
    for (const ColorPoint& c : tf.color)
        colors.push_back({double{c.v}, rounded(c.r), rounded(c.g), rounded(c.b)});
    for (const OpacityPoint& o : tf.opacity) opacity.push_back({double{o.v}, rounded(o.opacity)});
    return {{"name", tf.name}, {"colors", colors}, {"opacity", opacity}};
}

/// All named maps; before them the chosen one if it is not among them or differs from its namesake.
/// chosen_name  receives its name in the list
Json maps_json(const TransferFunction& chosen, std::string& chosen_name) {
    Json maps = Json::array();
    const Json own = json_of(chosen);
    chosen_name = chosen.name.empty() ? "own" : chosen.name;
    bool known = false;
    for (const std::string& name : transfer_function_names()) {
        maps.push_back(json_of(named_transfer_function(name)));
        if (maps.back() == own) known = true;
    }
    if (known) return maps;
    if (is_transfer_function_name(chosen_name)) chosen_name += " (own)";
    maps.insert(maps.begin(), own);
    maps.front()["name"] = chosen_name;
    return maps;
}

/// Box of a model's view; a unit cube if the model is empty.
Box framed_box(const Gaussians& model) {
    const Box box = view_box(model);
    return box.empty() ? Box{{-1, -1, -1}, {1, 1, 1}} : box;
}

/// Extinction of the options, or the automatic one of the first view.
double first_extinction(const Gaussians& model, const HtmlOptions& options) {
    if (options.extinction) return *options.extinction;
    constexpr int kSize = 256;
    const Camera camera = options.camera ? *options.camera : orbit_view(framed_box(model));
    return shading::auto_extinction_of(render_splat(model, camera, kSize, kSize), model.source);
}

/// A model's entry in the page's JSON; its levels are appended to `data` as elements.
Json model_json(const HtmlModel& model, std::size_t index, const HtmlOptions& options,
                std::string& data) {
    const Gaussians& finest = model.levels.front();
    const WebFrame frame = web_frame(finest);
    const Box box = framed_box(finest);
    Json levels = Json::array();
    for (std::size_t n = 0; n < model.levels.size(); ++n) {
        const WebLevel level = web_level(model.levels[n], frame);
        // Longest string of V8, the shortest limit of all engines: 2^29 - 24 characters.
        constexpr std::size_t kMaxText = (std::size_t{1} << 29) - 24;
        const std::string text = base64(level.compressed());
        if (text.size() > kMaxText)
            throw Error(fmt::format("{}: {} Gaussians are {} bytes in a page, expected at most {}",
                                    model.name, level.count, text.size(), kMaxText));
        levels.push_back({{"count", level.count},
                          {"rotated", level.rotated},
                          {"chunks", level.chunks.size()},
                          {"scale", {level.scale.low, level.scale.step}},
                          {"density", {level.density.low, level.density.step}}});
        data += fmt::format("<script type=\"text/plain\" id=\"model-{}-{}\">", index, n);
        data += text;
        data += "</script>\n";
    }
    return {{"name", model.name},
            {"center", json_of(frame.center)},
            {"unit", frame.unit},
            {"cutoff", finest.cutoff},
            {"limits", json_of(pixel_limits(finest.cutoff))},
            {"subframeLimits", json_of(subframe_limits(finest.cutoff))},
            {"box",
             {{"center", json_of(box.center())},
              {"half", json_of(0.5 * (box.upper - box.lower))},
              {"radius", box.radius() > 0 ? box.radius() : 1}}},
            {"extinction", first_extinction(finest, options)},
            {"levels", levels}};
}

void check(std::span<const HtmlModel> models, const HtmlOptions& options) {
    if (models.empty()) throw Error("page: no model, expected one or more");
    for (const HtmlModel& model : models) {
        if (model.levels.empty())
            throw Error(
                fmt::format("page: model '{}' has no levels, expected one or more", model.name));
        for (const Gaussians& level : model.levels) validate(level);
    }
    if (options.extinction && !(std::isfinite(*options.extinction) && *options.extinction > 0))
        throw Error(fmt::format("page: extinction {}, expected a finite number above 0",
                                *options.extinction));
    require_valid("page", options.tf);
    if (options.camera) frame_of(*options.camera, 1, 1);
}

/// Style of the text over a background: "light", "dark", or "clear" for a transparent one.
std::string ground_of(const Rgba& background) {
    if (background.a < 0.5f) return "clear";
    const float luma = 0.2126f * background.r + 0.7152f * background.g + 0.0722f * background.b;
    return luma > 0.5f ? "light" : "dark";
}

}  // namespace

HtmlReport write_html(const std::filesystem::path& file, std::span<const HtmlModel> models,
                      const HtmlOptions& options) {
    check(models, options);
    HtmlReport report;
    std::string data, map_name, shaders;
    Json entries = Json::array();
    for (const HtmlModel& model : models) {
        entries.push_back(model_json(model, entries.size(), options, data));
        report.gaussians += model.levels.front().size();
    }
    report.extinction = entries.front().at("extinction");
    const Camera camera =
        options.camera ? *options.camera : orbit_view(framed_box(models.front().levels.front()));
    const Rgba& ground = options.shading.background;
    Json page = {{"title", options.title},
                 {"camera",
                  {{"eye", json_of(camera.eye)},
                   {"at", json_of(camera.look_at)},
                   {"up", json_of(camera.up)},
                   {"fov", camera.fov_degrees},
                   {"span", camera.orthographic_width}}},
                 {"upright", json_of(normalized(camera.up))},
                 {"chosenView", options.camera.has_value()},
                 {"systemBackground", options.system_background},
                 {"background", {ground.r, ground.g, ground.b, ground.a}},
                 {"fade", options.shading.blend}};
    page["maps"] = maps_json(options.tf, map_name);
    page["map"] = map_name;
    page["models"] = std::move(entries);
    for (const char* name : kShaders)
        shaders += fmt::format("<script type=\"text/plain\" data-shader=\"{}\">\n{}</script>\n",
                               name, web_file(name));
    report.viewer_bytes = data.size();
    const std::string text =
        filled(web_file("page.html"), {{"title", escaped(options.title)},
                                       {"description", escaped(options.description)},
                                       {"ground", ground_of(ground)},
                                       {"style", web_file("page.css")},
                                       {"page", script_json(page)},
                                       {"shaders", shaders},
                                       {"models", std::move(data)},
                                       {"script", bundle()}});
    report.bytes = text.size();
    report.viewer_bytes = report.bytes - report.viewer_bytes;
    write_file(file, [&](std::ofstream& out) { out << text; });
    return report;
}

}  // namespace vog
