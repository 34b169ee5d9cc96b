// compare.cpp: vog compare: error metrics of an image against a reference, and a heat map.
#include "vog/compare.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include <optional>

#include "commands/commands.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "options/request_options.h"
#include "terminal/terminal.h"
#include "vog/compare_maps.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::string reference, image, diff, extinction = "stored", tf = "inferno";
    double diff_limit = 0;
    bool json = false;
};

/// JSON number; null for infinite or undefined values, which JSON lacks.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string decibels(double psnr_db) {
    return std::isinf(psnr_db) ? "inf (no 8-bit value differs)" : fmt::format("{:.2f} dB", psnr_db);
}
std::string similarity(double ssim) {
    return std::isnan(ssim) ? "none (below 11x11 pixels)" : fmt::format("{:.5f}", ssim);
}
void line(const char* name, const std::string& value) {
    print_line(fmt::format("{:<20} {}", name, value));
}

void print(const PictureDifference& difference) {
    line("SSIM", similarity(difference.ssim));
    line("off by > 1 of 255", fmt::format("{:.3f} % of pixels", 100 * difference.share_off_1));
    line("off by > 4 of 255", fmt::format("{:.3f} % of pixels", 100 * difference.share_off_4));
    line("largest of 255", fmt::format("{} at column {}, row {}", difference.largest,
                                       difference.largest_column, difference.largest_row));
}
void add(Json& json, const PictureDifference& difference) {
    json["ssim"] = number(difference.ssim);
    json["off_by_more_than_1"] = difference.share_off_1;
    json["off_by_more_than_4"] = difference.share_off_4;
    json["largest"] = difference.largest;
    json["largest_at"] = {difference.largest_column, difference.largest_row};
}

/// Runs `work`, and puts the names of both files before an error of the library.
template <class Work>
auto naming_files(const CompareArguments& arguments, const Work& work) {
    try {
        return work();
    } catch (const Error& error) {
        throw Error(
            fmt::format("{} and {}: {}", arguments.reference, arguments.image, error.what()));
    }
}

void compare_pictures(const CompareArguments& arguments) {
    const Image a = read_image(arguments.reference), b = read_image(arguments.image);
    const PictureDifference difference = naming_files(arguments, [&] { return compare(a, b); });
    if (!arguments.diff.empty())
        write_png(arguments.diff, difference_map(a, b, {arguments.diff_limit, true}));

    if (!arguments.json) {
        line("pictures", fmt::format("{}x{}, 8 bits a channel", a.width, a.height));
        line("PSNR, RGB", decibels(difference.psnr_db));
        print(difference);
        return;
    }
    Json json = {{"reference", arguments.reference},
                 {"image", arguments.image},
                 {"kind", "picture"},
                 {"width", a.width},
                 {"height", a.height},
                 {"identical", difference.largest == 0},
                 {"psnr_rgb_db", number(difference.psnr_db)}};
    add(json, difference);
    print_json(json);
}

/// Scales the reference's T to the extinction of --extinction; compare() scales the other image.
void scale_to_extinction(const std::string& text, DepthImage& reference) {
    if (text == "stored") return;
    const std::optional<double> given = RequestWords{{{"extinction", {text}}}}.over().extinction;
    set_extinction(reference, given ? *given : auto_extinction(reference));
}

void compare_depths(const CompareArguments& arguments) {
    DepthImage a = read_depth(arguments.reference), b = read_depth(arguments.image);
    const TransferFunction tf = load_transfer_function(arguments.tf);
    const double own_a = a.extinction, own_b = b.extinction;
    scale_to_extinction(arguments.extinction, a);
    const DepthDifference difference = naming_files(arguments, [&] { return compare(a, b); });
    const PictureDifference shaded = compare_shaded(a, b, tf);
    if (!arguments.diff.empty())
        write_png(arguments.diff, difference_map(a, b, {arguments.diff_limit, true}));

    if (!arguments.json) {
        line("depth images",
             fmt::format("{}x{}, at extinction {:.6g}", a.width, a.height, difference.extinction));
        if (own_a != a.extinction || own_b != a.extinction)
            line("", fmt::format("stored at {:.6g} and {:.6g}: T is scaled", own_a, own_b));
        line("PSNR, V as grey", decibels(difference.grey.psnr_db));
        line("PSNR, RGB", decibels(shaded.psnr_db) + ", " + tf.name);
        line("relative L2 of T", fmt::format("{:.6g}", difference.relative_l2));
        line("bias of T", fmt::format("{:.6g}", difference.bias));
        line("largest dT", fmt::format("{:+.6g} at column {}, row {}", difference.largest_dt,
                                       difference.largest_column, difference.largest_row));
        print(difference.grey);
        return;
    }
    Json json = {{"reference", arguments.reference},
                 {"image", arguments.image},
                 {"kind", "depth"},
                 {"width", a.width},
                 {"height", a.height},
                 {"identical", difference.identical},
                 {"extinction", difference.extinction},
                 {"stored_extinction", {own_a, own_b}},
                 {"psnr_v_db", number(difference.grey.psnr_db)},
                 {"psnr_rgb_db", number(shaded.psnr_db)},
                 {"tf", tf.name},
                 {"relative_l2", number(difference.relative_l2)},
                 {"bias", number(difference.bias)},
                 {"max_abs_dt", std::abs(difference.largest_dt)},
                 {"dt", difference.largest_dt},
                 {"dt_at", {difference.largest_column, difference.largest_row}}};
    add(json, difference.grey);
    print_json(json);
}

void line_at(const char* name, double largest, int column, int row) {
    line(name, fmt::format("{:+.6g} at column {}, row {}", largest, column, row));
}

/// Compares one map with another: .npy.
void compare_maps(const CompareArguments& arguments) {
    const ValueMap a = read_map(arguments.reference), b = read_map(arguments.image);
    const MapDifference difference = naming_files(arguments, [&] { return compare(a, b); });
    if (!arguments.json) {
        line("maps", fmt::format("{}x{}, {:.3f} % of pixels have a reference", a.width, a.height,
                                 100 * difference.counted));
        line("relative L2", fmt::format("{:.6g}", difference.relative_l2));
        line("bias", fmt::format("{:+.6g}", difference.bias));
        line_at("largest", difference.largest, difference.largest_column, difference.largest_row);
        line("missing", fmt::format("{:.3f} % of these pixels", 100 * difference.missing));
        return;
    }
    print_json({{"reference", arguments.reference},
                {"image", arguments.image},
                {"kind", "map"},
                {"width", a.width},
                {"height", a.height},
                {"relative_l2", number(difference.relative_l2)},
                {"bias", number(difference.bias)},
                {"largest", number(difference.largest)},
                {"largest_at", {difference.largest_column, difference.largest_row}},
                {"counted", difference.counted},
                {"missing", difference.missing}});
}

/// Compares the three maps of a field: .exr.
void compare_fields(const CompareArguments& arguments) {
    const FieldMaps a = read_field_maps(arguments.reference), b = read_field_maps(arguments.image);
    const FieldDifference difference = naming_files(arguments, [&] { return compare(a, b); });
    if (!arguments.json) {
        line("maps of a field", fmt::format("{}x{}, {:.3f} % of pixels counted (column above a "
                                            "thousandth of the largest), weighted by column",
                                            a.width, a.height, 100 * difference.counted));
        line("L2 of column", fmt::format("{:.6g}, all pixels", difference.column_l2));
        line("L2 of mean", fmt::format("{:.6g}", difference.mean_l2));
        line("L2 of deviation", fmt::format("{:.6g} of the rms value", difference.deviation_l2));
        line("bias of mean", fmt::format("{:+.6g}", difference.mean_bias));
        line("bias of deviation", fmt::format("{:+.6g}", difference.deviation_bias));
        line_at("largest of mean", difference.largest_mean, difference.largest_column,
                difference.largest_row);
        line("missing", fmt::format("{:.3f} % of the weight", 100 * difference.missing));
        return;
    }
    print_json({{"reference", arguments.reference},
                {"image", arguments.image},
                {"kind", "field"},
                {"width", a.width},
                {"height", a.height},
                {"column_l2", number(difference.column_l2)},
                {"mean_l2", number(difference.mean_l2)},
                {"deviation_l2", number(difference.deviation_l2)},
                {"mean_bias", number(difference.mean_bias)},
                {"deviation_bias", number(difference.deviation_bias)},
                {"largest_mean", number(difference.largest_mean)},
                {"largest_at", {difference.largest_column, difference.largest_row}},
                {"counted", difference.counted},
                {"missing", difference.missing}});
}

/// Contents of a file, by which files are compared.
enum class Compared { picture, depth, map, field };
constexpr const char* kKindNames[] = {"picture", "depth image", "map", "file of a field's maps"};
Compared compared_kind(const std::string& file) {
    if (is_map_file(file)) return is_field_file(file) ? Compared::field : Compared::map;
    return is_depth_file(file) ? Compared::depth : Compared::picture;
}

void compare_files(const CompareArguments& arguments, const GivenOptions& command) {
    if (!arguments.diff.empty())
        check_output(arguments.diff, {arguments.reference, arguments.image, arguments.tf},
                     {".png"});
    const Compared kind = compared_kind(arguments.reference),
                   other = compared_kind(arguments.image);
    const auto name = [](Compared of) { return kKindNames[static_cast<std::size_t>(of)]; };
    if (other != kind)
        throw Error(fmt::format("{} is a {}; to compare it, use a {} like {}", arguments.image,
                                name(other), name(kind), arguments.reference));
    constexpr const char* kFacts[] = {"pictures", "depth-images", "maps", "maps"};
    require_effects(command, {{"input", kFacts[static_cast<std::size_t>(kind)]}});
    switch (kind) {
        case Compared::map:
            return compare_maps(arguments);
        case Compared::field:
            return compare_fields(arguments);
        case Compared::depth:
            return compare_depths(arguments);
        case Compared::picture:
            return compare_pictures(arguments);
    }
}

}  // namespace

void add_compare(CLI::App& app) {
    auto arguments = std::make_shared<CompareArguments>();
    CLI::App* command = app.add_subcommand(
        "compare", "Measure the error of a picture, depth image or map against a reference");
    command
        ->add_option("reference", arguments->reference,
                     "Reference: a picture (.png, colour .exr), a depth image (.exr with one "
                     "channel Y, the optical depth T), or maps of a field from vog render "
                     "--values-out (.npy, .exr with column, mean and deviation)")
        ->required();
    command
        ->add_option("image", arguments->image,
                     "Image to compare with the reference; same kind and size")
        ->required();
    command->add_option("--diff", arguments->diff,
                        "Write a heat map of the differences (.png): of V = 1 - exp(-T) for depth "
                        "images, of the most different channel for pictures");
    add_value(*command, setting("diff-limit"), arguments->diff_limit, "[0, inf)",
              "End of the heat map's scale, in units of 1/255; 0: the largest difference, rounded "
              "up to 1, 2 or 5 times a power of ten");
    add_value(*command, "--extinction", arguments->extinction, "",
              "Extinction at which depth images are compared: stored (the reference's), a number, "
              "or auto, which makes the 99th percentile of the reference's non-zero T 4");
    add_value(*command, "--tf", arguments->tf, "",
              "Transfer function for the RGB figures of depth images: a name or a JSON file");
    command->add_flag("--json", arguments->json,
                      "Print a single JSON object; null means infinite or undefined");
    on_run(*command, [arguments](GivenOptions& given) { compare_files(*arguments, given); });
}

}  // namespace vog::cli
