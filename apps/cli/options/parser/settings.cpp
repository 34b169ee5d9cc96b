// settings.cpp: --set NAME=VALUE as options of the parser.
#include "options/parser/settings.h"

#include <algorithm>

#include "terminal/usage_error.h"

namespace vog::cli {

namespace {
const std::string kTyped = "--set ", kParsed = "--set.";
}

std::string setting(const std::string& name) { return kParsed + name; }

std::vector<std::string> with_settings(const std::vector<std::string>& words) {
    std::vector<std::string> all;
    for (std::size_t n = 0; n < words.size(); ++n) {
        const bool joined = words[n].starts_with("--set=");
        if (words[n] != "--set" && !joined) {
            all.push_back(words[n]);
            continue;
        }
        const std::string given = joined                 ? words[n].substr(6)
                                  : n + 1 < words.size() ? words[++n]
                                                         : "";
        if (given.find('=') == given.npos || given.starts_with('='))
            throw UsageError("--set" + (given.empty() ? "" : " " + given) +
                             ": expected NAME=VALUE; --help-all lists the names");
        if (given.find('=') + 1 == given.size())
            throw UsageError("--set " + given + ": expected a value behind the =");
        all.push_back(kParsed + given);
    }
    return all;
}

std::string as_typed(std::string text) {
    for (std::size_t at = 0; (at = text.find(kParsed, at)) != text.npos; at += kTyped.size())
        text.replace(at, kParsed.size(), kTyped);
    return text;
}

std::string spelled(std::string text,
                    const std::function<std::string(const std::string&)>& option_of) {
    for (std::size_t at = 0; (at = text.find('`', at)) != text.npos;) {
        const std::size_t end = text.find('`', at + 1), key = std::min(text.find('=', at), end);
        text.replace(at, end + 1 - at,
                     option_of(text.substr(at + 1, key - at - 1)) + text.substr(key, end - key));
    }
    return text;
}

}  // namespace vog::cli
