// program_text.cpp: options as they are typed.
#include "help/program_text.h"

#include <cctype>

namespace vog::cli {

std::vector<OptionText> named_options(const CommandText& command) {
    std::vector<OptionText> all;
    OptionText set;
    set.names = {"--set"};
    set.text = "Rarely needed setting: NAME=VALUE";
    set.takes = "TEXT";
    set.many = true;
    for (const OptionText& option : command.options)
        if (option.setting)
            set.choices.push_back(option.names.front().substr(6) + "=");
        else if (!option.argument)
            all.push_back(option);
    if (!set.choices.empty()) all.push_back(set);
    return all;
}

std::string first_sentence(const std::string& text) {
    // Not behind "e.g." and the like: a sentence ends before a capital letter.
    for (std::size_t at = text.find(". "); at != text.npos; at = text.find(". ", at + 1))
        if (at + 2 < text.size() && std::isupper(static_cast<unsigned char>(text[at + 2])))
            return text.substr(0, at);
    return text;
}

}  // namespace vog::cli
