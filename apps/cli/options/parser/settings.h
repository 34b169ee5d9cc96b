// settings.h: options that few runs need, which the command line states as --set NAME=VALUE.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace vog::cli {

/// Name by which the parser knows a setting: "--set.tree-depth".
std::string setting(const std::string& name);

/// Words of a command line with the settings under the parser's names.
/// throws  UsageError for --set without NAME=VALUE
std::vector<std::string> with_settings(const std::vector<std::string>& words);

/// A text whose settings are spelled as they are typed: "--set tree-depth".
std::string as_typed(std::string text);

/// A text whose names between backquotes, "`tf`" or "`light=studio`", are spelled as options.
std::string spelled(std::string text,
                    const std::function<std::string(const std::string&)>& option_of);

}  // namespace vog::cli
