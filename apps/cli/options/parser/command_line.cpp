// command_line.cpp: layout of help, the list of each command's common options, and the parser's errors.
#include "options/parser/command_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "help/mistakes.h"
#include "options/parser/settings.h"
#include "terminal/usage_error.h"

namespace vog::cli {

namespace {

constexpr std::size_t kNameColumn = 34, kWidest = 110, kNarrowest = 70;

/// Letters of a line: those of the terminal within limits; of a file or a pipe the most.
std::size_t line_width() {
    winsize size{};
    if (!isatty(STDOUT_FILENO) || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return kWidest;
    return std::clamp<std::size_t>(size.ws_col, kNarrowest, kWidest);
}

/// A text in lines of at most the terminal's width beside the names; words longer than that stay whole.
std::string wrapped(const std::string& text) {
    const std::size_t width = line_width() - kNameColumn;
    std::string lines;
    std::istringstream paragraphs(text);
    for (std::string paragraph; std::getline(paragraphs, paragraph);) {
        std::istringstream words(paragraph);
        std::string line;
        for (std::string word; words >> word;) {
            if (!line.empty() && line.size() + 1 + word.size() > width) {
                lines += line + "\n";
                line.clear();
            }
            line += (line.empty() ? "" : " ") + word;
        }
        lines += line + "\n";
    }
    if (!lines.empty()) lines.pop_back();
    return lines;
}

/// Long names of the options that --help shows of a command; empty: all of them.
const std::vector<std::string>& common_options(const std::string& command) {
    static const std::map<std::string, std::vector<std::string>> common = {
        {"convert",
         {"--output", "--budget", "--error", "--block", "--refine", "--field", "--measure",
          "--grid", "--memory", "--json"}},
        {"render",
         {"--output", "--size", "--view", "--show", "--field", "--tf", "--extinction",
          "--background", "--grid", "--turntable"}},
        {"page",  // of vog, and of vog-mpi
         {"--output", "--title", "--show", "--field", "--tf", "--light", "--steps", "--budget",
          "--from", "--error", "--block"}},
        {"pack",
         {"--output", "--max-loss", "--reference", "--budget", "--no-fields", "--hierarchy",
          "--deflate", "--json"}},
        {"export",
         {"--output", "--as", "--units", "--up", "--tf", "--field", "--extinction", "--budget",
          "--json"}},
        {"evaluate",
         {"--output", "--grid", "--field", "--size", "--show", "--tf", "--voxels", "--repeat",
          "--resume", "--json"}},
        {"view",
         {"--grid", "--show", "--field", "--tf", "--extinction", "--view", "--size", "--steps",
          "--script", "--headless"}},
    };
    static const std::vector<std::string> none;
    const auto found = common.find(command);
    return found == common.end() ? none : found->second;
}

bool is_setting(const CLI::Option& option) {
    const std::string name = option.get_name();
    return as_typed(name) != name;
}

/// Options of a command that the help shows, arguments or those with dashes.
std::vector<const CLI::Option*> options_of(const CLI::App& command, bool arguments) {
    return command.get_options([&](const CLI::Option* option) {
        return arguments ? option->get_positional()
                         : option->nonpositional() && !option->get_group().empty();
    });
}

class HelpFormatter : public CLI::Formatter {
  public:
    HelpFormatter() { column_width(kNameColumn); }

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        const std::vector<std::string>& common = common_options(app->get_name());
        const bool subcommand = app->get_parent() != nullptr;
        if (mode != CLI::AppFormatMode::Normal || !subcommand || common.empty())
            return CLI::Formatter::make_help(app, name, mode);
        std::vector<const CLI::Option*> some, all = options_of(*app, false);
        for (const std::string& option : common)
            if (const CLI::Option* known = app->get_option_no_throw(option)) some.push_back(known);
        some.push_back(app->get_help_ptr());
        std::ostringstream out;
        out << make_description(app) << make_usage(app, name) << make_positionals(app)
            << make_group("Common options", false, some) << "\n"
            << all.size() - some.size() << " more options: " << name << " --help-all\n"
            << make_footer(app);
        return out.str();
    }

    std::string make_option_name(const CLI::Option* option, bool argument) const override {
        const std::string name = as_typed(CLI::Formatter::make_option_name(option, argument));
        return is_setting(*option) ? name + "=" : name;
    }
    std::string make_option_opts(const CLI::Option* option) const override {
        const std::string text = CLI::Formatter::make_option_opts(option);
        return is_setting(*option) ? text.substr(text.find_first_not_of(' ')) : text;
    }
    /// Lines of a whole picture's width: wrapped here, indented by CLI11.
    std::string make_option_desc(const CLI::Option* option) const override {
        return as_typed(wrapped(option->get_description()));
    }
    std::string make_subcommand(const CLI::App* command) const override {
        std::ostringstream out;
        CLI::detail::format_help(out, command->get_name(), wrapped(command->get_description()),
                                 kNameColumn);
        return out.str();
    }
};

OptionText option_text(const CLI::Option& option) {
    OptionText text;
    for (const std::string& name : option.get_lnames()) text.names.push_back(as_typed("--" + name));
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    text.argument = text.names.empty();
    if (text.argument) text.names = {option.get_name(true, false)};
    text.text = as_typed(option.get_description());
    text.group = option.get_group();
    const std::string type = option.get_type_name();  // TEXT:{moments,paper}
    if (option.get_expected_max() > 0) text.takes = type.substr(0, type.find(':'));
    const std::size_t open = type.find('{'), close = type.find('}');
    if (open != type.npos && close != type.npos) {
        std::istringstream list(type.substr(open + 1, close - open - 1));
        for (std::string choice; std::getline(list, choice, ',');) text.choices.push_back(choice);
    }
    if (const std::size_t from = type.find_first_of("[("); from != type.npos && open == type.npos)
        text.interval = type.substr(from);
    text.standard = option.get_default_str();
    text.required = option.get_required();
    text.many = option.get_expected_max() > 1;
    text.setting = is_setting(option);
    return text;
}

CommandText command_text(const CLI::App& command) {
    CommandText text{command.get_name(), command.get_description(), {}};
    for (const bool arguments : {true, false})
        for (const CLI::Option* option : options_of(command, arguments))
            text.options.push_back(option_text(*option));
    return text;
}

/// Message for a failed parse, with the nearest option, the missing argument or an example added to the parser's.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
    const auto parsed = app.get_subcommands();
    const CLI::App& command = parsed.empty() ? app : *parsed.front();
    const std::string name = parsed.empty() ? "" : command.get_name();
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        const std::vector<std::string> extras = app.remaining(true);
        if (!extras.empty()) return unexpected_text(program_text(app), name, extras);
    }
    if (dynamic_cast<const CLI::RequiredError*>(&error) && !parsed.empty()) {
        const CLI::Option* output = command.get_option_no_throw("--output");
        const CLI::Option* inputs = command.get_option_no_throw("inputs");
        if (output && output->get_required() && !output->count() && (!inputs || inputs->count()))
            return missing_output_text(app.get_name(), name,
                                       inputs ? inputs->results().front() : "FILE");
        return fmt::format("{} {}: {}", app.get_name(), name, error.what());
    }
    return error.what();
}

}  // namespace

void set_help(CLI::App& app) {
    app.formatter(std::make_shared<HelpFormatter>());
    app.set_help_all_flag("--help-all", "Print this help with every option");
}

ProgramText program_text(const CLI::App& app) {
    ProgramText text{command_text(app), {}};
    for (const CLI::App* command :
         app.get_subcommands([](const CLI::App* one) { return !one->get_name().empty(); }))
        text.commands.push_back(command_text(*command));
    return text;
}

std::string run_command(CLI::App& app, const std::vector<std::string>& words) {
    std::vector<std::string> reversed = with_settings(words);
    std::ranges::reverse(reversed);  // CLI11 takes the last word first
    try {
        app.parse(std::move(reversed));
    } catch (const CLI::Success& text) {  // --help, --version
        std::ostringstream out;
        app.exit(text, out, out);
        return out.str();
    } catch (const CLI::ParseError& error) {
        throw UsageError(as_typed(usage_text(app, error)));
    } catch (const UsageError& error) {
        throw UsageError(as_typed(error.what()));
    }
    return {};
}

}  // namespace vog::cli
