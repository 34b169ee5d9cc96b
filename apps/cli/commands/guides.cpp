// guides.cpp: vog completion, man and doctor: texts on the options themselves, and on this build and machine.
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands/commands.h"
#include "help/completion.h"
#include "help/machine_report.h"
#include "help/man_page.h"
#include "options/parser/command_line.h"
#include "terminal/terminal.h"
#include "vog/error.h"
#ifdef VOG_VIEWER
#include "screen/screen.h"
#endif

namespace vog::cli {

namespace {

/// Writes a manual page of section 1.
void write_page(const std::string& path, const std::string& text) {
    if (!(std::ofstream(path + ".1", std::ios::binary) << text).flush())
        throw Error(path + ".1: cannot write");
}

}  // namespace

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
    man->add_option("page", *page,
                    "Command; default: the page of vog itself. A folder, a name that ends in /: "
                    "all pages are written to it");
    man->callback([&app, page] {
        const ProgramText program = program_text(app);
        if (!page->ends_with('/')) return print_text(man_page(program, *page));
        write_page(*page + program.name, man_page(program, ""));
        for (const CommandText& command : program.commands)
            write_page(*page + program.name + "-" + command.name, man_page(program, command.name));
    });
}

void add_doctor(CLI::App& app) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand(
        "doctor", "Print the abilities of this build and this machine, for bug reports");
    command->add_flag("--json", *json, "Print a single JSON object");
    command->callback([json] {
#ifdef VOG_VIEWER
        const nlohmann::ordered_json report = machine_report(viewer::headless_gl_name);
#else
        const nlohmann::ordered_json report = machine_report({});
#endif
        if (*json)
            print_json(report);
        else
            print_text(machine_text(report));
    });
}

}  // namespace vog::cli
