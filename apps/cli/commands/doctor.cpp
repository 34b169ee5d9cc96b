// doctor.cpp: vog doctor: what this build and this machine can do, for bug reports.
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "help/machine_report.h"
#include "shared/terminal.h"
#ifdef VOG_VIEWER
#include "screen/screen.h"
#endif

namespace vog::cli {

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
