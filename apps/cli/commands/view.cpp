// view.cpp: vog view: the interactive window, or a script without one.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "commands/commands.h"
#include "conversion/volume_fields.h"
#include "files/film.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "models/page_quantity.h"
#include "options/camera_options.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "pictures/request_file.h"
#include "pictures/scene_inputs.h"
#include "terminal/terminal.h"
#include "terminal/usage_error.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/shade.h"
#include "vog/site.h"
#ifdef VOG_VIEWER
#include "viewer.h"
#endif

namespace vog::cli {

namespace {

struct WindowArguments {
    std::vector<std::string> inputs;
    std::string size = "1280x800", script;
    VolumeInputOptions volume;
    PointInputOptions points;
    ViewArguments view;
    RequestWords words;  ///< the first quantity, colours and clip
    bool headless = false, steps = false;
    double resolution = 1, ui_scale = 0;
    int threads = 0;
};

#ifdef VOG_VIEWER

/// Grid of --field: "velocity" of "velocity.x"; empty: none.
std::string field_grid(const WindowArguments& arguments) {
    const std::string text = arguments.words.word("field");
    for (const std::string part : {".x", ".y", ".z", ".magnitude"})
        if (text.ends_with(part)) return text.substr(0, text.size() - part.size());
    return text;
}

/// The first quantity, and the transfer functions of fields as they are shown.
void set_quantity(viewer::ViewerOptions& options, const PictureRequest& request) {
    const HtmlQuantity stated = html_quantity(request);
    options.quantity.show = show_named(stated.show);
    options.quantity.look = stated.look;
    options.quantity.slabs = request.slabs;
    options.field = stated.field;
    options.color_scale = stated.scale;
    options.fit = stated.fit;
    options.choose_transfer = [request](const Gaussians& model, const std::string& name,
                                        bool first) {
        // Ranges and bands are of the first field; others begin with the map over their own range.
        PictureRequest given = request;
        if (!first) {
            given.transfer = {};
            given.transfer.points = request.transfer.points;
            given.look = {};
        }
        std::vector<std::string> notes;
        return stated_transfer(given, model, *model.fields.find_scalar(name), notes);
    };
}

viewer::Content read_content(const std::vector<std::string>& files,
                             const WindowArguments& arguments) {
    viewer::Content content;
    std::vector<std::string> notes;
    switch (common_kind(files, arguments.volume.grid)) {
        case FileKind::model:
            if (files.size() == 1 && (content.site = find_site(files.front()))) break;
            content.model = load_models(files, &content.hierarchy, {}, arguments.volume.values);
            break;
        case FileKind::points:
            content.points = load_points(files, arguments.points, arguments.volume, notes);
            print_notes(notes);
            content.point_options = point_options(arguments.points);
            break;
        default:
            LoadedVolumes loaded = load_volumes(files, arguments.volume);
            print_notes(loaded.notes);
            const bool ones = arguments.volume.ones;
            content.read_fields = [files, ones, pattern = arguments.volume.grid,
                                   grid = field_grid(arguments)](std::span<Volume> volumes) {
                FieldTexts texts{{}, pattern, files, ones, own_name(volumes)};
                if (!grid.empty() && grid != texts.own) texts.texts.push_back(grid);
                std::vector<std::string> notes_of_fields;
                auto fields = read_volume_fields(texts, volumes, notes_of_fields);
                print_notes(notes_of_fields);
                return fields;
            };
            content.volumes = std::move(loaded);
    }
    return content;
}

/// Makes the steps in time of a site the inputs; of other models the first is shown.
void read_steps_of_site(WindowArguments& arguments, const GivenOptions& command) {
    const std::string site = arguments.inputs.front();
    const std::vector<std::string> models = models_of_one_site(arguments.inputs);
    if (models.empty()) return;
    if (!command.has("--steps")) arguments.steps = read_site_info(site).steps;
    if (arguments.steps)
        arguments.inputs = models;
    else
        note_first_model(site, models);
}

/// A film by ffmpeg.
class FilmSink : public viewer::PictureSink {
  public:
    FilmSink(const std::string& file, double per_second) : film_(file, per_second) {}
    void add(const Image& picture) override { film_.add(picture); }
    void finish() override { film_.finish(); }

  private:
    Film film_;
};

/// Reads the layers of volume pictures. The window opens the first input as it does without them.
void take_layers(viewer::ViewerOptions& options, const WindowArguments& arguments,
                 PictureRequest request) {
    if (arguments.steps) throw UsageError("--layer does not work with time steps");
    vog::require_effects(request);
    DrawingArguments drawing{arguments.inputs, {}, arguments.volume, arguments.points};
    place_layers(drawing, request);
    options.layers.scene = std::make_shared<const Scene>(load_layers(drawing, request, {}).scene);
    options.layers.layers = request.layers;
    options.layers.inputs = drawing.layer_inputs;
    options.files = drawing.inputs;
}

void open_viewer(WindowArguments arguments, const GivenOptions& command) {
    // Models that one pattern matches are steps in time.
    const bool pattern = arguments.inputs.size() == 1;
    arguments.inputs = expanded(arguments.inputs);
    if (pattern) read_steps_of_site(arguments, command);
    if (!command.has("--steps") && pattern && arguments.inputs.size() > 1)
        arguments.steps = common_kind(arguments.inputs, arguments.volume.grid) == FileKind::model;
    // Inputs and options are checked before a window opens.
    for (const std::string& input : arguments.inputs)
        if (!std::filesystem::exists(input) && !find_site(input))
            throw Error(fmt::format("{}: no such file", input));
    Facts facts = {{"show", word_of(arguments.words.show())}};
    if (!arguments.inputs.empty())
        facts["input"] =
            input_fact(common_kind(arguments.inputs, arguments.volume.grid), arguments.inputs);
    require_effects(command, facts);
    viewer::ViewerOptions options;
    options.files = arguments.inputs;
    const PictureRequest window = RequestWords{{{"size", {arguments.size}}}}.over();
    options.size = {window.width, window.height};
    options.headless = arguments.headless;
    options.script = arguments.script;
    options.steps = arguments.steps;
    options.open_film = [](const std::string& file, double per_second) {
        return std::make_unique<FilmSink>(file, per_second);
    };
    options.scale = arguments.resolution;
    options.ui_scale = arguments.ui_scale;
    // Throws for options that exclude each other.
    const double aspect = double(window.width) / window.height;
    PictureRequest request = arguments.words.over();
    camera_from(arguments.view, command, {}, request, aspect);
    options.camera = [&, aspect](const Subject& subject) {
        return camera_from(arguments.view, command, subject, request, aspect);
    };
    if (!request.layers.empty()) take_layers(options, arguments, request);
    request.layers.clear();  // the window opens the first input
    options.extinction = request.extinction.value_or(options.extinction);
    viewer::load_map(options.look, arguments.words.word("tf", default_map(request.show)));
    options.look.shading = request.shading;
    set_quantity(options, request);
    options.read = [&](const std::vector<std::string>& files) {
        return read_content(files, arguments);
    };
    const ThreadLimit limit(arguments.threads);
    viewer::run(options);
}

#else

void open_viewer(const WindowArguments&, const GivenOptions&) {
    throw Error("view: this build has no window (it was configured with -DVOG_VIEWER=OFF)");
}

#endif

}  // namespace

void add_view(CLI::App& app) {
    auto arguments = std::make_shared<WindowArguments>();
    CLI::App* command =
        app.add_subcommand("view", "Explore volumes, particles and models in a window");
    command->add_option("inputs", arguments->inputs,
                        "Models, volumes (several: levels or parts of one mesh) or particles. You "
                        "can drop more files on the window");
    command->add_flag("--steps,!--no-steps", arguments->steps,
                      "Treat the models as time steps, with a play bar, one extinction and one "
                      "range. Default: yes if a single pattern names them");
    add_value(*command, "--size", arguments->size, "", "Size of the window in pixels, WxH");
    command->add_option("--script", arguments->script,
                        "Run the actions in this file, then exit (docs/viewer.md)");
    command->add_flag("--headless", arguments->headless,
                      "Run the script without a window and write only its pictures");
    add_value(*command, setting("resolution"), arguments->resolution, "[0.1, 4]",
              "Rendered pixels per screen pixel, along an edge");
    add_value(*command, setting("ui-scale"), arguments->ui_scale, "[0, 8]",
              "Scale of text and controls; 0: the display's scale");
    add_volume_options(*command, arguments->volume);
    add_point_options(*command, arguments->points);
    add_view_options(*command, arguments->view);
    add_shown_options(*command, arguments->words);
    add_member_options(*command, arguments->words, {"layers"});
    add_threads_option(*command, arguments->threads);
    on_run(*command, [arguments](GivenOptions& given) { open_viewer(*arguments, given); });
}

}  // namespace vog::cli
