// script.cpp: actions of viewer scripts and their parser.
#include "script/script.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "vog/error.h"

namespace vog::viewer {

namespace {

/// Arguments of an action, one letter each: n number, w any word, s "on" or "off", c coordinate
/// (number or per cent); ? the rest is optional; * any further words.
struct Form {
    const char* verb;
    const char* words;
    const char* usage;
};
constexpr Form kForms[] = {
    {"size", "nn", "size WIDTH HEIGHT"},
    {"scale", "n", "scale FACTOR"},
    {"panels", "s", "panels on|off"},
    {"overlay", "s", "overlay on|off"},
    {"colorbar", "s", "colorbar on|off"},
    {"help", "s", "help on|off"},
    {"move", "cc", "move X Y"},
    {"drag", "wcccc", "drag [shift+|ctrl+|alt+]left|middle|right X0 Y0 X1 Y1"},
    {"click", "wcc", "click [shift+|ctrl+|alt+]left|middle|right X Y"},
    {"wheel", "n?cc", "wheel STEPS [X Y]"},
    {"key", "w", "key [shift+|ctrl+|alt+]NAME"},
    {"press", "w*", "press WIDGET"},
    {"slide", "wn", "slide WIDGET SHARE"},
    {"view", "w", "view paper|+x|-x|+y|-y|+z|-z|fit|reset"},
    {"orbit", "nn", "orbit RIGHT UP (degrees)"},
    {"look", "nn", "look RIGHT UP (degrees)"},
    {"roll", "n", "roll DEGREES"},
    {"pan", "nn", "pan RIGHT UP (shares of the height)"},
    {"zoom", "n", "zoom FACTOR"},
    {"fly", "nnn", "fly RIGHT UP AHEAD (radii)"},
    {"fov", "n", "fov DEGREES"},
    {"orthographic", "s", "orthographic on|off"},
    {"camera", "w", "camera FILE.json"},
    {"save-camera", "w", "save-camera FILE.json"},
    {"tf", "w", "tf NAME|FILE.json"},
    {"save-tf", "w", "save-tf FILE.json"},
    {"opacity", "w*", "opacity off | opacity V:OPACITY..."},
    {"range", "nn", "range LOW HIGH"},
    {"gamma", "n", "gamma EXPONENT"},
    {"invert", "s", "invert on|off"},
    {"blend", "s", "blend on|off"},
    {"background", "w", "background R,G,B|transparent"},
    {"exposure", "w", "exposure EXTINCTION|auto"},
    {"renderer", "w", "renderer gl|splat|trace|cuda|optix|reference"},
    {"against", "w", "against gl|splat|trace|cuda|optix|reference"},
    {"split", "w", "split SHARE|off"},
    {"difference", "w", "difference LIMIT|off"},
    {"level", "w*", "level NUMBER|NAME|coarsest|finest"},
    {"parts", "n", "parts PIXELS"},
    {"subframes", "n", "subframes COUNT"},
    {"open", "w*", "open FILE..."},
    {"wait", "?n", "wait [SECONDS]"},
    {"screenshot", "w", "screenshot FILE.png"},
    {"picture", "w", "picture FILE.png"},
    {"depth", "w", "depth FILE.exr"},
    {"turntable", "wn", "turntable FOLDER PICTURES"},
};

bool is_place(const std::string& text) {
    return is_number(text.ends_with('%') ? text.substr(0, text.size() - 1) : text);
}
bool fits(const char* form, const std::vector<std::string>& words) {
    std::size_t n = 0;
    bool optional = false;
    for (const char* f = form; *f; ++f) {
        if (*f == '*') return true;
        if (*f == '?') {
            optional = true;
            continue;
        }
        if (n == words.size()) return optional;
        const std::string& word = words[n++];
        if ((*f == 'n' && !is_number(word)) || (*f == 'c' && !is_place(word)) ||
            (*f == 's' && word != "on" && word != "off"))
            return false;
    }
    return n == words.size();
}

}  // namespace

bool is_number(const std::string& text, double* value) {
    double parsed = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (value) *value = parsed;
    return code == std::errc{} && end == text.data() + text.size() && std::isfinite(parsed);
}
double number(const std::string& text) {
    double value = 0;
    is_number(text, &value);
    return value;
}
std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

std::vector<Action> read_script(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw Error(fmt::format("{}: cannot read this script", file.string()));
    std::vector<Action> actions;
    std::string line;
    for (int n = 1; std::getline(in, line); ++n) {
        std::istringstream words(line.substr(0, line.find('#')));
        Action action{n, {}, {}};
        if (!(words >> action.verb)) continue;
        for (std::string word; words >> word;) action.words.push_back(word);
        const auto* form = std::find_if(std::begin(kForms), std::end(kForms),
                                        [&](const Form& f) { return action.verb == f.verb; });
        if (form == std::end(kForms))
            throw Error(fmt::format("{}:{}: no action '{}' (docs/viewer.md lists them)",
                                    file.string(), n, action.verb));
        if (!fits(form->words, action.words))
            throw Error(fmt::format("{}:{}: '{}', expected: {}", file.string(), n,
                                    action.verb + " " + joined(action.words), form->usage));
        actions.push_back(std::move(action));
    }
    return actions;
}

}  // namespace vog::viewer
