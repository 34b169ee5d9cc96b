// request_options.h: options of a picture's request, made from the library's table of its members (vog/request_schema.h).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "options/parser/given_options.h"
#include "terminal/usage_error.h"
#include "vog/request_schema.h"

namespace vog::cli {

/// Members of a request that a command line states, as words by their keys.
struct RequestWords {
    std::map<std::string, std::vector<std::string>> given{};

    bool has(const std::string& key) const { return given.contains(key); }
    /// The word of a member, or another one where it is not given.
    std::string word(const std::string& key, const std::string& otherwise = "") const;
    Show show() const { return show_named(word("show", "T")); }
    /// A request with these members.
    /// throws  UsageError naming the option whose words are none of its values
    PictureRequest over(PictureRequest base = {}) const;
};

/// Adds the options of all members of a request, or of what a page and a window begin with: quantity, colours, volumes, clips.
/// group  heading in place of those of quantities and colours; empty: theirs
void add_request_options(CLI::App& command, RequestWords& words);
void add_shown_options(CLI::App& command, RequestWords& words, const std::string& group = "");
/// Adds the options of some members, by their keys.
void add_member_options(CLI::App& command, RequestWords& words, const std::set<std::string>& keys);

/// Options of a member: "--slabs"; of bands "--band --iso".
std::string options_of(const std::string& key);
/// Runs a command with the options that its line states. A RequestError becomes a UsageError that names the option.
void on_run(CLI::App& command, const std::function<void(GivenOptions&)>& run);

}  // namespace vog::cli
