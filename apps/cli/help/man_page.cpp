// man_page.cpp: roff of commands and options.
#include "help/man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "help/version.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

/// Text whose letters mean nothing to roff. Hyphens become minus signs, which people copy into shells.
std::string roff(const std::string& text) {
    std::string result;
    for (const char letter : text) {
        const bool line_start = result.empty() || result.back() == '\n';
        if (line_start && (letter == '.' || letter == '\'')) result += "\\&";
        if (letter == '\\')
            result += "\\e";
        else if (letter == '-')
            result += "\\-";
        else
            result += letter;
    }
    return result;
}

std::string upper(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

/// ".TP" with the option's names, its value, and its description.
std::string option_entry(const OptionText& option) {
    std::string text =
        fmt::format(".TP\n\\fB{}{}\\fR", roff(fmt::format("{}", fmt::join(option.names, ", "))),
                    option.setting ? "=" : "");
    if (!option.takes.empty())
        text += fmt::format("{}\\fI{}\\fR", option.setting ? "" : " ", roff(option.takes));
    const bool ends = option.text.empty() || option.text.ends_with('.');
    text += "\n" + roff(option.text + (ends ? "" : ".")) + "\n";
    if (!option.choices.empty())
        text += roff(fmt::format("One of {}.", fmt::join(option.choices, ", "))) + "\n";
    if (!option.interval.empty()) text += roff(fmt::format("In {}.", option.interval)) + "\n";
    if (!option.standard.empty()) text += roff(fmt::format("Default: {}.", option.standard)) + "\n";
    if (option.required) text += "Required.\n";
    return text;
}

/// Arguments, then options under the headings of the help.
std::string options_section(const CommandText& command) {
    std::string arguments;
    std::vector<std::pair<std::string, std::string>> groups;  // heading, entries
    for (const OptionText& option : command.options) {
        if (option.argument) {
            arguments += option_entry(option);
            continue;
        }
        auto group = std::ranges::find(groups, option.group, [](const auto& g) { return g.first; });
        if (group == groups.end()) group = groups.insert(groups.end(), {option.group, ""});
        group->second += option_entry(option);
    }
    std::string text = arguments.empty() ? "" : ".SH ARGUMENTS\n" + arguments;
    text += ".SH OPTIONS\n";
    for (const auto& [heading, entries] : groups)
        text += (heading == "Options" ? "" : ".SS " + roff(heading) + "\n") + entries;
    return text;
}

std::string title(const std::string& name) {
    return fmt::format(".TH \"{}\" 1 \"\" \"{}\" \"User Commands\"\n", roff(upper(name)),
                       roff(fmt::format("vog {}", version_number())));
}

std::string endings(const std::string& others) {
    return fmt::format(
        ".SH EXIT STATUS\n0 success; 1 failure, with one line on standard error; 2 wrong usage.\n"
        ".SH SEE ALSO\n{}\n",
        others);
}

std::string program_page(const ProgramText& program) {
    const std::string& name = program.name;
    std::string text = title(name);
    text += fmt::format(".SH NAME\n{} \\- sparse volumes as 3D Gaussians\n", name);
    text += fmt::format(
        ".SH SYNOPSIS\n.B {0}\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR] [\\fIFILES\\fR]\n.br\n.B {0}\n"
        "\\fIFILE\\fR\n",
        name);
    text += ".SH DESCRIPTION\n.nf\n" + roff(program.text) + "\n.fi\n";
    text += ".SH COMMANDS\n";
    std::vector<std::string> others;
    for (const CommandText& command : program.commands) {
        text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", command.name, roff(command.text));
        others.push_back(fmt::format("\\fB{}\\-{}\\fR(1)", name, command.name));
    }
    return text + options_section(program) + endings(fmt::format("{}", fmt::join(others, ", ")));
}

}  // namespace

std::string man_page(const ProgramText& program, const std::string& command) {
    if (command.empty()) return program_page(program);
    const auto found = std::ranges::find(program.commands, command, &CommandText::name);
    if (found == program.commands.end()) {
        std::vector<std::string> names;
        for (const CommandText& one : program.commands) names.push_back(one.name);
        throw Error(
            fmt::format("man: no command '{}', expected {}", command, fmt::join(names, ", ")));
    }
    std::vector<std::string> arguments;
    for (const OptionText& option : found->options)
        if (option.argument)
            arguments.push_back(
                fmt::format(fmt::runtime(option.required ? "\\fI{}\\fR{}" : "[\\fI{}\\fR{}]"),
                            option.names.front(), option.many ? "..." : ""));
    const std::string name = program.name + "-" + command;
    return title(name) +
           fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {} {}\n[\\fIOPTIONS\\fR] {}\n",
                       roff(name), roff(first_sentence(found->text)), program.name, command,
                       fmt::join(arguments, " ")) +
           ".SH DESCRIPTION\n" + roff(found->text) + "\n" + options_section(*found) +
           endings(fmt::format("\\fB{}\\fR(1)", program.name));
}

}  // namespace vog::cli
