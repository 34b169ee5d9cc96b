// mistakes.cpp: nearest names, and examples for missing arguments.
#include "help/mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <sstream>

#include "help/help_text.h"
#include "help/next_steps.h"

namespace vog::cli {

namespace {

/// The command that was parsed; the program itself where none was.
const CLI::App& parsed_command(const CLI::App& app) {
    const auto parsed = app.get_subcommands();
    return parsed.empty() ? app : *parsed.front();
}

/// "vog convert": the words before the arguments.
std::string spoken(const CLI::App& command) {
    return command.get_parent() ? command.get_parent()->get_name() + " " + command.get_name()
                                : command.get_name();
}

/// Message for words that no option and no argument takes.
std::string unexpected_text(const CLI::App& app) {
    const CLI::App& command = parsed_command(app);
    const std::vector<std::string> extras = app.remaining(true);
    if (extras.empty()) return {};
    const auto option = std::ranges::find_if(
        extras, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (option == extras.end())
        return fmt::format("{}: unexpected argument '{}'", spoken(command), extras.front());
    const std::string word = option->substr(0, option->find('='));
    const std::map<std::string, std::string> renamed = {{"--log", "--scale log"},
                                                        {"--slab-hits", "--hits-per-slab"}};
    if (const auto now = renamed.find(word); now != renamed.end())
        return fmt::format("{}: no option {}, it is {}", spoken(command), word, now->second);
    const std::string near = nearest(word, option_words(command));
    if (!near.empty())
        return fmt::format("{}: no option {}; did you mean {}?", spoken(command), word, near);
    // An option of another command is no typing error.
    std::string others;
    for (const CLI::App* other : commands_of(app))
        if (other->get_option_no_throw(word))
            others += (others.empty() ? "" : ", ") + spoken(*other);
    return fmt::format("{}: no option {}{}", spoken(command), word,
                       others.empty() ? fmt::format("; {} --help-all lists them", spoken(command))
                                      : " here, only in " + others);
}

/// Extension of the file that a command writes with -o; empty: a folder or no file.
std::string output_extension(const CLI::App& program, const std::string& command) {
    if (command == "convert") return ".ply";
    if (command == "export") return program.get_name() == "vog-mpi" ? "/" : ".html";
    if (command == "voxelize") return ".vdb";
    return "";
}

/// A whole command line for a command whose -o is missing.
std::string output_example(const CLI::App& command) {
    const CLI::Option* inputs = command.get_option_no_throw("inputs");
    const std::string input =
        inputs && inputs->count() ? inputs->results().front() : std::string("FILE");
    const std::filesystem::path path(input);
    const std::string extension = output_extension(*command.get_parent(), command.get_name());
    const std::string output =
        extension.empty() ? path.stem().string() + "-out" : path.stem().string() + extension;
    return fmt::format("{} {} -o {}{}", spoken(command), quoted(input), quoted(output),
                       command.get_name() == "voxelize" ? " --voxel-size X" : "");
}

}  // namespace

std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> two_ago, last(b.size() + 1), row(b.size() + 1);
    std::iota(last.begin(), last.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1,
                               last[j - 1] + static_cast<std::size_t>(a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], two_ago[j - 2] + 1);
        }
        two_ago = last;
        last = row;
    }
    return last[b.size()];
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
    constexpr std::size_t kLettersAnError = 3, kLeastStart = 3;
    const auto letters = [](const std::string& text) {
        return text.size() - std::min(text.find_first_not_of('-'), text.size());
    };
    std::string best;
    std::size_t fewest = word.size() + 1;
    for (const std::string& name : known) {
        const bool begins = letters(word) >= kLeastStart && name.starts_with(word);
        const std::size_t distance = begins ? 1 : edit_distance(word, name);
        const std::size_t most = std::max(letters(word), letters(name)) / kLettersAnError;
        if ((begins || distance <= most) && distance < fewest) {
            best = name;
            fewest = distance;
        }
    }
    return best;
}

std::string unknown_command_text(const CLI::App& app, const std::string& word) {
    const std::vector<std::string> names = command_words(app);
    const std::string near = nearest(word, names);
    if (!near.empty())
        return fmt::format("no command or file '{}'; did you mean '{} {}'?", word, app.get_name(),
                           near);
    return fmt::format("no command or file '{}', expected a file, or one of {}", word,
                       fmt::join(names, ", "));
}

std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = parsed_command(app);
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        const std::string text = unexpected_text(app);
        if (!text.empty()) return text;
    }
    if (dynamic_cast<const CLI::RequiredError*>(&error)) {
        const CLI::Option* output = command.get_option_no_throw("--output");
        const CLI::Option* inputs = command.get_option_no_throw("inputs");
        const bool has_inputs = !inputs || inputs->count() > 0;
        if (output && output->get_required() && !output->count() && has_inputs)
            return fmt::format("{}: -o is missing: {}", spoken(command), output_example(command));
        if (&command != &app) return fmt::format("{}: {}", spoken(command), error.what());
    }
    return error.what();
}

std::string with_remedy(const std::string& message) {
    if (message.ends_with("--measure volume carries them as a field)"))
        return message.substr(0, message.size() - 1) + ", vog render --show volume draws them)";
    const std::string start = "(it has: ";
    const std::size_t begin = message.find(start), end = message.find(')', begin);
    if (begin == message.npos || end == message.npos) return message;
    std::vector<std::string> names;
    std::istringstream list(message.substr(begin + start.size(), end - begin - start.size()));
    for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
    const std::string pattern = level_pattern(names);
    if (pattern.empty()) return message;
    return fmt::format("{}; --grid {} reads all of them as levels", message, quoted(pattern));
}

}  // namespace vog::cli
