// completion.cpp: scripts for bash, zsh and fish, from the program's own commands and options.
#include "help/completion.h"

#include <fmt/format.h>

#include <algorithm>

#include "vog/shade.h"

namespace vog::cli {

namespace {

/// Words that an option or an argument takes; empty: any.
std::vector<std::string> words_of(const OptionText& option) {
    std::vector<std::string> words = option.choices;
    if (option.names.front() == "--tf")
        for (const std::string& name : transfer_function_names()) words.push_back(name);
    return words;
}
/// Whether the words are all there is: of --tf files are others.
bool only_words(const OptionText& option) { return !option.choices.empty(); }
/// Whether a value may be the name of a file: texts, but no numbers.
bool takes_file(const OptionText& option) { return option.takes == "TEXT" && !only_words(option); }

/// Words that the arguments of a command take, such as the shells of vog completion.
std::vector<std::string> argument_words(const CommandText& command) {
    for (const OptionText& option : command.options)
        if (option.argument && !option.choices.empty()) return option.choices;
    return {};
}
std::vector<std::string> option_words(const CommandText& command) {
    std::vector<std::string> all;
    for (const OptionText& option : named_options(command))
        all.insert(all.end(), option.names.begin(), option.names.end());
    return all;
}
std::vector<std::string> command_words(const ProgramText& program) {
    std::vector<std::string> all;
    for (const CommandText& command : program.commands) all.push_back(command.name);
    return all;
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

std::string bash_script(const ProgramText& program) {
    const std::string name = program.name;
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
        name, fmt::join(command_words(program), " "), fmt::join(option_words(program), " "));
    for (const CommandText& command : program.commands)
        for (const OptionText& option : named_options(command)) {
            if (option.takes.empty()) continue;
            std::vector<std::string> cases;
            for (const std::string& spelling : option.names)
                cases.push_back(command.name + "," + spelling);
            const std::vector<std::string> words = words_of(option);
            // Without words bash completes names of files; of numbers there are none.
            script += fmt::format(
                "        {})\n            {}\n            return ;;\n", fmt::join(cases, "|"),
                !words.empty()       ? fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))",
                                                   fmt::join(words, " "))
                : takes_file(option) ? ":"
                                     : "compopt +o default");
        }
    script += "    esac\n    case ${COMP_WORDS[1]} in\n";
    for (const CommandText& command : program.commands)
        script += fmt::format(
            "        {})\n            words=\"{}\"\n            [[ $word == -* ]] && words=\"{}\" "
            ";;\n",
            command.name, fmt::join(argument_words(command), " "),
            fmt::join(option_words(command), " "));
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
std::string zsh_action(const OptionText& option) {
    const std::vector<std::string> words = words_of(option);
    if (words.empty()) return takes_file(option) ? "_files" : " ";
    const std::string list = fmt::format("({})", fmt::join(words, " "));
    return only_words(option)
               ? list
               : fmt::format("{{_alternative \"names\\:name\\:{}\" \"files\\:file\\:_files\"}}",
                             list);
}

std::string zsh_script(const ProgramText& program) {
    const std::string name = program.name;
    std::string script = fmt::format(
        "#compdef {0}\n# Completion of {0} for zsh, made by: {0} completion zsh\n_{0}() {{\n"
        "    local curcontext=$curcontext state line\n    local -a commands\n"
        "    _arguments -C '--help[Print help]' '--version[Print the version]' \\\n"
        "        '1: :->command' '*:: :->argument'\n"
        "    case $state in\n    command)\n        commands=(\n",
        name);
    for (const CommandText& command : program.commands)
        script += fmt::format("            '{}:{}'\n", command.name, zsh_text(command.text));
    script +=
        "        )\n        _describe -t commands command commands\n        _files ;;\n    "
        "argument)\n        case $words[1] in\n";
    for (const CommandText& command : program.commands) {
        script += fmt::format("        {})\n            _arguments", command.name);
        for (const OptionText& option : named_options(command)) {
            const std::vector<std::string> names = option.names;
            const bool again = option.many;
            for (const std::string& spelling : names)
                script += fmt::format(" \\\n                '{}{}[{}]{}'",
                                      again ? "*" : fmt::format("({})", fmt::join(names, " ")),
                                      spelling, zsh_text(option.text),
                                      !option.takes.empty() ? ":value:" + zsh_action(option) : "");
        }
        const std::vector<std::string> words = argument_words(command);
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

/// " -l output -s o"
std::string fish_names(const OptionText& option) {
    std::string text;
    for (const std::string& name : option.names)
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    return text;
}

std::string fish_script(const ProgramText& program) {
    const std::string name = program.name;
    std::string script =
        fmt::format("# Completion of {0} for fish, made by: {0} completion fish\n", name);
    for (const CommandText& command : program.commands)
        script += fmt::format("complete -c {} -n __fish_use_subcommand -a {} -d '{}'\n", name,
                              command.name, fish_text(command.text));
    for (const OptionText& option : named_options(program))
        script += fmt::format("complete -c {} -n __fish_use_subcommand{} -d '{}'\n", name,
                              fish_names(option), fish_text(option.text));
    for (const CommandText& command : program.commands) {
        const std::string start =
            fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'", name, command.name);
        for (const OptionText& option : named_options(command)) {
            script += start + fish_names(option);
            const std::vector<std::string> words = words_of(option);
            if (!words.empty())
                script += fmt::format(" {} -a '{}'", only_words(option) ? "-x" : "-r -F",
                                      fmt::join(words, " "));
            else if (!option.takes.empty())
                script += takes_file(option) ? " -r -F" : " -x";
            script += fmt::format(" -d '{}'\n", fish_text(option.text));
        }
        if (const std::vector<std::string> words = argument_words(command); !words.empty())
            script += fmt::format("{} -a '{}'\n", start, fmt::join(words, " "));
    }
    return script;
}

}  // namespace

const std::vector<std::string>& completion_shells() {
    static const std::vector<std::string> shells{"bash", "zsh", "fish"};
    return shells;
}

std::string completion_script(const ProgramText& program, const std::string& shell) {
    return shell == "bash"  ? bash_script(program)
           : shell == "zsh" ? zsh_script(program)
                            : fish_script(program);
}

}  // namespace vog::cli
