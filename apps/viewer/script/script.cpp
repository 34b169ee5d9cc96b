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

constexpr double kAny = 1e6;         ///< bound of numbers that may be anything
constexpr double kLeast = 1e-6;      ///< bound of factors above 0
constexpr double kMostSide = 16384;  ///< as require_size has it

/// Arguments of an action, one letter each: n number, i whole number, o number or "off", a number or
/// "auto", w any word, s "on" or "off", c coordinate (number or per cent), f file with `extension`;
/// ? the rest is optional; * any further words.
struct Form {
    const char* verb;
    const char* words;
    const char* usage;
    double low = -kAny, high = kAny;  ///< bounds of all its numbers
    const char* extension = "";
};
constexpr Form kForms[] = {
    {"size", "ii", "size WIDTH HEIGHT", 1, kMostSide},
    {"scale", "n", "scale FACTOR", 0.1, 4},
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
    {"slide", "wn", "slide WIDGET SHARE", 0, 1},
    {"view", "w", "view paper|+x|-x|+y|-y|+z|-z|fit|reset"},
    {"orbit", "nn", "orbit RIGHT UP (degrees)"},
    {"look", "nn", "look RIGHT UP (degrees)"},
    {"roll", "n", "roll DEGREES"},
    {"pan", "nn", "pan RIGHT UP (shares of the height)"},
    {"zoom", "n", "zoom FACTOR", kLeast, kAny},
    {"fly", "nnn", "fly RIGHT UP AHEAD (radii)"},
    {"fov", "n", "fov DEGREES", 0.001, 179.999},
    {"orthographic", "s", "orthographic on|off"},
    {"camera", "w", "camera FILE.json"},
    {"save-camera", "f", "save-camera FILE.json", 0, 0, ".json"},
    {"zup", "s", "zup on|off"},
    {"show", "w?w", "show QUANTITY [FIELD]"},
    {"values", "a?nw", "values LOW HIGH [log] | values auto", -1e300, 1e300},
    {"clip", "o?nnnnn", "clip X0 Y0 Z0 X1 Y1 Z1 | clip off", -1e300, 1e300},
    {"light", "s", "light on|off"},
    {"shadows", "s", "shadows on|off"},
    {"occlusion", "s", "occlusion on|off"},
    {"points", "w*", "points VALUE:OPACITY..."},
    {"window", "nn", "window CENTER WIDTH", -1e300, 1e300},
    {"unit-distance", "n", "unit-distance LENGTH", 1e-300, 1e300},
    {"undo", "", "undo"},
    {"redo", "", "redo"},
    {"axes", "s", "axes on|off"},
    {"tf", "w", "tf NAME|FILE.json"},
    {"save-tf", "f", "save-tf FILE.json", 0, 0, ".json"},
    {"opacity", "w*", "opacity off | opacity V:OPACITY..."},
    {"range", "nn", "range LOW HIGH", 0, 1},
    {"gamma", "n", "gamma EXPONENT", 0.1, 10},
    {"invert", "s", "invert on|off"},
    {"blend", "s", "blend on|off"},
    {"background", "w", "background R,G,B|transparent"},
    {"exposure", "a", "exposure EXTINCTION|auto", 1e-30, 1e30},
    {"renderer", "w", "renderer gl|splat|trace|cuda|optix|reference"},
    {"against", "w", "against gl|splat|trace|cuda|optix|reference"},
    {"split", "o", "split SHARE|off", 0, 1},
    {"difference", "o", "difference LIMIT|off", 0.001, 1},
    {"level", "w*", "level NUMBER|NAME|coarsest|finest"},
    {"parts", "n", "parts PIXELS", 0, kAny},
    {"subframes", "i", "subframes COUNT", 1, 4096},
    {"open", "w*", "open FILE..."},
    {"wait", "?n", "wait [SECONDS]", 0, kAny},
    {"screenshot", "f", "screenshot FILE.png", 0, 0, ".png"},
    {"picture", "f", "picture FILE.png", 0, 0, ".png"},
    {"depth", "f", "depth FILE.exr", 0, 0, ".exr"},
    {"turntable", "wi?w", "turntable FOLDER|FILM PICTURES [time]", 1, 9999},
    {"step", "i", "step NUMBER", 1, kAny},
    {"play", "s", "play on|off"},
    {"speed", "n", "speed STEPS_PER_SECOND", 0.01, 1000},
    {"loop", "s", "loop on|off"},
    {"steps", "w", "steps FOLDER|FILM"},
    {"window-light", "s", "window-light on|off"},
};

bool is_place(const std::string& text) {
    return is_number(text.ends_with('%') ? text.substr(0, text.size() - 1) : text);
}
/// What is wrong with an argument of this letter; empty: nothing.
std::string fault(char letter, const std::string& word, const Form& form) {
    const auto is_one_of = [&](const char* letters) {
        return std::string_view(letters).find(letter) != std::string_view::npos;
    };
    double value = 0;
    if (is_one_of("nioa")) {
        if ((letter == 'o' && word == "off") || (letter == 'a' && word == "auto")) return {};
        const bool whole = letter == 'i';
        if (!is_number(word, &value) || value < form.low || value > form.high ||
            (whole && value != std::floor(value)))
            return fmt::format("{} from {} to {}", whole ? "whole numbers" : "numbers", form.low,
                               form.high);
    }
    if (letter == 'c' && !is_place(word)) return "pixels or per cent";
    if (letter == 's' && word != "on" && word != "off") return "on or off";
    if (letter == 'f' && !word.ends_with(form.extension))
        return fmt::format("a name in {}", form.extension);
    return {};
}
/// What is wrong with an action's arguments; empty: nothing.
std::string fault(const Form& form, const std::vector<std::string>& words) {
    std::size_t n = 0;
    bool optional = false;
    for (const char* letter = form.words; *letter; ++letter) {
        if (*letter == '*') return {};
        if (*letter == '?') {
            optional = true;
            continue;
        }
        if (n == words.size()) return optional ? "" : "more words";
        if (std::string text = fault(*letter, words[n++], form); !text.empty()) return text;
    }
    return n == words.size() ? "" : "fewer words";
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
        if (const std::string expected = fault(*form, action.words); !expected.empty())
            throw Error(fmt::format("{}:{}: '{}', expected {}: {}", file.string(), n,
                                    action.verb + " " + joined(action.words), expected,
                                    form->usage));
        actions.push_back(std::move(action));
    }
    return actions;
}

}  // namespace vog::viewer
