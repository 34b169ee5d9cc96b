// value_options.cpp: help and evaluation of the options of volume rendering by value.
#include "options/value_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shared/inputs.h"
#include "shared/validators.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

constexpr const char* kValueGroup = "Volume rendering (--show volume)";

struct NamedColor {
    const char* name;
    std::array<float, 3> rgb;
};
/// Colours by their names in CSS.
constexpr NamedColor kColors[] = {{"black", {0, 0, 0}},         {"white", {1, 1, 1}},
                                  {"gray", {0.5f, 0.5f, 0.5f}}, {"silver", {.75f, .75f, .75f}},
                                  {"red", {1, 0, 0}},           {"green", {0, 0.5f, 0}},
                                  {"lime", {0, 1, 0}},          {"blue", {0, 0, 1}},
                                  {"navy", {0, 0, 0.5f}},       {"yellow", {1, 1, 0}},
                                  {"orange", {1, 0.647f, 0}},   {"brown", {0.647f, 0.165f, 0.165f}},
                                  {"cyan", {0, 1, 1}},          {"magenta", {1, 0, 1}},
                                  {"purple", {0.5f, 0, 0.5f}},  {"pink", {1, 0.753f, 0.796f}},
                                  {"ivory", {1, 1, 0.941f}},    {"tan", {0.824f, 0.706f, 0.549f}}};

/// Colour of a name or #rrggbb; none for other texts.
std::optional<std::array<float, 3>> color_named(const std::string& text) {
    for (const NamedColor& color : kColors)
        if (text == color.name) return color.rgb;
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    if (text.find_first_not_of("0123456789abcdefABCDEF", 1) != text.npos) return std::nullopt;
    const auto part = [&](std::size_t at) {
        return static_cast<float>(std::stoi(text.substr(at, 2), nullptr, 16)) / 255;
    };
    return std::array<float, 3>{part(1), part(3), part(5)};
}

std::string color_names() {
    std::string names;
    for (const NamedColor& color : kColors)
        names += (names.empty() ? "" : ", ") + std::string(color.name);
    return names;
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text)
        if (c == ',')
            parts.emplace_back();
        else
            parts.back() += c;
    return parts;
}

/// A finite number, the whole text. throws CLI::ValidationError with the option for others
double number_of(const std::string& option, const std::string& text) {
    const std::vector<double> numbers = parse_numbers(text);
    if (numbers.size() != 1)
        throw CLI::ValidationError(fmt::format("{}: '{}', expected a number", option, text));
    return numbers[0];
}

void set_color(const std::string& option, const std::string& text, ValueBand& band) {
    const auto color = color_named(text);
    if (!color)
        throw CLI::ValidationError(fmt::format("{}: colour '{}', expected #rrggbb or one of {}",
                                               option, text, color_names()));
    band.r = (*color)[0], band.g = (*color)[1], band.b = (*color)[2];
}

ValueBand parse_band(const std::string& text) {
    const std::string option = "--band " + text;
    const std::vector<std::string> parts = split(text);
    if (parts.size() != 4) throw CLI::ValidationError(option + ": expected LO,HI,COLOUR,OPACITY");
    ValueBand band;
    band.lower = number_of(option, parts[0]), band.upper = number_of(option, parts[1]);
    set_color(option, parts[2], band);
    band.opacity = number_of(option, parts[3]);
    if (!(band.lower < band.upper))
        throw CLI::ValidationError(option + ": expected the first value below the second");
    if (!(band.opacity >= 0 && band.opacity <= 1))
        throw CLI::ValidationError(
            fmt::format("{}: opacity {}, expected in [0, 1]", option, band.opacity));
    return band;
}

ValueBand parse_iso(const std::string& text) {
    const std::string option = "--iso " + text;
    const std::vector<std::string> parts = split(text);
    if (parts.size() != 2) throw CLI::ValidationError(option + ": expected VALUE,COLOUR");
    ValueBand band;
    band.lower = number_of(option, parts[0]);
    band.upper = std::numeric_limits<double>::infinity();
    set_color(option, parts[1], band);
    band.opacity = kMostOpacity;
    return band;
}

}  // namespace

void add_value_options(CLI::App& command, ValueArguments& arguments) {
    const OptionGroup grouped(command, kValueGroup);
    command.add_option("--window", arguments.window,
                       "Window C,W of medical pictures: grey and opacity rise over the values from "
                       "C-W/2 to C+W/2");
    command
        .add_option(
            "--band", arguments.bands,
            "Band LO,HI,COLOUR,OPACITY: values from LO to below HI have one colour (#rrggbb "
            "or a name: " +
                color_names() + ") and opacity; may be given again")
        ->allow_extra_args(false);
    command
        .add_option(
            "--iso", arguments.isos,
            "Surface VALUE,COLOUR: values from VALUE on are opaque, up to the next --iso or "
            "--band; may be given again")
        ->allow_extra_args(false);
    command.add_option("--threshold", arguments.threshold, "Value below which nothing is shown");
    command.add_option(
        "--unit-distance", arguments.unit_distance,
        "World length over which opacities hold: extinction = -ln(1 - opacity) / unit "
        "distance. Default: the file's of --tf, else a hundredth of the box's diagonal; "
        "for the name of a colour map the one at which data of the median value, spread evenly "
        "over the silhouette of their box, have an optical depth of 2");
    command.add_option(
        "--light", arguments.light,
        "Light of Blinn and Phong on the gradient of the values: head (from the eye) or "
        "a direction of the world X,Y,Z towards the light");
    const VolumeLook look;
    command.add_option("--light-weights", arguments.light_weights,
                       fmt::format("Weights of --light and the power of highlights: "
                                   "AMBIENT,DIFFUSE,SPECULAR,POWER; default: {},{},{},{}",
                                   look.ambient, look.diffuse, look.specular, look.power));
    command
        .add_option("--slabs", arguments.slabs,
                    "Depth slabs a tile of a model's picture by splat, cuda or optix: more lie "
                    "nearer to exact order (--renderer trace), and cost memory and time; default "
                    "32, of --show maximum 128")
        ->check(CLI::Range(1, 1024));
}

std::optional<std::pair<double, double>> window_of(const ValueArguments& arguments) {
    if (arguments.window.empty()) return std::nullopt;
    const std::vector<double> c = parse_numbers(arguments.window);
    if (c.size() != 2 || !(c[1] > 0))
        throw CLI::ValidationError(fmt::format(
            "--window {}: expected C,W, a centre and a width above 0", arguments.window));
    return std::pair{c[0], c[1]};
}

std::vector<ValueBand> bands_of(const ValueArguments& arguments) {
    std::vector<ValueBand> bands;
    for (const std::string& text : arguments.bands) bands.push_back(parse_band(text));
    for (const std::string& text : arguments.isos) bands.push_back(parse_iso(text));
    std::ranges::sort(bands, {}, &ValueBand::lower);
    for (std::size_t n = 0; n + 1 < bands.size(); ++n) {
        if (std::isinf(bands[n].upper)) bands[n].upper = bands[n + 1].lower;
        if (bands[n + 1].lower < bands[n].upper || !(bands[n].lower < bands[n].upper))
            throw CLI::ValidationError(
                fmt::format("--band, --iso: the one from {} overlaps the one from {} to {}",
                            bands[n + 1].lower, bands[n].lower, bands[n].upper));
    }
    return bands;
}

VolumeLook look_of(const ValueArguments& arguments) {
    VolumeLook look;
    look.light = !arguments.light.empty();
    if (look.light && arguments.light != "head") {
        const std::vector<double> c = parse_numbers(arguments.light);
        if (c.size() != 3 || (c[0] == 0 && c[1] == 0 && c[2] == 0))
            throw CLI::ValidationError(
                fmt::format("--light {}: expected head or a direction X,Y,Z", arguments.light));
        look.towards_light = {c[0], c[1], c[2]};
    }
    if (!arguments.light_weights.empty()) {
        const std::vector<double> c = parse_numbers(arguments.light_weights);
        if (c.size() != 4)
            throw CLI::ValidationError(
                fmt::format("--light-weights {}: expected AMBIENT,DIFFUSE,SPECULAR,POWER",
                            arguments.light_weights));
        look.ambient = c[0], look.diffuse = c[1], look.specular = c[2], look.power = c[3];
    }
    try {
        validate(look);
    } catch (const Error& error) {
        throw CLI::ValidationError(fmt::format("--light-weights: {}", error.what()));
    }
    return look;
}

void check_value_options(const ValueArguments& arguments) {
    const auto refuse = [](const std::string& option, const std::string& reason) {
        throw CLI::ValidationError(option + ": " + reason);
    };
    if (arguments.threshold && !std::isfinite(*arguments.threshold))
        refuse("--threshold", "expected a finite value");
    if (const auto& length = arguments.unit_distance;
        length && !(*length > 0 && std::isfinite(*length)))
        refuse(fmt::format("--unit-distance {}", *length), "expected a finite length > 0");
    (void)window_of(arguments);
    (void)bands_of(arguments);
    (void)look_of(arguments);
}

}  // namespace vog::cli
