// render_options.cpp: help and checks of the options of vog render.
#include <CLI/CLI.hpp>

#include "commands/commands.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

namespace {

void add_drawing_options(CLI::App& command, DrawingArguments& arguments) {
    command
        .add_option("inputs", arguments.inputs,
                    "Models (.ply, .vogz, sites), volumes (.vdb, .nvdb, dense images) or particles "
                    "(.xyz, .csv, .tsv, .vdb, .hdf5); several become one picture")
        ->required();
    add_volume_options(command, arguments.volume);
    add_point_options(command, arguments.points);
}

/// Adds --request, with which inputs may be absent.
void add_request_option(CLI::App& command, RenderArguments& arguments) {
    command
        .add_option("--request", arguments.request_file,
                    "Draw a picture again: from a PNG or EXR written by vog, its JSON (\"request\" "
                    "of --json), or a page's link. It contains all options and, except for a link, "
                    "the inputs. Options on the command line override it")
        ->each([&command](const std::string&) { command.get_option("inputs")->required(false); });
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& arguments) {
    command.add_option(
        "-o,--output", arguments.output,
        "Picture to write, .png or float .exr. Default: INPUT.png in the current directory; -2, "
        "-3, ... is appended rather than overwriting. A folder (a name ending in /), a numbered "
        "name (t_%04d.png) or a film (.mp4, .webm; needs ffmpeg) gets one picture per input, all "
        "with the same camera and extinction");
    add_value(command, "--turntable", arguments.turntable, "[1, 9999]",
              "Turn the view once about the up axis in this many pictures, showing all inputs "
              "together. -o must be a folder (0001.png, ...), a numbered name or a film. The first "
              "picture sets extinction and range");
    command.add_flag(
        "--steps", arguments.steps,
        "With --turntable: the inputs are time steps, which play once during the turn");
    add_value(command, setting("fps"), arguments.per_second, "[0.01, 240]",
              "Frames per second of a film");
    command.add_option("--depth-out", arguments.depth_output,
                       "Write the optical depth T to an .exr with one float channel Y");
    command.add_option(
        "--values-out", arguments.values_output,
        "Write the quantity's numbers as float32, height x width, rows from the top: .npy or .exr. "
        "For a field the .exr has the channels column, mean and deviation; for volume the numbers "
        "are the opacity. If -o is a folder, this is a folder of .npy files");
    add_drawing_options(command, arguments.drawing);
    add_request_option(command, arguments);
    add_view_options(command, arguments.view);
    add_request_options(command, arguments.words);
    add_memory_options(command, arguments.memory, "");
    add_value(command, "--repeat", arguments.repeat, "[1, 100000]",
              "Render this many times after one warm-up, and report the minimum, median and "
              "maximum time");
    add_run_options(command, arguments.threads, arguments.json, arguments.verbose);
}

}  // namespace vog::cli
