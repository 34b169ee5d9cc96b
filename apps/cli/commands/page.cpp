// page.cpp: vog page: models to an HTML page for a browser, a page per input, or a site that streams large models.
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "models/page_options.h"
#include "models/site_run.h"
#include "options/memory_options.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct PageCommand {
    ModelArguments models;
    PageArguments page;
    RoundingArguments rounding;
    MemoryArguments memory;
    std::size_t levels = 8;
    bool site = false;  ///< --site
    std::string from;   ///< --from; empty: the models lie in the page or beside it
};

/// Whether a folder is written as a site: of one input, or with --site.
bool makes_site(const PageCommand& arguments) {
    return is_sequence(arguments.models.output) &&
           (arguments.site || arguments.models.inputs.size() == 1);
}

/// throws  UsageError for options without effect, and for names that are too many or too few
void check(const PageCommand& arguments, const GivenOptions& command, FileKind kind) {
    require_effects(command, {{"input", input_fact(kind, arguments.models.inputs)},
                              {"output", makes_site(arguments) ? "site" : ".html"},
                              {"show", word_of(arguments.page.words.show())}});
}

Json report_page(const PageCommand& arguments, const std::vector<HtmlModel>& entries,
                 const HtmlReport& report, const Stages& stages) {
    const std::string& output = arguments.models.output;
    Json json = {{"output", output},
                 {"bytes", report.bytes},
                 {"viewer_bytes", report.viewer_bytes},
                 {"gaussians", report.gaussians},
                 {"extinction", report.extinction}};
    for (const HtmlModel& entry : entries) {
        std::string text;
        Json counts = Json::array();
        for (const Gaussians& level : entry.levels) {
            text += (text.empty() ? "" : ", ") + count_text(level.size());
            counts.push_back(level.size());
        }
        if (!arguments.models.json) print_line(fmt::format("{}: {} Gaussians", entry.name, text));
        json["models"].push_back({{"name", entry.name}, {"levels", counts}});
    }
    if (!arguments.models.json)
        print_line(fmt::format("{}: {}, {} of them the viewer", output, bytes_text(report.bytes),
                               bytes_text(report.viewer_bytes)));
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    return json;
}

/// One page.
struct WrittenPage {
    Json json;              ///< the report of --json
    double extinction = 1;  ///< of its first model
    HtmlQuantity quantity{};
};

WrittenPage write_page(const PageCommand& arguments, const GivenOptions& command) {
    const ModelArguments& models = arguments.models;
    check_output(models.output, models.inputs, {".html"});
    Stages stages(models.verbose);
    ModelInputs inputs(models, stages);
    check(arguments, command, inputs.kind());
    check_names(arguments.page, inputs.count());
    std::vector<HtmlModel> entries;
    for (std::size_t n = 0; n < inputs.count(); ++n)
        entries.push_back(
            {model_name(arguments.page, models.inputs[n], n), inputs.levels(n, arguments.levels)});
    const HtmlOptions options = page_options(arguments.page, command, entries.front(),
                                             models.inputs.front(), inputs.notes());
    const HtmlReport report =
        stages.run("save", [&] { return write_html(models.output, entries, options); });
    WrittenPage made{report_page(arguments, entries, report, stages), report.extinction,
                     options.quantity};
    if (!inputs.notes().empty()) made.json["notes"] = inputs.notes();
    return made;
}

/// Writes one page per input, under one camera, which frames all boxes, and the extinction of the
/// first page.
/// returns  the report of --json
Json write_pages(const PageCommand& all, const GivenOptions& command) {
    if (!all.page.names.empty())
        throw UsageError("--name works for one page or site, not for a folder of pages");
    PageCommand one = all;
    one.page.subject = Subject{};
    for (const std::string& input : all.models.inputs)
        one.page.subject->include(subject_of(input, all.models.volume, all.models.points));
    Json pages = Json::array();
    for (const Frame& frame : frames_of(all.models.inputs, all.models.output, ".html")) {
        one.models.inputs = {frame.input};
        one.models.output = frame.output;
        const WrittenPage page = write_page(one, command);
        // After the first page, its automatic extinction and transfer function.
        one.page.chosen = page.quantity;
        one.page.words.given["extinction"] = {fmt::format("{:.17g}", page.extinction)};
        pages.push_back(page.json);
    }
    return {{"output", all.models.output}, {"pages", pages}};
}

/// Writes a site: the models' chunks, the manifest, and the page.
/// returns  the report of --json
Json write_site(const PageCommand& arguments, const GivenOptions& command) {
    const ModelArguments& models = arguments.models;
    Stages stages(models.verbose);
    ModelInputs inputs(models, stages);
    check(arguments, command, inputs.kind());
    check_names(arguments.page, inputs.count());
    refuse_own_folder(models.inputs, models.output);
    const CommandMemory memory(arguments.memory);
    const WrittenSite site = write_site(
        models.output, site_precision(arguments.rounding, arguments.page.precise), inputs.count(),
        [&](std::size_t n) {
            InputModel input = inputs.read(n, true);
            input.name = model_name(arguments.page, models.inputs[n], n);
            return input;
        },
        [&](const HtmlModel& first) {
            return page_options(arguments.page, command, first, models.inputs.front(),
                                inputs.notes());
        },
        stages);
    return report_site(models.output, !models.json, site, stages, inputs.notes());
}

/// Writes the page of a site or a compact file whose copy lies at an address.
/// returns  the report of --json
Json write_page_of_copy(const PageCommand& given, const GivenOptions& command) {
    const ModelArguments& models = given.models;
    check(given, command, FileKind::model);
    if (is_sequence(models.output)) throw UsageError("--from writes only a page: use -o NAME.html");
    check_output(models.output, models.inputs, {".html"});
    const std::string& input = models.inputs.front();
    const bool site = is_site(input);
    if (models.inputs.size() > 1 || (!site && extension_of(input) != ".vogz"))
        throw UsageError(
            "--from needs one input: the site (a folder) or compact model (.vogz) whose copy is at "
            "the address");
    PageArguments page = given.page;
    if (site && !command.has("--steps")) page.steps = read_site_info(input).steps;
    HtmlSource source{given.from, !site};
    if (site && !source.url.ends_with('/')) source.url += '/';
    Stages stages(models.verbose);
    std::vector<std::string> notes;
    std::vector<HtmlModel> entries = stages.run("load", [&] { return models_to_stream(input); });
    check_names(page, entries.size());
    for (std::size_t n = 0; n < page.names.size(); ++n) entries[n].name = page.names[n];
    const HtmlOptions options = page_options(page, command, entries.front(), input, notes);
    const HtmlReport report = stages.run(
        "save", [&] { return write_streaming_page(models.output, entries, source, options); });
    if (!models.json)
        print_line(
            fmt::format("{}: {}, streams {}", models.output, bytes_text(report.bytes), source.url));
    Json json = {{"output", models.output},
                 {"bytes", report.bytes},
                 {"from", source.url},
                 {"extinction", report.extinction}};
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    if (!notes.empty()) json["notes"] = notes;
    return json;
}

/// Makes the models of a site the inputs.
void read_models_of_site(PageCommand& arguments, const GivenOptions& command) {
    const std::string site = arguments.models.inputs.front();
    const std::vector<std::string> models = models_of_one_site(arguments.models.inputs);
    if (models.empty()) return;
    arguments.models.inputs = models;
    arguments.site = is_sequence(arguments.models.output);
    if (!command.has("--steps")) arguments.page.steps = read_site_info(site).steps;
}

void run(const PageCommand& given, const GivenOptions& command) {
    PageCommand arguments = given;
    ModelArguments& models = arguments.models;
    const bool folder = is_sequence(models.output);
    models.inputs = expanded(models.inputs);
    // Models that one pattern matches are steps in time, named ones are to be compared.
    if (!command.has("--steps") && given.models.inputs.size() == 1 && models.inputs.size() > 1 &&
        (arguments.site || !folder) &&
        common_kind(models.inputs, models.volume.grid) == FileKind::model) {
        arguments.page.steps = true;
        note(fmt::format("{}: {} models as time steps (--no-steps: a switch between them instead)",
                         given.models.inputs.front(), models.inputs.size()));
    }
    if (!command.has("--from")) read_models_of_site(arguments, command);
    std::vector<std::string> read = models.inputs;
    read.insert(read.end(), {arguments.page.view.camera_file, arguments.page.words.word("tf")});
    check_distinct({folder ? "" : models.output}, read);
    const ThreadLimit limit(models.threads);
    const Json json = command.has("--from")   ? write_page_of_copy(arguments, command)
                      : makes_site(arguments) ? write_site(arguments, command)
                      : folder                ? write_pages(arguments, command)
                                              : write_page(arguments, command).json;
    if (models.json) print_json(json);
}

}  // namespace

void add_page(CLI::App& app) {
    auto arguments = std::make_shared<PageCommand>();
    CLI::App* command =
        app.add_subcommand("page",
                           "Write models to one self-contained page for a browser, or large models "
                           "to a site, whose page loads what a view needs");
    add_model_options(*command, arguments->models,
                      "Page to write (.html). A folder (a name ending in /): for one input, a site "
                      "for any web server; for several, one page each with the same camera and "
                      "extinction, or one site with --site");
    command->add_flag("--site", arguments->site,
                      "Write several models as one site (-o FOLDER/). Models named by one quoted "
                      "pattern become time steps");
    add_no_fields_option(*command, arguments->models.no_fields);
    add_page_options(*command, arguments->page);
    command
        ->add_option("--from", arguments->from,
                     "Address of a copy of the input, which the page streams: a site's folder, or "
                     "a compact model written with --hierarchy --deflate. The address is https, "
                     "http, or relative to the page")
        ->group(kPageGroup);
    add_value(*command, setting("levels"), arguments->levels, "[1, 32]",
              "Largest number of levels of detail in the page: the model itself, then a quarter as "
              "many Gaussians each time; 1: only the model")
        ->group(kPageGroup);
    {
        const OptionGroup grouped(*command, "Site");
        add_rounding_options(*command, arguments->rounding);
    }
    add_view_options(*command, arguments->page.view);
    add_memory_options(*command, arguments->memory, ". For sites");
    on_run(*command, [arguments](GivenOptions& given) { run(*arguments, given); });
}

}  // namespace vog::cli
