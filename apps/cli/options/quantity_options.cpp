// quantity_options.cpp: help and evaluation of the options of the shown quantity.
#include "options/quantity_options.h"

#include <fmt/core.h>

#include "shared/inputs.h"
#include "shared/validators.h"

namespace vog::cli {

namespace {
constexpr const char* kQuantityGroup = "Quantity";
}

void add_shown_options(CLI::App& command, QuantityArguments& arguments) {
    command
        .add_option(
            "--show", arguments.show,
            "Quantity of the picture: T (optical depth, coloured by V = 1 - exp(-T)), or "
            "column: column density, the integral of density along the ray in world units "
            "(of particles: number or value per area), or of --field: mean, weighted by "
            "density along the ray, or deviation, its standard deviation; coloured over "
            "--range. volume: emission and absorption by the value of --field or the "
            "volume's own, under --tf, --window, --band or --iso. maximum: the largest value "
            "of --field or of the volume's own along the ray")
        ->check(CLI::IsMember({"T", "column", "mean", "deviation", "volume", "maximum"}))
        ->capture_default_str();
    command.add_option(
        "--field", arguments.field,
        "Field that mean, deviation, volume and maximum show: temperature, velocity (a "
        "vector field's component along the view, away from the eye positive), "
        "velocity.x, .y, .z, or velocity.magnitude (root mean square). Default: volume and "
        "maximum show the density; a page begins with the first field");
    command.add_option(
        "--range", arguments.range,
        "Values LO,HI at the two ends of --tf; default: of the first picture, column "
        "densities from 0 to the largest, logarithmic from the 5th percentile, at most four "
        "decades; fields from the 1st to the 99th percentile; volume: those of "
        "the data, weighted by mass");
    command.add_flag("--log", arguments.log, "Logarithmic colours, as --scale log");
}

void add_quantity_options(CLI::App& command, QuantityArguments& arguments) {
    const OptionGroup grouped(command, kQuantityGroup);
    add_shown_options(command, arguments);
    command
        .add_option("--scale", arguments.scale,
                    "Colour scale: linear, log, for fields symmetric, whose range is centred at 0, "
                    "or auto: "
                    "linear, of volume log where values above 0 extend over a decade and more")
        ->check(CLI::IsMember({"auto", "linear", "log", "symmetric"}))
        ->capture_default_str();
    command.add_option(
        "--units", arguments.units,
        "Unit of the shown quantity: numbers convert to it where the data state theirs (fields, "
        "dense images with units of values and lengths), else it is a text for the colour bar "
        "and the report, such as 'g/cm2'; default: the data's");
    command.add_flag("--color-bar", arguments.color_bar,
                     "Add a colour bar with ticks on the right of the picture, which becomes "
                     "wider; an orthographic picture along axes gets "
                     "coordinates on the left and below");
    command.add_flag("--axes", arguments.axes,
                     "Draw the outline of the data's box, with coordinates along its edges; a "
                     "fitted picture holds it whole");
    command.add_flag(
        "--scale-bar", arguments.scale_bar,
        "Draw a bar of a round length, in world units, at the depth of the point looked at");
    command.add_option("--title", arguments.title, "Text above the picture, which becomes higher");
    command
        .add_option(
            "--least-column", arguments.least_column,
            "Share of the largest column below which a picture of a field shows nothing: the "
            "mean of next to nothing is no colour. Files of values have every pixel")
        ->check(non_negative_number())  // the range alone lets NaN through
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command.add_option(
        "--values-out", arguments.values_output,
        "File of the shown quantity as float32 numbers, height x width, rows from the "
        "top: .npy or .exr; of a field the .exr has the channels column, mean and "
        "deviation. A folder where -o is one: .npy files");
}

std::optional<ColorScale> fixed_scale(const QuantityArguments& arguments) {
    if (arguments.range.empty()) return std::nullopt;
    const std::size_t comma = arguments.range.find(',');
    const auto wrong = [&] {
        return CLI::ValidationError(
            fmt::format("--range {}: expected LO,HI, two numbers, the first below the second{}",
                        arguments.range, arguments.logarithmic() ? " and above 0 (--log)" : ""));
    };
    if (comma == std::string::npos) throw wrong();
    try {
        std::size_t low_end = 0, high_end = 0;
        const std::string low = arguments.range.substr(0, comma);
        const std::string high = arguments.range.substr(comma + 1);
        const ColorScale scale{
            arguments.logarithmic() ? ColorScale::Kind::log : ColorScale::Kind::linear,
            std::stod(low, &low_end), std::stod(high, &high_end)};
        if (low_end != low.size() || high_end != high.size()) throw wrong();
        (void)scale_position(scale, 0);  // checks the range
        return scale;
    } catch (const std::exception&) {
        throw wrong();
    }
}

void check_quantity_options(const QuantityArguments& arguments) {
    if (is_field_map(arguments.shown()) && arguments.field.empty())
        throw CLI::ValidationError(fmt::format("--show {}: expected --field NAME", arguments.show));
    (void)fixed_scale(arguments);
}

}  // namespace vog::cli
