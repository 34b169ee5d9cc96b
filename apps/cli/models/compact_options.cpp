// compact_options.cpp: options of compact models (.vogz).
#include "models/compact_options.h"

#include "shared/validators.h"

namespace vog::cli {

void add_compact_options(CLI::App& command, CompactArguments& arguments) {
    const OptionGroup grouped(command, kCompactGroup);
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    CLI::Option* loss =
        add("--max-loss", arguments.max_loss_db,
            "Largest loss of PSNR of V against the data in seven views, dB; the coarsest rounding "
            "within it is searched. Without it: --step, about 0.1 dB")
            ->check(positive_number());
    CLI::Option* reference =
        add("--reference", arguments.reference,
            "With --max-loss: the data, volumes as FILE or FILE:GRID (several: levels of one "
            "mesh). Repeatable")
            ->needs(loss);
    add("--model-psnr", arguments.model_psnr_db,
        "With --max-loss and no --reference: PSNR of V of the model against its data, dB; default "
        "50")
        ->check(positive_number())
        ->needs(loss)
        ->excludes(reference);
    add("--step", arguments.step,
        "Step of masses, shapes and (in standard deviations) means relative to themselves, 1e-6 to "
        "0.5; default 0.025")
        ->check(CLI::Range(1e-6, 0.5))
        ->excludes(loss);
    add("--field-step", arguments.field_step,
        "Step of field values relative to the range of the data, 1e-6 to 0.5; default 1/256")
        ->check(CLI::Range(1e-6, 0.5));
    command.add_flag(
        "--hierarchy", arguments.hierarchy,
        "Write the level-of-detail hierarchy, for readers of parts of the file; without "
        "it readers build their own");
    command.add_flag("--deflate", arguments.deflate,
                     "Entropy coder deflate, which browsers have built in, in place of zstd");
}

}  // namespace vog::cli
