// help_text.cpp: layout of help, and the list of each command's common options.
#include "help/help_text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <sstream>

namespace vog::cli {

namespace {

constexpr std::size_t kNameColumn = 34, kWidest = 110, kNarrowest = 70;

/// Letters of a line: those of the terminal within limits; of a file or a pipe the most.
std::size_t line_width() {
    winsize size{};
    if (!isatty(STDOUT_FILENO) || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return kWidest;
    return std::clamp<std::size_t>(size.ws_col, kNarrowest, kWidest);
}

std::string joined_lines(const std::vector<std::string>& lines) {
    return fmt::format("{}", fmt::join(lines, "\n"));
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
        std::vector<const CLI::Option*> some, all = named_options(*app);
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

    /// Lines of a whole picture's width: wrapped here, indented by CLI11.
    std::string make_option_desc(const CLI::Option* option) const override {
        return joined_lines(wrapped(option->get_description(), line_width() - kNameColumn));
    }
    std::string make_subcommand(const CLI::App* command) const override {
        std::ostringstream out;
        CLI::detail::format_help(
            out, command->get_name(),
            joined_lines(wrapped(command->get_description(), line_width() - kNameColumn)),
            kNameColumn);
        return out.str();
    }
};

}  // namespace

void set_help(CLI::App& app) {
    app.formatter(std::make_shared<HelpFormatter>());
    app.set_help_all_flag("--help-all", "Print this help with every option");
}

const std::vector<std::string>& common_options(const std::string& command) {
    static const std::map<std::string, std::vector<std::string>> common = {
        {"convert",
         {"--output", "--budget", "--error", "--block", "--refine", "--field", "--measure",
          "--grid", "--memory", "--json"}},
        {"render",
         {"--output", "--size", "--azimuth", "--elevation", "--show", "--field", "--tf",
          "--extinction", "--background", "--grid", "--turntable"}},
        {"export",  // of vog, and of vog-mpi
         {"--output", "--title", "--show", "--field", "--tf", "--light", "--steps", "--budget",
          "--max-loss", "--as", "--error", "--block", "--carry"}},
        {"evaluate",
         {"--output", "--grid", "--field", "--size", "--show", "--tf", "--voxels", "--repeat",
          "--resume", "--json"}},
        {"view",
         {"--grid", "--show", "--field", "--tf", "--extinction", "--azimuth", "--elevation",
          "--size", "--steps", "--script", "--headless"}},
    };
    static const std::vector<std::string> none;
    const auto found = common.find(command);
    return found == common.end() ? none : found->second;
}

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
    std::vector<std::string> lines;
    std::istringstream paragraphs(text);
    for (std::string paragraph; std::getline(paragraphs, paragraph);) {
        std::istringstream words(paragraph);
        std::string line;
        for (std::string word; words >> word;) {
            if (!line.empty() && line.size() + 1 + word.size() > width) {
                lines.push_back(line);
                line.clear();
            }
            line += (line.empty() ? "" : " ") + word;
        }
        lines.push_back(line);
    }
    return lines;
}

std::string first_sentence(const std::string& text) {
    // Not behind "e.g." and the like: a sentence ends before a capital letter.
    for (std::size_t at = text.find(". "); at != text.npos; at = text.find(". ", at + 1))
        if (at + 2 < text.size() && std::isupper(static_cast<unsigned char>(text[at + 2])))
            return text.substr(0, at);
    return text;
}

std::vector<std::string> choices_of(const CLI::Option& option) {
    const std::string type = option.get_type_name();  // TEXT:{moments,paper}
    const std::size_t open = type.find('{'), close = type.find('}');
    std::vector<std::string> choices;
    if (open == type.npos || close == type.npos) return choices;
    std::istringstream list(type.substr(open + 1, close - open - 1));
    for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
    return choices;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    return app.get_subcommands(
        [](const CLI::App* command) { return !command->get_name().empty(); });
}

std::vector<const CLI::Option*> named_options(const CLI::App& command) {
    return command.get_options([](const CLI::Option* option) {
        return option->nonpositional() && !option->get_group().empty();
    });
}

std::vector<std::string> command_words(const CLI::App& app) {
    std::vector<std::string> words;
    for (const CLI::App* command : commands_of(app)) words.push_back(command->get_name());
    return words;
}

std::vector<std::string> spellings(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    return names;
}

std::vector<std::string> option_words(const CLI::App& command) {
    std::vector<std::string> words;
    for (const CLI::Option* option : named_options(command))
        for (const std::string& name : spellings(*option)) words.push_back(name);
    return words;
}

}  // namespace vog::cli
