// input_options.cpp: help and checks of the options by which inputs are read.
#include "options/input_options.h"

#include <CLI/CLI.hpp>

#include "options/conversion_options.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"

namespace vog::cli {

void add_volume_options(CLI::App& command, VolumeInputOptions& options) {
    command.add_option("--grid", options.grid,
                       "Name of the grid to read. Default: the only scalar grid, else 'density', "
                       "else all levels or the largest (a note says which). A pattern with * or ? "
                       "reads all matching grids as levels of one mesh: 'density_L*'");
    command.add_option("--mask", options.mask,
                       "Grid whose values > 0 mark the valid region of a level. Inside, the level "
                       "hides coarser ones; outside, it is ignored. A * stands for the text "
                       "matched in --grid. Default: the level's own active voxels");
    command
        .add_option_function<std::string>(
            "--combine",
            [&options](const std::string& how) {
                options.sum = how == "sum";
                options.mesh = how == "mesh";
            },
            "How to combine several volumes. sum: add their densities. mesh: levels of one mesh; "
            "where they overlap, the smallest voxels count, or the first volume if they are equal. "
            "By default, volumes must be levels whose voxels divide each other evenly, or must not "
            "overlap")
        ->check(CLI::IsMember({"sum", "mesh"}));
    command.add_flag("--level-set-to-fog", options.level_set_to_fog,
                     "Convert a level set to a fog volume: density inside its surface");
    command.add_flag("--skip-nonfinite", options.values.skip_nonfinite,
                     "Leave out voxels, particles or splats with NaN or infinite values and report "
                     "their number; otherwise they are an error");
    command.add_flag("--clip-negative", options.values.clip_negative,
                     "Set negative densities or masses to 0 and report their number; otherwise "
                     "they are an error");
    command.add_option(
        setting("background-value"), options.values.background,
        "Value of empty space in a dense image; density is the value above it. Default: -1000 for "
        "Hounsfield units, the upper end of background noise, or 0");
}

void add_point_options(CLI::App& command, PointInputOptions& options) {
    const OptionGroup grouped(command, kPointGroup);
    command
        .add_option("--columns", options.columns,
                    "Text files: the columns x,y,z or x,y,z,vx,vy,vz, by name or by number from 1; "
                    "default: columns of these names, else the first ones")
        ->delimiter(',');
    command.add_option("--value", options.value, conversion_text("value"));
    add_value(command, "--radius", options.radius, "",
              "Standard deviation of a particle's Gaussian, world units; adaptive: half the "
              "distance to its k-th nearest neighbour (--neighbours); or the attribute with the "
              "radii at which the particles' kernels end. auto: SmoothingLength where the file has "
              "it, else adaptive. With --method paper: its radius, sqrt(2) standard deviations; "
              "default: half the edge of a voxel that holds one particle on average");
    command
        .add_option("--periodic", options.periodic,
                    "Periodic box: its edge, x,y,z edges from 0, or x0,y0,z0,x1,y1,z1, world "
                    "units; auto: the box that the snapshot states (BoxSize), or the domain of a "
                    "mesh. What leaves through a face enters through the opposite one, neighbours "
                    "are found across faces, and pictures show the box alone")
        ->expected(0, 1);
    add_value(command, "--neighbours", options.neighbours, "[1, 64]",
              conversion_text("neighbours"));
}

}  // namespace vog::cli
