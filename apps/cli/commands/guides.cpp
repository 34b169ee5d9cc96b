// guides.cpp: vog completion and vog man: texts for shells and for man, from the options themselves.
#include <memory>
#include <string>

#include "commands/commands.h"
#include "help/completion.h"
#include "help/man_page.h"
#include "options/parser/command_line.h"
#include "shared/terminal.h"

namespace vog::cli {

void add_guides(CLI::App& app) {
    auto shell = std::make_shared<std::string>();
    CLI::App* completion = app.add_subcommand(
        "completion", "Print a script that completes commands and options in a shell");
    completion
        ->add_option("shell", *shell,
                     "Shell; for example: source <(vog completion bash), or vog completion fish > "
                     "~/.config/fish/completions/vog.fish")
        ->check(CLI::IsMember(completion_shells()))
        ->required();
    completion->callback(
        [&app, shell] { print_text(completion_script(program_text(app), *shell)); });

    auto page = std::make_shared<std::string>();
    CLI::App* man = app.add_subcommand("man", "Print a manual page: vog man render | man -l -");
    man->add_option("page", *page, "Command; default: the page of vog itself");
    man->callback([&app, page] { print_text(man_page(program_text(app), *page)); });
}

}  // namespace vog::cli
