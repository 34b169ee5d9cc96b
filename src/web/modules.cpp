// modules.cpp: shaders of pages, and the module vog-view.js.
#include "web/modules.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "vog/export_html.h"
#include "vog/picture.h"
#include "vog/volume_picture.h"
#include "web/page_map.h"
#include "web/web_files.h"

namespace vog {

using namespace web;

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kShaders[] = {"splat.vert",  "splat.frag",  "erf.glsl",     "chord.glsl",
                                    "field.frag",  "slab.frag",   "ranges.frag",  "expected.glsl",
                                    "table.frag",  "finish.frag", "largest.frag", "copy.frag",
                                    "screen.vert", "shade.frag",  "tiles.glsl"};

/// A shader without comments and indentation.
std::string without_comments(std::string_view text) {
    std::string kept;
    for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
        end = std::min(text.find('\n', at), text.size());
        std::string_view line = text.substr(at, end - at);
        line = line.substr(0, line.find("//"));
        line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
        line = line.substr(0, line.find_last_not_of(' ') + 1);
        if (!line.empty()) kept.append(line) += '\n';
    }
    return kept;
}

}  // namespace

std::map<std::string, std::string> web::shader_texts() {
    std::map<std::string, std::string> texts;
    for (const char* name : kShaders) texts[name] = without_comments(web_file(name));
    return texts;
}

std::string view_module() {
    Json maps = Json::array();
    for (const std::string& name : transfer_function_names())
        maps.push_back(map_json(named_transfer_function(name)));
    const VolumeLook look;
    const Json page{{"maps", maps},
                    {"map", kDefaultMap},
                    {"slabs", {kVolumeSlabs, kMaximumSlabs, kLitSlabs}},
                    {"leastColumn", kLeastColumn},
                    {"lightWeights", {look.ambient, look.diffuse, look.specular, look.power}}};
    return fmt::format(
        "// vog-view.js: the element <vog-view> (docs/web_element.md of vog).\n"
        "const shaders = {};\nconst defaults = {};\n{}",
        Json(shader_texts()).dump(), page.dump(), web_file("vog-view.js"));
}

}  // namespace vog
