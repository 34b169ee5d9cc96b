// man_page.cpp: roff of commands and options.
#include "help/man_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "help/help_text.h"
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
std::string option_entry(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    if (names.empty()) names.push_back(option.get_name(true, false));
    std::string value;
    if (option.get_expected_max() > 0 && !option.get_type_name().empty()) {
        const std::string type = option.get_type_name();
        value = " \\fI" + roff(type.substr(0, type.find(':'))) + "\\fR";
    }
    std::string description = option.get_description();
    if (!description.empty() && !description.ends_with('.')) description += '.';
    std::string text =
        fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(fmt::format("{}", fmt::join(names, ", "))),
                    value, roff(description));
    if (const auto choices = choices_of(option); !choices.empty())
        text += roff(fmt::format("One of {}.", fmt::join(choices, ", "))) + "\n";
    if (!option.get_default_str().empty())
        text += roff(fmt::format("Default: {}.", option.get_default_str())) + "\n";
    if (option.get_required()) text += "Required.\n";
    return text;
}

std::string options_section(const CLI::App& command) {
    std::string text;
    const auto positionals =
        command.get_options([](const CLI::Option* option) { return option->get_positional(); });
    if (!positionals.empty()) text += ".SH ARGUMENTS\n";
    for (const CLI::Option* option : positionals) text += option_entry(*option);
    text += ".SH OPTIONS\n";
    for (const std::string& group : command.get_groups()) {
        std::string entries;
        for (const CLI::Option* option : named_options(command))
            if (option->get_group() == group) entries += option_entry(*option);
        if (entries.empty()) continue;
        if (group != "Options") text += ".SS " + roff(group) + "\n";
        text += entries;
    }
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

std::string program_page(const CLI::App& app) {
    const std::string name = app.get_name();
    std::string text = title(name);
    text += fmt::format(".SH NAME\n{} \\- sparse volumes as 3D Gaussians\n", name);
    text += fmt::format(
        ".SH SYNOPSIS\n.B {0}\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR] [\\fIFILES\\fR]\n.br\n.B {0}\n"
        "\\fIFILE\\fR\n",
        name);
    text += ".SH DESCRIPTION\n.nf\n" + roff(app.get_description()) + "\n.fi\n";
    text += ".SH COMMANDS\n";
    std::vector<std::string> others;
    for (const CLI::App* command : commands_of(app)) {
        text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", command->get_name(),
                            roff(command->get_description()));
        others.push_back(fmt::format("\\fB{}\\-{}\\fR(1)", name, command->get_name()));
    }
    return text + options_section(app) + endings(fmt::format("{}", fmt::join(others, ", ")));
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& command) {
    if (command.empty()) return program_page(app);
    const auto commands = commands_of(app);
    const auto found = std::ranges::find(commands, command, &CLI::App::get_name);
    if (found == commands.end())
        throw Error(fmt::format("man: no command '{}', expected {}", command,
                                fmt::join(command_words(app), ", ")));
    const CLI::App& one = **found;
    const std::string name = app.get_name() + "-" + command;
    std::vector<std::string> arguments;
    for (const CLI::Option* option :
         one.get_options([](const CLI::Option* any) { return any->get_positional(); }))
        arguments.push_back(fmt::format(
            fmt::runtime(option->get_required() ? "\\fI{}\\fR{}" : "[\\fI{}\\fR{}]"),
            option->get_name(true, false), option->get_expected_max() > 1 ? "..." : ""));
    return title(name) +
           fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {} {}\n[\\fIOPTIONS\\fR] {}\n",
                       roff(name), roff(first_sentence(one.get_description())), app.get_name(),
                       command, fmt::join(arguments, " ")) +
           ".SH DESCRIPTION\n" + roff(one.get_description()) + "\n" + options_section(one) +
           endings(fmt::format("\\fB{}\\fR(1)", app.get_name()));
}

}  // namespace vog::cli
