// validators.h: Checks of option values with messages that name the value and the bound; groups of options, and those of every run.
#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <string>

namespace vog::cli {

/// A finite number, at least 0, or above 0.
inline CLI::Validator number_from_zero(bool above) {
    const std::string expected = above ? "a number > 0" : "a number >= 0";
    const auto check = [above, expected](const std::string& text) -> std::string {
        double value = 0;
        const bool number = CLI::detail::lexical_cast(text, value);
        const bool fits = number && (above ? value > 0 : value >= 0) && value < 1e300;
        return fits ? std::string{} : fmt::format("{}: expected {}", text, expected);
    };
    return {check, above ? "> 0" : ">= 0", above ? "POSITIVE" : "NONNEGATIVE"};
}
inline CLI::Validator positive_number() { return number_from_zero(true); }
inline CLI::Validator non_negative_number() { return number_from_zero(false); }

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
    command.add_option("--threads", threads, "Number of threads; 0: one per core")
        ->check(non_negative_number())
        ->capture_default_str();
}
/// Adds --threads, --json and --verbose.
inline void add_run_options(CLI::App& command, int& threads, bool& json, bool& verbose) {
    add_threads_option(command, threads);
    command.add_flag("--json", json, "Print a single JSON object");
    command.add_flag("--verbose,-v", verbose, "Print the time of each stage to standard error");
}

}  // namespace vog::cli
