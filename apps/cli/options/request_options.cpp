// request_options.cpp: options of requests by the table of members, and their words in requests.
#include "options/request_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <CLI/CLI.hpp>

#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

namespace {

/// Members that few pictures need: --set NAME=VALUE.
bool is_setting(const std::string& key) {
    static const std::set<std::string> keys{
        "least_column",  "light_weights",      "scattering", "asymmetry",
        "kappa",         "aabb_sigma",         "step",       "anyhit",
        "hits_per_slab", "stop_transmittance", "precision",  "clip_lights"};
    return keys.contains(key);
}

/// "--pixel-error" of pixel_error; of lists, whose rows are options of their own, without the s: "--band". Planes of clips are values of --clip.
std::string option_of(const std::string& key) {
    const auto& all = request_schema();
    const auto member = std::ranges::find(all, key, &RequestMember::key);
    const bool many = member != all.end() && member->many;
    if (key == "clip_planes") return "--clip";
    std::string name = many && key.ends_with('s') ? key.substr(0, key.size() - 1) : key;
    std::ranges::replace(name, '_', '-');
    return is_setting(key) ? setting(name) : "--" + name;
}

/// A text whose members are spelled as options.
std::string spelled(const std::string& text) { return cli::spelled(text, option_of); }

/// --clip: boxes of six numbers and planes of four.
void add_clip(CLI::App& command, RequestWords& words, const RequestMember& box) {
    const RequestMember& plane =
        *std::ranges::find(request_schema(), "clip_planes", &RequestMember::key);
    command
        .add_option_function<std::vector<std::string>>(
            "--clip",
            [&words, of_box = box.takes,
             of_plane = plane.takes](const std::vector<std::string>& given) {
                for (const std::string& text : given) {
                    const auto commas = std::ranges::count(text, ',');
                    if (commas != 3 && commas != 5)
                        throw UsageError(fmt::format("--clip {}: expected a box {} or a plane {}",
                                                     text, of_box, of_plane));
                    words.given[commas == 3 ? "clip_planes" : "clip"].push_back(text);
                }
            },
            fmt::format("{}: {}. {}: {}", box.takes, box.text, plane.takes, plane.text))
        ->allow_extra_args(false);
}

void add_option(CLI::App& command, RequestWords& words, const RequestMember& member) {
    if (member.key == "clip_planes") return;
    if (member.key == "clip") return add_clip(command, words, member);
    const std::string key = member.key, text = spelled(member.text);
    const auto take = [&words, key](const std::vector<std::string>& given) {
        words.given[key] = given;
    };
    if (member.many) {
        const auto add_row = [&](const std::string& name, const std::string& about) {
            command
                .add_option_function<std::vector<std::string>>(
                    name,
                    [&words, key](const std::vector<std::string>& given) {
                        auto& all = words.given[key];
                        all.insert(all.end(), given.begin(), given.end());
                    },
                    about)
                ->allow_extra_args(false);
        };
        if (key != "bands") return add_row(option_of(key), member.takes + ": " + text);
        add_row("--band", "LO,HI,COLOUR,OPACITY: " + text);
        add_row("--iso",
                "VALUE[,COLOUR]: Surface (ivory): values from VALUE on are opaque, up to the next "
                "--iso or --band; may be given again");
    } else if (member.takes.empty() && member.choices.empty()) {
        command.add_flag_function(
            option_of(key), [take](std::int64_t) { take({"true"}); }, text);
    } else {
        CLI::Option* option = command.add_option_function<std::string>(
            option_of(key), [take](const std::string& word) { take({word}); },
            member.takes.empty() ? text : member.takes + ": " + text);
        if (!member.choices.empty()) option->check(CLI::IsMember(member.choices));
        if (!member.unset.empty()) option->default_str(member.unset);
        // For completion, which offers files for texts.
        const std::vector<std::string> numbers{"N",      "SHARE",  "PIXELS", "RADII",
                                               "VOXELS", "LENGTH", "VALUE"};
        if (std::ranges::count(numbers, member.takes)) option->type_name("FLOAT");
    }
}

/// An error as the command line names its options.
UsageError as_option(const RequestError& error) {
    const std::string option = option_of(error.member());
    std::string text = spelled(error.text());
    const bool has_value = text.starts_with(' ') && text.find(' ', 1) == text.find(':') + 1;
    if (is_setting(error.member()) && has_value) text.front() = '=';
    return UsageError(option + text);
}

/// throws  UsageError naming the option; vog::Error for files of --tf
void set_by_words(PictureRequest& request, const std::string& key,
                  const std::vector<std::string>& words) try {
    set_member(request, key, words);
} catch (const RequestError& error) {
    throw as_option(error);
} catch (const Error& error) {
    if (key == "tf") throw;
    throw UsageError(option_of(key) + ": " + error.what());
}

}  // namespace

std::string RequestWords::word(const std::string& key, const std::string& otherwise) const {
    const auto found = given.find(key);
    return found == given.end() ? otherwise : found->second.back();
}

PictureRequest RequestWords::over(PictureRequest base) const {
    for (const auto& [key, words] : given) set_by_words(base, key, words);
    return base;
}

void add_request_options(CLI::App& command, RequestWords& words) {
    for (const RequestMember& member : request_schema()) {
        const OptionGroup grouped(command, spelled(member.group));
        add_option(command, words, member);
    }
}

void add_shown_options(CLI::App& command, RequestWords& words, const std::string& group) {
    for (const RequestMember& member : request_schema()) {
        const bool general = member.group == "Quantity" || member.group == "Colour";
        const bool special = member.group == "Clipping" || member.shows.starts_with("volume");
        // Maps of pages have the data's units, and show every pixel.
        static const std::set<std::string> of_pictures{"units", "least_column", "layers",
                                                       "precision"};
        if (!(general || special) || of_pictures.contains(member.key)) continue;
        const OptionGroup grouped(command,
                                  general && !group.empty() ? group : spelled(member.group));
        RequestMember shown = member;
        std::erase(shown.choices, word_of(Show::slice));  // of pictures alone
        add_option(command, words, shown);
    }
}

void add_member_options(CLI::App& command, RequestWords& words, const std::set<std::string>& keys) {
    for (const RequestMember& member : request_schema())
        if (keys.contains(member.key)) add_option(command, words, member);
}

std::string options_of(const std::string& key) {
    return option_of(key) + (key == "bands" ? " --iso" : "");
}

void on_run(CLI::App& command, const std::function<void(GivenOptions&)>& run) {
    command.callback([&command, run] {
        GivenOptions given(command);
        try {
            run(given);
        } catch (const RequestError& error) {
            throw as_option(error);
        }
    });
}

}  // namespace vog::cli
