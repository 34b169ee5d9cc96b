// option_effects.cpp: The table of effects, and the refusals that it makes.
#include "options/option_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <sstream>

#include "options/conversion_options.h"
#include "options/parser/settings.h"
#include "options/request_options.h"

namespace vog::cli {

namespace {

/// Options that have an effect only with some values of a fact.
struct Row {
    std::string commands;  ///< "" for all that have the options
    std::string
        options;  ///< "--eye --up", "--scale=symmetric" (this value only), or the group "[View]"
    std::string fact;       ///< of Facts, or an option, whose value counts
    std::string values;     ///< "volume maximum"; "*": given with any value; "-": not given
    std::string instead{};  ///< what serves the purpose otherwise
    std::string of{};       ///< quantities, or conversions, that the row is for; empty: all
};

constexpr const char* kModels = ".ply .vogz models/";
constexpr const char* kData = "volumes particles text";

// The first row that refuses an option says why: general reasons stand first.
const std::vector<Row> kRows = {
    // Inputs.
    {"", "--mask --combine --level-set-to-fog --set.background-value", "input", "volumes"},
    {"", "--skip-nonfinite", "input", "volumes particles text models"},
    {"", "--clip-negative", "input", "volumes particles text"},
    {"", "--clip-negative", "--set.background-value", "-"},
    {"convert render page pack export view info evaluate", "--grid", "input", "volumes particles"},
    {"convert", "--periodic", "input", "particles text volumes"},
    {"", "--columns --value --radius --neighbours", "input", "particles text"},
    {"render page pack export view", "--periodic", "input", "particles text"},
    {"", "--columns", "input", "text"},
    {"", "--neighbours", "--radius", "adaptive auto"},
    {"", "--mask", "--combine", "- mesh"},
    // Cameras.
    {"", "--view --distance --fov --frame --eye --look-at --up", "--camera", "-"},
    {"", "--frame", "--view", "- +x -x +y -y +z -z"},
    {"render", "--frame", "--axes", "-"},
    {"", "--view --distance", "--eye", "-"},
    {"", "--fov", "--orthographic", "-"},
    // Outputs.
    {"page", "--set.rounding --set.field-rounding --site --memory --set.scratch", "output", "site"},
    {"page", "--set.levels --from", "output", ".html"},
    {"page", "--no-fields --budget --set.levels --precise", "--from", "-"},
    {"page pack", "--no-fields", "input", "volumes models compact-models"},
    {"export", "--as", "output", "3dgs volprim surface"},
    {"export", "--iso --voxel-size", "output", ".stl .obj surface"},
    {"export", "--voxel-size", "input", "models compact-models particles text"},
    {"export", "--extinction --budget --no-fields", "output", ".spz .glb .usda 3dgs volprim"},
    {"export", "--units --tf --field --up", "output", ".spz .glb .usda 3dgs"},
    // Conversions.
    {"convert", "--method --field --radius", "output", kModels},
    {"convert", "--no-fields --no-hierarchy --measure", "output", kModels},
    {"convert", "--value", "values", kModels},
    {"convert", "--no-hierarchy", "output", ".ply models/"},
    {"convert", "--method --field", "input", kData},
    {"convert", "--again", "output", "models/"},
    {"convert", "--measure --split", "input", "volumes"},
    {"convert", "--no-fields", "input", "volumes models compact-models"},
    {"convert", "--labels", "input", "volumes"},
    {"convert", "--labels", "--for", "-"},
    {"convert", "--labels", "--no-fields", "-"},
    {"convert", "--lod", "--method", "moments", "", "paper-particles"},
    {"convert", "--for", "program", "vog", "vog convert"},
    {"convert", "--no-fields", "--for", "-"},
    {"convert", "--no-fields", "--field", "-"},
    {"convert page", "--level-set-to-fog --clip-negative --set.background-value", "--measure",
     "density"},
    {"page", "[Conversion by moments (--method moments)]", "input", "volumes"},  // vog-mpi
    {"page", "--lod --measure", "input", "volumes"},
    // What is shown.
    {"render", "--set.fps", "output", "film"},
    {"render", "--steps", "--turntable", "*"},
    {"render", "--steps", "inputs", "several"},
    {"view", "--steps", "input", "models compact-models"},
    {"view", "--headless", "--script", "*"},
    {"render", "--depth-out", "show", "T column", "--values-out FILE.exr"},
    {"render", "--range --scale --set.least-column", "output", "picture film"},
    {"render", "--color-bar --axes --scale-bar --title --tf --background --blend", "output",
     "picture film"},
    // Other commands.
    {"voxelize", "--voxel-size", "--like", "-"},
    {"voxelize", "--grid --within", "--like", "*"},
    {"voxelize", "--memory --set.scratch", "output", ".vdb"},
    {"", "--set.scratch", "--memory", "*"},
    {"compare", "--tf --extinction", "input", "depth-images"},
    {"compare", "--diff --set.diff-limit", "input", "pictures depth-images"},
    {"compare", "--set.diff-limit", "--diff", "*"},
    {"evaluate", "--voxels --show=volume", "program", "vog", "vog evaluate"},
    {"sample", "--half", "input", "cloud explosion fire head amr"},
};

std::vector<std::string> words(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}
bool contains(const std::vector<std::string>& all, const std::string& one) {
    return std::ranges::find(all, one) != all.end();
}

bool is_one_of(const Facts& facts, const char* fact, const std::vector<std::string>& values) {
    const auto found = facts.find(fact);
    return found != facts.end() && contains(values, found->second);
}

/// The rows of a rule between options. A list whose rows have two options has two rows.
void add_rule(std::vector<Row>& rows, const OptionRule& rule,
              const std::function<std::string(const std::string&)>& options_of) {
    const auto options = [&](const std::string& keys) {
        std::vector<std::string> all;
        for (const std::string& key : words(keys)) {
            const std::size_t equals = std::min(key.find('='), key.size());
            const std::string option = options_of(key.substr(0, equals)) + key.substr(equals);
            if (!contains(all, option)) all.push_back(option);
        }
        return fmt::format("{}", fmt::join(all, " "));
    };
    const bool is_fact = rule.beside == "show" || rule.beside == "renderer";
    const std::string given = is_fact ? rule.beside : options(rule.beside);
    for (const std::string& fact :
         rule.values == "-" ? words(given) : std::vector<std::string>{given})
        rows.push_back(
            {is_fact ? "render" : "", options(rule.members), fact, rule.values, "", rule.of});
}

/// The rows of an option of conversions: its methods, outputs and inputs.
void add_conversion_rows(std::vector<Row>& rows, const ConversionOption& one) {
    const std::string option = conversion_option(one.key);
    const auto has = [of = words(one.of)](const std::string& a, const std::string& b) {
        return contains(of, a) || contains(of, b);
    };
    if (has("moments", "particles") != has("paper", "paper-particles"))
        rows.push_back(
            {"convert", option, "--method", has("moments", "particles") ? "moments" : "paper"});
    if (one.key != "value" && one.key != "radius")
        rows.push_back({"convert", option, "output", kModels});
    rows.push_back({"convert", option, "input",
                    fmt::format("{}{}{}", has("moments", "paper") ? "volumes " : "",
                                has("particles", "paper-particles") ? "particles text " : "",
                                has("models", "models") ? "models compact-models" : "")});
}

/// The table, with the rules, quantities and renderers of the members of requests.
const std::vector<Row>& rows() {
    static const std::vector<Row> all = [] {
        std::vector<Row> joined = kRows;
        for (const OptionRule& rule : request_rules()) add_rule(joined, rule, options_of);
        for (const ConversionOption& one : conversion_schema()) add_conversion_rows(joined, one);
        for (const OptionRule& rule : conversion_rules()) add_rule(joined, rule, conversion_option);
        for (const RequestMember& member : request_schema()) {
            const std::string options = options_of(member.key);
            // Pages and windows have the colours of T beside those of what they show first.
            const bool of_render = member.shows == "T" || member.key == "units";
            if (!member.shows.empty())
                joined.push_back({of_render ? "render" : "", options, "show", member.shows});
            if (!member.renderers.empty())
                joined.push_back({"render", options, "renderer", member.renderers});
        }
        return joined;
    }();
    return all;
}

/// Value of a fact or an option; "-": not given and without a default. None: not known, or of other commands.
std::optional<std::string> value_of(const std::string& fact, const GivenOptions& command,
                                    const Facts& facts) {
    if (!fact.starts_with("--")) {
        const auto found = facts.find(fact);
        return found == facts.end() ? std::nullopt : std::optional(found->second);
    }
    if (fact.find(' ') != fact.npos) {  // one of several options, or of their values
        std::optional<std::string> any;
        for (const std::string& one : words(fact)) {
            const std::size_t equals = one.find('=');
            std::optional<std::string> value = command.value(one.substr(0, equals));
            if (value && equals != one.npos && *value != one.substr(equals + 1)) value = "-";
            if (value && (!any || *any == "-")) any = value;
        }
        return any;
    }
    const std::optional<std::string> value = command.value(fact);
    const bool angles = fact == "--view" && value && value->find(',') != value->npos;
    return angles ? "-" : value;  // which frames as no --view does
}

/// Whether an option of a row is given: by name, with a value, or as one of a group.
std::vector<std::string> given_options(const Row& row, const GivenOptions& command) {
    std::vector<std::string> given;
    const std::string options = row.options;
    if (options.starts_with('[')) return command.names(options.substr(1, options.size() - 2));
    for (const std::string& word : words(options)) {
        const std::size_t equals = word.find('=');
        const std::vector<std::string> values = command.values(word.substr(0, equals));
        if (values.empty()) continue;
        if (equals == word.npos)
            given.push_back(word);
        else if (values.front() == word.substr(equals + 1))
            given.push_back(word.substr(0, equals) + " " + word.substr(equals + 1));
    }
    return given;
}

/// "column, mean or deviation"
std::string listed(const std::vector<std::string>& all) {
    std::string text;
    for (std::size_t n = 0; n < all.size(); ++n)
        text += (n == 0 ? "" : n + 1 < all.size() ? ", " : " or ") + all[n];
    return text;
}

/// Values of a fact as a user writes them: "--show volume or maximum", "-o FILE.html or FOLDER/", "models".
std::string spelled(const std::string& fact, std::vector<std::string> values) {
    static const std::map<std::string, std::string> prefixes = {
        {"show", "--show "}, {"renderer", "--renderer "}, {"output", "-o "}, {"values", "-o "}};
    static const std::map<std::string, std::string> names = {{"site", "FOLDER/ (a site)"},
                                                             {"models/", "FOLDER/"},
                                                             {"3dgs", "FILE.ply --as 3dgs"},
                                                             {"volprim", "FILE.ply --as volprim"},
                                                             {"surface", "FILE.ply --iso VALUE"},
                                                             {"picture", "FILE.png"},
                                                             {"film", "FILE.mp4"},
                                                             {"text", "particles in text files"},
                                                             {"several", "several inputs"},
                                                             {"one", "one input"}};
    if (contains(values, "particles")) std::erase(values, "text");
    for (std::string& value : values) {
        const auto name = names.find(value);
        if (name != names.end())
            value = name->second;
        else if (value.starts_with('.'))
            value = "FILE" + value;
        else if (fact == "input")
            std::ranges::replace(value, '-', ' ');
    }
    if (fact.starts_with("--"))
        return fact + (setting("") == fact.substr(0, setting("").size()) ? "=" : " ") +
               listed(values);
    const auto prefix = prefixes.find(fact);
    return (prefix == prefixes.end() ? "" : prefix->second) + listed(values);
}

std::string refusal(const Row& row, const std::string& option, const std::string& actual,
                    const Facts& facts, const GivenOptions& command) {
    std::vector<std::string> values = words(row.values);
    const std::string fact = row.fact;
    const bool of_show = is_one_of(facts, "show", words(row.of));
    const std::string shown = of_show ? fmt::format("--show {} ", facts.at("show")) : "";
    if (values == std::vector<std::string>{"-"})
        return fmt::format("{} and {} exclude each other", option, fact);
    if (contains(values, "*")) {
        std::vector<std::string> others = words(fact);
        std::erase_if(others, [&](const std::string& one) {
            return !command.value(one.substr(0, one.find('=')));
        });
        for (std::string& one : others) std::ranges::replace(one, '=', ' ');
        return fmt::format("{} needs {}", option, listed(others));
    }
    std::erase(values, "-");
    if (actual == "-") return fmt::format("{} needs {}", option, shown + spelled(fact, values));
    return fmt::format("{} has no effect with {}; {}", option, shown + spelled(fact, {actual}),
                       !row.instead.empty()
                           ? fmt::format("use {}", row.instead)
                           : fmt::format("it works with {}", shown + spelled(fact, values)));
}

}  // namespace

std::string input_fact(FileKind kind, const std::vector<std::string>& inputs) {
    if (kind == FileKind::volume) return "volumes";
    if (kind == FileKind::model) {
        // Compact models and sites hold finite numbers.
        const bool compact = std::ranges::all_of(inputs, [](const std::string& input) {
            return extension_of(input) == ".vogz" || is_site(input);
        });
        return compact ? "compact-models" : "models";
    }
    const bool binary = std::ranges::any_of(inputs, [](const std::string& input) {
        const std::string extension = extension_of(input);
        return extension == ".vdb" || extension == ".hdf5" || extension == ".h5" ||
               extension == ".hdf";
    });
    return binary ? "particles" : "text";
}

void require_effects(const GivenOptions& command, const Facts& facts) {
    Facts all = facts;
    all["program"] = command.program();
    for (const Row& row : rows()) {
        const std::vector<std::string> commands = words(row.commands);
        if (!commands.empty() && !contains(commands, command.command())) continue;
        const std::vector<std::string> of = words(row.of);
        if (!of.empty() && !is_one_of(all, "show", of) && !is_one_of(all, "conversion", of))
            continue;
        const std::vector<std::string> values = words(row.values);
        // What an option needs may stand in a request's file, whose members are checked together.
        if (contains(values, "*") && command.has("--request")) continue;
        const auto actual = value_of(row.fact, command, all);
        if (!actual || contains(values, *actual) || (contains(values, "*") && *actual != "-"))
            continue;
        // An option that excludes others does so where it is given, whatever its default.
        if (contains(values, "-") && row.fact.starts_with("--") && !command.has(row.fact)) continue;
        for (const std::string& option : given_options(row, command))
            throw UsageError(refusal(row, option, *actual, all, command));
    }
}

}  // namespace vog::cli
