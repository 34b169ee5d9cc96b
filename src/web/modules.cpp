// modules.cpp: scripts of pages and of the module vog-view.js, bundled from the modules of src/web/page.
#include "web/modules.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
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

/// The reader of compact models, for the page and for its worker.
constexpr const char* kReaderModules[] = {"columns.js", "vogz.js", "gaussians.js", "fields.js"};
/// What every view has, in the order of dependencies: no module of these touches anything outside of its canvas.
constexpr const char* kViewModules[] = {
    "vectors.js", "camera.js",   "decoder.js", "colors.js", "transfer.js", "clip.js",
    "covered.js", "renderer.js", "light.js",   "slabs.js",  "probe.js",    "quantity.js",
    "request.js", "link.js",     "motions.js", "input.js",  "readout.js",  "viewer.js"};
/// Those of models that are streamed.
constexpr const char* kStreamModules[] = {"rows.js",   "cut.js",   "visibility.js", "requests.js",
                                          "source.js", "store.js", "loading.js",    "site.js"};
/// Those of pages that stream a compact file by ranges.
constexpr const char* kRangeModules[] = {"file_tree.js", "range_file.js"};
/// That of the element.
constexpr const char* kElementModules[] = {"element.js"};
/// Those of a whole page.
constexpr const char* kPageModules[] = {
    "levels.js",  "status.js", "editor.js", "clip_controls.js", "controls.js", "overlay.js",
    "handles.js", "player.js", "outer.js",  "record.js",        "main.js"};
/// Those of the worker that decodes.
constexpr const char* kWorkerModules[] = {"worker.js"};
constexpr const char* kShaders[] = {"splat.vert",  "splat.frag",  "erf.glsl",     "chord.glsl",
                                    "field.frag",  "slab.frag",   "ranges.frag",  "expected.glsl",
                                    "table.frag",  "finish.frag", "largest.frag", "copy.frag",
                                    "screen.vert", "shade.frag"};

/// Name declared by a line such as "const x = 1;" or "async function x() {".
std::string declared_name(std::string_view line) {
    for (const std::string_view word : {"async ", "function ", "class ", "const "})
        if (line.starts_with(word)) line.remove_prefix(word.size());
    return std::string(line.substr(0, line.find_first_of(" (={;")));
}

/// End of a string, a template or a regular expression that begins at a place of a script.
std::size_t literal_end(std::string_view text, std::size_t at) {
    const char mark = text[at];
    bool in_class = false;
    for (std::size_t n = at + 1; n < text.size(); ++n) {
        if (text[n] == '\\') {
            ++n;
        } else if (mark == '`' && text.substr(n).starts_with("${")) {
            // An expression, which may have literals and braces of its own.
            int depth = 0;
            for (++n;; ++n) {
                if (text[n] == '`' || text[n] == '\'') n = literal_end(text, n) - 1;
                if (text[n] == '{') ++depth;
                if (text[n] == '}' && --depth == 0) break;
            }
        } else if (mark == '/' && (text[n] == '[' || text[n] == ']')) {
            in_class = text[n] == '[';
        } else if (text[n] == mark && !in_class) {
            return n + 1;
        }
    }
    return text.size();
}

bool is_one_of(char mark, std::string_view marks) { return marks.find(mark) != marks.npos; }

/// Whether a line of the preprocessor begins at a place of a shader; private members of scripts begin with '#', too.
bool begins_directive(std::string_view text, std::size_t at) {
    constexpr std::string_view kDirectives[] = {"#ifdef",  "#ifndef",  "#if ",
                                                "#elif",   "#else",    "#endif",
                                                "#define", "#version", "#extension"};
    return std::ranges::any_of(kDirectives, [&](std::string_view name) {
        return text.substr(std::min(at, text.size())).starts_with(name);
    });
}

/// A script or a shader without blanks beside operators and brackets, and without the ends of lines that part nothing.
std::string without_blanks(std::string_view text) {
    constexpr std::string_view kMarks = "=+-*/%<>?:,;{}()[]&|!^~\n";
    std::string kept;
    bool is_directive = false;
    for (std::size_t at = 0; at < text.size();) {
        const char before = kept.empty() ? '\n' : kept.back();
        const bool is_regex = text[at] == '/' && is_one_of(before, "(,=:[!&|?{};\n");
        std::size_t end = at + 1;
        if (text[at] == '\'' || text[at] == '"' || text[at] == '`' || is_regex)
            end = literal_end(text, at);
        const bool begins = before == '\n' && begins_directive(text, at);
        if (begins) end = std::min(text.find('\n', at), text.size());
        const char after = end < text.size() ? text[end] : '\n';
        const bool is_sign = (before == '+' || before == '-') && after == before;
        const bool is_beside = is_one_of(before, kMarks) || is_one_of(after, kMarks);
        // Lines of the preprocessor have ends.
        const bool parts_nothing = !is_directive && !begins_directive(text, end) &&
                                   (is_one_of(before, ";{,([") || after == '}');
        if (text[at] == '\n' ? !parts_nothing : text[at] != ' ' || is_sign || !is_beside)
            kept += text.substr(at, end - at);
        is_directive = begins;
        at = end;
    }
    return kept;
}

/// A file of the page without comments of lines and behind them, and without indentation, which is in no literal there.
std::string without_comments(const std::string& text) {
    std::string kept;
    bool inside = false;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        const std::string_view line = std::string_view(text).substr(at, end - at);
        const std::size_t first = line.find_first_not_of(" \n");
        const std::string_view words = first == line.npos ? std::string_view() : line.substr(first);
        at = end;
        inside = inside || words.starts_with("/*");
        if (!inside && !words.empty() && !words.starts_with("//")) {
            // Two blanks before them: none is in a literal.
            std::string_view code = words.substr(0, words.find("  // "));
            code = code.substr(0, code.find_last_not_of(" \n") + 1);
            kept.append(code) += '\n';
        }
        if (words.find("*/") != words.npos) inside = false;
    }
    return kept;
}

/// Modules as one script: each becomes a function that returns its exports to the later ones.
/// Imports and exported declarations must start a line.
std::string bundle(std::span<const char* const> modules) {
    std::string script;
    for (const char* name : modules) {
        const std::string text = without_comments(web_file(name));
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
            script += "(() => {\n" + without_blanks(body) + "})();\n";
        else
            script += fmt::format("const {{ {} }} = (() => {{\n", exported) + without_blanks(body) +
                      fmt::format("return {{ {} }};\n}})();\n", exported);
    }
    return script;
}

}  // namespace

std::map<std::string, std::string> web::shader_texts() {
    std::map<std::string, std::string> texts;
    for (const char* name : kShaders)
        texts[name] = without_blanks(without_comments(web_file(name)));
    return texts;
}

std::string web::page_style() { return without_comments(web_file("page.css")); }
std::string web::reader_script() { return bundle(kReaderModules); }
std::string web::worker_script() { return bundle(kWorkerModules); }

std::string web::page_script(bool streams, bool ranges) {
    return bundle(kViewModules) + (streams ? bundle(kStreamModules) : "") +
           (ranges ? bundle(kRangeModules) : "") + bundle(kElementModules) + bundle(kPageModules);
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
    std::string end = without_comments(web_file("vog-view.js"));
    end.erase(0, end.find('\n', end.rfind("\nimport ") + 1) + 1);  // all is in this module
    return "// vog-view.js: the element <vog-view> (docs/web_element.md of vog).\n" +
           reader_script() + worker_script() + bundle(kViewModules) + bundle(kStreamModules) +
           bundle(kRangeModules) + bundle(kElementModules) +
           "const shaders = " + Json(shader_texts()).dump() + ";\nconst defaults = " + page.dump() +
           ";\n" + end;
}

}  // namespace vog
