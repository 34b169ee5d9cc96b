// completion.cpp: scripts for bash, zsh and fish, from the program's own commands and options.
#include "help/completion.h"

#include <fmt/format.h>

#include <algorithm>

#include "help/help_text.h"
#include "vog/shade.h"

namespace vog::cli {

namespace {

/// Words that an option or an argument takes; empty: any.
std::vector<std::string> words_of(const CLI::Option& option) {
    std::vector<std::string> words = choices_of(option);
    if (option.check_lname("tf"))
        for (const std::string& name : transfer_function_names()) words.push_back(name);
    return words;
}
/// Whether the words are all there is: of --tf files are others.
bool only_words(const CLI::Option& option) { return !choices_of(option).empty(); }
/// Whether a value may be the name of a file: texts, but no numbers.
bool takes_file(const CLI::Option& option) {
    return option.get_type_name().starts_with("TEXT") && !only_words(option);
}
bool takes_value(const CLI::Option& option) { return option.get_expected_max() > 0; }

/// Words that the arguments of a command take, such as the shells of vog completion.
std::vector<std::string> argument_words(const CLI::App& command) {
    for (const CLI::Option* option :
         command.get_options([](const CLI::Option* one) { return one->get_positional(); }))
        if (const std::vector<std::string> words = choices_of(*option); !words.empty())
            return words;
    return {};
}
std::string replaced(std::string text, const std::string& letter, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(letter, at)) != text.npos; at += by.size())
        text.replace(at, letter.size(), by);
    return text;
}
/// First sentence, for the list of a shell, in single quotes.
std::string short_text(const std::string& description) {
    constexpr std::size_t kMost = 90;
    std::string text = replaced(first_sentence(description), "\n", " ");
    if (text.size() > kMost) {
        const std::size_t space = text.rfind(' ', kMost);
        text = text.substr(0, space == text.npos ? kMost : space) + " ...";
    }
    return text;
}

std::string bash_script(const CLI::App& app) {
    const std::string name = app.get_name();
    std::string script = fmt::format(
        R"(# Completion of {0} for bash, made by: {0} completion bash
_{0}() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} option=${{COMP_WORDS[COMP_CWORD-1]}} words=
    # Readline parts --option=value into three words.
    if [[ $word == "=" ]]; then
        word=
    elif [[ $option == "=" ]]; then
        option=${{COMP_WORDS[COMP_CWORD-2]}}
    fi
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        words="{1}"
        [[ $word == -* ]] && words="{2}"
        COMPREPLY=($(compgen -W "$words" -- "$word"))
        return
    fi
    case ${{COMP_WORDS[1]}},$option in
)",
        name, fmt::join(command_words(app), " "), fmt::join(option_words(app), " "));
    for (const CLI::App* command : commands_of(app))
        for (const CLI::Option* option : named_options(*command)) {
            if (!takes_value(*option)) continue;
            std::vector<std::string> cases;
            for (const std::string& spelling : spellings(*option))
                cases.push_back(command->get_name() + "," + spelling);
            const std::vector<std::string> words = words_of(*option);
            // Without words bash completes names of files; of numbers there are none.
            script += fmt::format(
                "        {})\n            {}\n            return ;;\n", fmt::join(cases, "|"),
                !words.empty()        ? fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))",
                                                    fmt::join(words, " "))
                : takes_file(*option) ? ":"
                                      : "compopt +o default");
        }
    script += "    esac\n    case ${COMP_WORDS[1]} in\n";
    for (const CLI::App* command : commands_of(app))
        script += fmt::format(
            "        {})\n            words=\"{}\"\n            [[ $word == -* ]] && "
            "words=\"{}\" ;;\n",
            command->get_name(), fmt::join(argument_words(*command), " "),
            fmt::join(option_words(*command), " "));
    script += fmt::format(
        "    esac\n    COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n}}\n"
        "complete -o default -F _{0} {0}\n",
        name);
    return script;
}

/// Text in a specification of zsh's _arguments, inside single quotes.
std::string zsh_text(const std::string& text) {
    std::string result;
    for (const char letter : short_text(text)) {
        if (letter == '\'')
            result += "'\\''";
        else if (letter == ':' || letter == '[' || letter == ']' || letter == '\\')
            result += std::string("\\") + letter;
        else
            result += letter;
    }
    return result;
}

/// Action of _arguments for a value.
std::string zsh_action(const CLI::Option& option) {
    const std::vector<std::string> words = words_of(option);
    if (words.empty()) return takes_file(option) ? "_files" : " ";
    const std::string list = fmt::format("({})", fmt::join(words, " "));
    return only_words(option)
               ? list
               : fmt::format("{{_alternative \"names\\:name\\:{}\" \"files\\:file\\:_files\"}}",
                             list);
}

std::string zsh_script(const CLI::App& app) {
    const std::string name = app.get_name();
    std::string script = fmt::format(
        "#compdef {0}\n# Completion of {0} for zsh, made by: {0} completion zsh\n_{0}() {{\n"
        "    local curcontext=$curcontext state line\n    local -a commands\n"
        "    _arguments -C '--help[Print help]' '--version[Print the version]' \\\n"
        "        '1: :->command' '*:: :->argument'\n"
        "    case $state in\n    command)\n        commands=(\n",
        name);
    for (const CLI::App* command : commands_of(app))
        script += fmt::format("            '{}:{}'\n", command->get_name(),
                              zsh_text(command->get_description()));
    script +=
        "        )\n        _describe -t commands command commands\n        _files ;;\n    "
        "argument)\n        case $words[1] in\n";
    for (const CLI::App* command : commands_of(app)) {
        script += fmt::format("        {})\n            _arguments", command->get_name());
        for (const CLI::Option* option : named_options(*command)) {
            const std::vector<std::string> names = spellings(*option);
            const bool again = option->get_expected_max() > 1;
            for (const std::string& spelling : names)
                script += fmt::format(" \\\n                '{}{}[{}]{}'",
                                      again ? "*" : fmt::format("({})", fmt::join(names, " ")),
                                      spelling, zsh_text(option->get_description()),
                                      takes_value(*option) ? ":value:" + zsh_action(*option) : "");
        }
        const std::vector<std::string> words = argument_words(*command);
        script +=
            fmt::format(" \\\n                '*: :{}' ;;\n",
                        words.empty() ? "_files" : fmt::format("({})", fmt::join(words, " ")));
    }
    script += fmt::format(
        "        esac ;;\n    esac\n}}\n"
        "if [[ $funcstack[1] == _{0} ]]; then _{0} \"$@\"; else compdef _{0} {0}; fi\n",
        name);
    return script;
}

std::string fish_text(const std::string& text) {
    return replaced(replaced(short_text(text), "\\", "\\\\"), "'", "\\'");
}

std::string fish_script(const CLI::App& app) {
    const std::string name = app.get_name();
    std::string script =
        fmt::format("# Completion of {0} for fish, made by: {0} completion fish\n", name);
    for (const CLI::App* command : commands_of(app))
        script += fmt::format("complete -c {} -n __fish_use_subcommand -a {} -d '{}'\n", name,
                              command->get_name(), fish_text(command->get_description()));
    for (const CLI::Option* option : named_options(app))
        for (const std::string& long_name : option->get_lnames())
            script += fmt::format("complete -c {} -n __fish_use_subcommand -l {} -d '{}'\n", name,
                                  long_name, fish_text(option->get_description()));
    for (const CLI::App* command : commands_of(app)) {
        const std::string start = fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'",
                                              name, command->get_name());
        for (const CLI::Option* option : named_options(*command)) {
            script += start;
            for (const std::string& letter : option->get_snames()) script += " -s " + letter;
            for (const std::string& word : option->get_lnames()) script += " -l " + word;
            const std::vector<std::string> words = words_of(*option);
            if (!words.empty())
                script += fmt::format(" {} -a '{}'", only_words(*option) ? "-x" : "-r -F",
                                      fmt::join(words, " "));
            else if (takes_value(*option))
                script += takes_file(*option) ? " -r -F" : " -x";
            script += fmt::format(" -d '{}'\n", fish_text(option->get_description()));
        }
        if (const std::vector<std::string> words = argument_words(*command); !words.empty())
            script += fmt::format("{} -a '{}'\n", start, fmt::join(words, " "));
    }
    return script;
}

}  // namespace

const std::vector<std::string>& completion_shells() {
    static const std::vector<std::string> shells{"bash", "zsh", "fish"};
    return shells;
}

std::string completion_script(const CLI::App& app, const std::string& shell) {
    return shell == "bash" ? bash_script(app) : shell == "zsh" ? zsh_script(app) : fish_script(app);
}

}  // namespace vog::cli
