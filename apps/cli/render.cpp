// render.cpp: vog render: load -> render -> shade -> image.
#include "commands.h"
#include "rendering.h"

namespace vog::cli {

void add_render(CLI::App& app) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    add_render_options(*command, *arguments);
    command->callback([arguments, command] { render(*arguments, *command); });
}

}  // namespace vog::cli
