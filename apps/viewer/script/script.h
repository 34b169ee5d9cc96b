// script.h: parser of viewer scripts, one action per line; docs/viewer.md lists the actions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vog::viewer {

/// One line of a script.
struct Action {
    int line = 0;  ///< from 1
    std::string verb;
    std::vector<std::string> words;  ///< arguments
};

/// Parses a script; '#' begins a comment.
/// throws vog::Error for a missing file, and for an invalid line, with its number: a script runs
///        only if all its lines are valid
std::vector<Action> read_script(const std::filesystem::path& file);

/// Value of a word; 0 where it is no number.
double number(const std::string& text);
/// Whether a word is a finite number. value  receives it; may be null
bool is_number(const std::string& text, double* value = nullptr);
/// Words joined by blanks: "a b c".
std::string joined(const std::vector<std::string>& words);

}  // namespace vog::viewer
