// output_options.cpp: help and checks of the options of pages, compact models and splats.
#include "options/output_options.h"

#include <CLI/CLI.hpp>

#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

void add_page_options(CLI::App& command, PageArguments& arguments) {
    const OptionGroup grouped(command, kPageGroup);
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    add("--title", arguments.title, "Title of the page; default: the name of the first model");
    add("--description", arguments.description, "Text below the title");
    add("--name", arguments.names,
        "Name of a model in the page's selector; repeat once per model. Default: the file's name")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_flag(
        "--precise", arguments.precise,
        "Numbers four times as fine, for 4 bytes more a Gaussian: rims "
        "of opaque surfaces differ by 2 of 255 from vog render's, else by up to 10. Of a site: "
        "as fine as a page without this option");
    command.add_flag(
        "--steps,!--no-steps", arguments.steps,
        "Whether the models are steps in time, with a play bar, one extinction and one "
        "range for all; default: where a single pattern names them");
    add_shown_options(command, arguments.words, kPageGroup);
    CLI::Option* background = command.get_option("--background");
    background->description(background->get_description() +
                            ", or system: black or white by the reader's colour scheme");
}

void add_compact_options(CLI::App& command, CompactArguments& arguments) {
    const OptionGroup grouped(command, kCompactGroup);
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    CLI::Option* loss =
        add("--max-loss", arguments.max_loss_db,
            "Largest loss of PSNR of V against the data in seven views, dB; the coarsest rounding "
            "within it is searched. Without it: --set rounding, about 0.1 dB")
            ->check(positive_number());
    CLI::Option* reference =
        add("--reference", arguments.reference,
            "With --max-loss: the data, volumes as FILE or FILE:GRID (several: levels of one "
            "mesh). Repeatable")
            ->needs(loss);
    add(setting("model-psnr"), arguments.model_psnr_db,
        "With --max-loss and no --reference: PSNR of V of the model against its data, dB; default "
        "50")
        ->check(positive_number())
        ->needs(loss)
        ->excludes(reference);
    add(setting("rounding"), arguments.step,
        "Step of masses, shapes and (in standard deviations) means relative to themselves, 1e-6 to "
        "0.5; default 0.025")
        ->check(CLI::Range(1e-6, 0.5))
        ->excludes(loss);
    add(setting("field-rounding"), arguments.field_step,
        "Step of field values relative to the range of the data, 1e-6 to 0.5; default 1/256")
        ->check(CLI::Range(1e-6, 0.5));
    command.add_flag(
        "--hierarchy", arguments.hierarchy,
        "Write the level-of-detail hierarchy, for readers of parts of the file; without "
        "it readers build their own");
    command.add_flag("--deflate", arguments.deflate,
                     "Entropy coder deflate, which browsers have built in, in place of zstd");
}

void add_splat_options(CLI::App& command, SplatArguments& arguments) {
    const OptionGroup grouped(command, kSplatGroup);
    command
        .add_option(
            "--as", arguments.layout,
            "Layout of a .ply: vog (exact), 3dgs (splats with opacities, for renderers of 3D "
            "Gaussian splatting) or volprim (volumetric primitives, for Mitsuba). Splats are white "
            "without --tf or --field, in every format")
        ->check(CLI::IsMember({"vog", "3dgs", "volprim"}))
        ->capture_default_str();
    command
        .add_option("--units", arguments.units,
                    "Coordinates of splats: box, the model's box centred at 0 with a longest edge "
                    "of 2, which viewers open in view; or world, those of the data. The file "
                    "states the scale. Default: box; world with --as volprim")
        ->check(CLI::IsMember({"world", "box"}));
}

}  // namespace vog::cli
