// mistakes.cpp: nearest names, and examples for missing arguments.
#include "help/mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <sstream>

#include "files/next_steps.h"

namespace vog::cli {

namespace {

/// Options that had other names before.
const std::map<std::string, std::string> kRenamed = {
    {"--log", "--scale log"},
    {"--slab-hits", "--set hits-per-slab=N"},
    {"--sum", "--combine sum"},
    {"--mesh", "--combine mesh"},
    {"--clip-plane", "--clip NX,NY,NZ,D"},
    {"--azimuth", "--view AZIMUTH,ELEVATION"},
    {"--elevation", "--view AZIMUTH,ELEVATION"},
    {"--field-step", "--set field-rounding=STEP"},
    {"--carry", "--field"},
    {"--save-camera", "--camera PICTURE, where it is used"}};

/// Names of a command's options: settings as --set NAME.
std::vector<std::string> option_names(const CommandText& command) {
    std::vector<std::string> all;
    for (const OptionText& option : command.options)
        if (!option.argument) all.insert(all.end(), option.names.begin(), option.names.end());
    return all;
}
bool has_option(const CommandText& command, const std::string& name) {
    return std::ranges::count(option_names(command), name) > 0;
}

/// Extension of the file that a command writes with -o; empty: a folder or no file.
std::string output_extension(const std::string& program, const std::string& command) {
    if (command == "convert") return ".ply";
    if (command == "page") return program == "vog-mpi" ? "/" : ".html";
    if (command == "pack") return ".vogz";
    if (command == "export") return ".glb";
    if (command == "voxelize") return ".vdb";
    return "";
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

std::string unknown_command_text(const ProgramText& program, const std::string& word) {
    std::vector<std::string> names;
    for (const CommandText& command : program.commands) names.push_back(command.name);
    const std::string near = nearest(word, names);
    if (!near.empty())
        return fmt::format("no command or file '{}'; did you mean '{} {}'?", word, program.name,
                           near);
    return fmt::format("no command or file '{}'; commands are {}", word, fmt::join(names, ", "));
}

std::string unexpected_text(const ProgramText& program, const std::string& name,
                            const std::vector<std::string>& words) {
    const auto found = std::ranges::find(program.commands, name, &CommandText::name);
    const CommandText& command = found == program.commands.end() ? program : *found;
    const std::string spoken = name.empty() ? program.name : program.name + " " + name;
    const auto option = std::ranges::find_if(
        words, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (option == words.end())
        return fmt::format("{}: unexpected argument '{}'", spoken, words.front());
    const std::string word = option->substr(0, option->find('='));
    auto now = kRenamed.find(word);
    const std::string setting = "--set " + word.substr(word.find_first_not_of('-'));
    if (now != kRenamed.end() || has_option(command, setting))
        return fmt::format("{}: no option {}; use {}", spoken, word,
                           now != kRenamed.end() ? now->second : setting + "=VALUE");
    const std::string near = nearest(word, option_names(command));
    if (!near.empty()) return fmt::format("{}: no option {}; did you mean {}?", spoken, word, near);
    // An option of another command is no typing error.
    std::string others;
    for (const CommandText& other : program.commands)
        if (has_option(other, word))
            others += fmt::format("{}{} {}", others.empty() ? "" : ", ", program.name, other.name);
    return fmt::format("{}: no option {}{}", spoken, word,
                       others.empty() ? fmt::format("; {} --help-all lists them", spoken)
                                      : " here, only in " + others);
}

std::string missing_output_text(const std::string& program, const std::string& command,
                                const std::string& input) {
    const std::string stem = std::filesystem::path(input).stem().string();
    const std::string extension = output_extension(program, command);
    return fmt::format("{0} {1}: -o is missing: {0} {1} {2} -o {3}{4}", program, command,
                       quoted(input), quoted(stem + (extension.empty() ? "-out" : extension)),
                       command == "voxelize" ? " --voxel-size X" : "");
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
    if (pattern.empty() || pattern.starts_with("PartType")) return message;
    return fmt::format("{}; --grid {} reads all of them as levels", message, quoted(pattern));
}

}  // namespace vog::cli
