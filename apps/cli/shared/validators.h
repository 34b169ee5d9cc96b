// validators.h: Checks of option values with messages that name the value and the bound.
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

}  // namespace vog::cli
