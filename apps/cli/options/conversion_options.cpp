// conversion_options.cpp: options by the table of conversions, with the names and checks of a command line.
#include "options/conversion_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <map>

#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

namespace {

/// Heading of the help; empty: none.
std::string group_of(const ConversionOption& option) {
    const bool moments = option.of.find("moments") != option.of.npos,
               paper = option.of.find("paper") != option.of.npos;
    return moments && paper ? ""
           : paper          ? "Conversion of the paper (--method paper)"
                            : "Conversion by moments (--method moments)";
}

void add_option(CLI::App& command, ConversionOptions& options, const ConversionOption& one) {
    const std::string name = conversion_option(one.key), text = conversion_text(one.key);
    std::visit(
        [&](const auto& place) {
            using Place = std::remove_cvref_t<decltype(place)>;
            if constexpr (std::is_pointer_v<Place>) {
                constexpr bool kFlag = std::is_same_v<Place, bool*>;
                CLI::Option* option = add_value(command, name, *place, kFlag ? "0 1" : one.values,
                                                (kFlag ? "1: " : "") + text);
                if (const std::string group = group_of(one); !group.empty()) option->group(group);
            }
        },
        one.value(options));
}

}  // namespace

std::string conversion_option(const std::string& key) {
    static const std::map<std::string, std::string> named = {{"refine_seconds", "--refine"},
                                                             {"joint_field", "--for"},
                                                             {"measure", setting("measure-error")}};
    if (const auto found = named.find(key); found != named.end()) return found->second;
    std::string name = key;
    std::ranges::replace(name, '_', '-');
    const auto option = std::ranges::find(conversion_schema(), key, &ConversionOption::key);
    return option != conversion_schema().end() && option->rare ? setting(name) : "--" + name;
}

std::string conversion_text(const std::string& key) {
    return spelled(std::ranges::find(conversion_schema(), key, &ConversionOption::key)->text,
                   conversion_option);
}

void add_conversion_options(CLI::App& command, ConversionOptions& options, bool of_page) {
    for (const ConversionOption& one : conversion_schema()) {
        if (one.of.find("particles") == 0 || one.key == "periodic") continue;
        if (of_page && (one.of.starts_with("paper") || one.key.starts_with("joint"))) continue;
        add_option(command, options, one);
    }
}

}  // namespace vog::cli
