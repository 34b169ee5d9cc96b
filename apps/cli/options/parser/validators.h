// validators.h: Options with checks of their values, whose messages name value and bound; groups of options, and those of every run.
#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "vog/conversion_schema.h"

namespace vog::cli {

/// Adds an option, and its default to the help unless that is 0, -1 or empty.
/// values  OptionValues::text
template <class Value>
CLI::Option* add_value(CLI::App& command, const std::string& name, Value& value,
                       const std::string& values, const std::string& text) {
    CLI::Option* option = command.add_option(name, value, text);
    const OptionValues all{values, std::is_integral_v<Value>};
    const auto refusal = [all](const std::string& word) {
        return all.fit(word) ? "" : fmt::format("{}: expected {}", word, all.expected());
    };
    if (const std::vector<std::string> words = all.words(); !words.empty())
        option->check(CLI::IsMember(words));
    else if (!values.empty())
        option->check(CLI::Validator(refusal, values));
    if constexpr (std::is_same_v<Value, std::string>)
        option->default_str(value);
    else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>)
        option->default_str(value > 0 ? fmt::format("{:g}", double(value)) : "");
    return option;
}

/// Options that are added while it lives belong to a group of the help.
class OptionGroup {
  public:
    OptionGroup(CLI::App& command, const std::string& name)
        : defaults_(*command.option_defaults()), before_(defaults_.get_group()) {
        defaults_.group(name);
    }
    ~OptionGroup() { defaults_.group(before_); }
    OptionGroup(const OptionGroup&) = delete;
    OptionGroup& operator=(const OptionGroup&) = delete;

  private:
    CLI::OptionDefaults& defaults_;
    std::string before_;
};

/// Adds --threads.
inline void add_threads_option(CLI::App& command, int& threads) {
    add_value(command, "--threads", threads, "[0, inf)", "Number of threads; 0: one per core");
}
/// Adds --threads, --json and --verbose.
inline void add_run_options(CLI::App& command, int& threads, bool& json, bool& verbose) {
    add_threads_option(command, threads);
    command.add_flag("--json", json, "Print a single JSON object");
    command.add_flag("--verbose,-v", verbose, "Print the time of each stage to standard error");
}

}  // namespace vog::cli
