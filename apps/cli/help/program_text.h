// program_text.h: texts of commands and options, for manual pages, completion and messages.
#pragma once

#include <string>
#include <vector>

namespace vog::cli {

/// An option or an argument.
struct OptionText {
    std::vector<std::string>
        names;                ///< "--output", "-o"; "--set tree-depth"; of arguments "inputs"
    std::string text, group;  ///< meaning, and heading of the help
    std::string takes;        ///< kind of its value: "TEXT", "INT"; empty: a flag
    std::vector<std::string> choices;  ///< {"moments", "paper"}; empty: other values, too
    std::string interval;              ///< "[0.5, 2]"; empty: any
    std::string standard;              ///< default in words; empty: none
    bool argument = false, required = false, many = false;
    bool setting = false;  ///< stated by --set NAME=VALUE
};
struct CommandText {
    std::string name, text;
    std::vector<OptionText> options;  ///< in the order of the help
};
/// A program with the options that it has without a command, and its commands.
struct ProgramText : CommandText {
    std::vector<CommandText> commands;
};

/// Options of a command that have names with dashes, with --set in place of all settings, whose choices are "NAME=".
std::vector<OptionText> named_options(const CommandText& command);

/// Text that completion and manual pages give for an option: the first sentence.
std::string first_sentence(const std::string& text);

}  // namespace vog::cli
