// script.h: a session written down: one action a line. docs/viewer.md lists the actions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vog::viewer {

/// One line.
struct Action {
    int line = 0;
    std::string verb;
    std::vector<std::string> words;
};

/// '#' begins a comment. throws vog::Error for a missing file and for every line that is no action,
/// with its number: nothing of a script is played that cannot be read to its end
std::vector<Action> read_script(const std::filesystem::path& file);

/// The number a word stands for; 0 where it is none.
double number(const std::string& text);
bool is_number(const std::string& text, double* value = nullptr);
/// "a b c".
std::string joined(const std::vector<std::string>& words);

}  // namespace vog::viewer
