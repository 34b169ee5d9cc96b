// look.cpp: vog FILE: the contents of files, and command lines to try on them.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "commands/commands.h"
#include "files/next_steps.h"
#include "files/sequence.h"
#include "terminal/terminal.h"
#include "vog/error.h"
#include "vog/points.h"
#include "vog/site.h"

namespace vog::cli {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShownFiles = 3;

void print_steps(const std::vector<NextStep>& steps) {
    if (steps.empty()) return;
    std::size_t width = 0;
    for (const NextStep& step : steps) width = std::max(width, step.command.size());
    print_line("");
    print_line("Try:");
    for (const NextStep& step : steps)
        print_line(fmt::format("  {:<{}}   # {}", step.command, width, step.effect));
}

/// Steps of many files of one kind, which are often steps in time.
/// inputs  words of the command line
std::vector<NextStep> steps_of_many(FileKind kind, const std::string& inputs) {
    if (kind == FileKind::model)
        return {{fmt::format("vog render {} -o pictures/", inputs), "a picture of each"},
                {fmt::format("vog page {} -o models.html", inputs), "one page"},
                {fmt::format("vog view {} --steps", inputs), "a window with time"}};
    return {{fmt::format("vog render {} -o pictures/", inputs), "a picture of each"},
            {fmt::format("vog convert {} -o models/", inputs), "a model of each"}};
}

/// Option for the first type of particles that all of several snapshots have; empty: none is needed.
std::string common_particles(const std::vector<std::string>& files) {
    std::map<std::string, std::size_t> counts;
    for (const std::string& file : files)
        for (const std::string& type : point_types(file)) ++counts[type];
    const auto common = std::ranges::find_if(
        counts, [&](const auto& entry) { return entry.second == files.size(); });
    return counts.size() < 2 || common == counts.end() ? "" : " --grid " + common->first;
}

/// Files of a folder that vog reads, by extension, and what to do with the most frequent ones.
void look_into(const std::string& folder) {
    std::map<std::string, std::size_t> counts;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        try {
            (void)kind_of(entry.path().string());
            if (advice_on(entry.path().string()).empty())
                ++counts[extension_of(entry.path().string())];
        } catch (const std::exception&) {
            // A file of another program, or one that cannot be read.
        }
    }
    if (counts.empty())
        throw Error(fmt::format(
            "{}: a folder without files that vog reads (vog convert --help lists formats)",
            folder));
    std::string list;
    for (const auto& [extension, count] : counts)
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, extension);
    print_line(fmt::format("{}: a folder with {}", folder, list));
    const auto most =
        std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
    const std::string pattern = quoted((fs::path(folder) / ("*" + most->first)).string());
    const std::vector<std::string> files =
        expanded({(fs::path(folder) / ("*" + most->first)).string()});
    if (files.size() == 1)
        print_steps({{"vog " + quoted(files.front()), "its contents"}});
    else
        print_steps(steps_of_many(kind_of(files.front()), pattern));
}

}  // namespace

void look_at(const std::vector<std::string>& words) {
    std::vector<std::string> files = expanded(words);
    for (const std::string& file : files) {
        std::error_code code;
        if (!fs::exists(file, code)) throw Error(fmt::format("{}: no such file", file));
    }
    if (files.size() == 1) {
        const std::string& file = files.front();
        if (const std::string advice = advice_on(file); !advice.empty())
            return print_line(fmt::format("{}: {}", file, advice));
        if (fs::is_directory(file) && !is_volume_file(file) && !is_site(file))
            return look_into(file);
        try {
            return print_steps(next_steps(print_contents(files, false).front()));
        } catch (const Error& error) {
            const std::string extension = extension_of(file);
            if (extension != ".h5" && extension != ".hdf5" && extension != ".hdf") throw;
            throw Error(fmt::format("{}; {}", error.what(), advice_on_hdf5(file)));
        }
    }
    const FileKind kind = common_kind(files, {});
    const std::size_t hidden = files.size() - std::min(files.size(), kShownFiles);
    files.resize(files.size() - hidden);
    print_contents(files, false);
    if (hidden) print_line(fmt::format("and {} more files", hidden));
    std::string inputs;
    for (const std::string& word : words) inputs += (inputs.empty() ? "" : " ") + quoted(word);
    print_steps(steps_of_many(
        kind, (words.size() > kShownFiles ? "FILES" : inputs) + common_particles(files)));
}

}  // namespace vog::cli
