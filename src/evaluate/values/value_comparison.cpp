// value_comparison.cpp: differences of pictures by value, row by row.
#include "evaluate/values/value_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "compare/values/value_functions.h"
#include "render/reference/reference.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/compare.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/text.h"
#include "vog/volume_picture.h"

namespace vog::evaluation {

namespace {

constexpr Rgba kBlack{0, 0, 0, 1};

/// The user's functions after the three of every evaluation.
std::vector<ValueTransfer> functions_of(const std::vector<std::string>& texts,
                                        std::vector<ValueTransfer> all, double lower, double upper,
                                        double radius) {
    for (const std::string& text : texts) {
        ValueTransfer read = read_value_transfer(text, std::min(lower, 0.0), upper, radius / 50);
        read.name = printable(text);
        if (std::ranges::find(all, read.name, &ValueTransfer::name) != all.end())
            throw Error(
                fmt::format("transfer function {}: twice, expected distinct ones", read.name));
        if (!(most_opacity(read, lower, upper) > 0))
            throw Error(fmt::format("{}: shows none of the data's values, {} to {}", read.name,
                                    lower, upper));
        all.push_back(std::move(read));
    }
    return all;
}

}  // namespace

ValueComparison::ValueComparison(std::span<const Volume> volumes, const Box& box,
                                 const EvaluateOptions& options)
    : volumes_(volumes), width_(options.width), height_(options.height) {
    // One name for all volumes, as a field of a mesh has.
    const std::string name = volumes.front().name.empty() ? "density" : volumes.front().name;
    for (const Volume& volume : volumes) values_.push_back(measure_field(volume, name));
    const double lower = std::ranges::min(values_, {}, &VoxelField::lower).lower;
    const double upper = std::ranges::max(values_, {}, &VoxelField::upper).upper;
    if (!(upper > 0))
        throw Error(fmt::format("{}: no value above 0, expected some for pictures by value",
                                volumes.front().source));
    functions_ = functions_of(
        options.value_functions,
        comparison::value_functions(comparison::value_range(volumes, values_), box.radius()), lower,
        upper, box.radius());
    for (const char* view : kValueViews) {
        Orbit orbit;
        orbit.distance_radii = kPaperDistanceRadii;
        set_view(orbit, view);
        views_.push_back(orbit_view(box, orbit, double(width_) / height_));
    }
    for (const ValueTransfer& function : functions_) {
        std::vector<Image>& pictures = reference_.emplace_back();
        for (const Camera& camera : views_)
            pictures.push_back(
                over(render_volume_reference(volumes_, values_, function, camera, width_, height_),
                     kBlack));
    }
}

std::vector<std::string> ValueComparison::names() const {
    std::vector<std::string> names;
    for (const ValueTransfer& function : functions_) names.push_back(function.name);
    return names;
}

std::vector<std::vector<ValueResult>> ValueComparison::compare(const Gaussians& model) const {
    const auto own = [](const Gaussians& of) {
        return std::ranges::find(of.fields.scalar, true, &ScalarField::is_measure);
    };
    std::optional<Gaussians> added;
    if (own(model) == model.fields.scalar.end()) {
        added = model;
        added->fields = {};
        const std::vector<std::vector<VoxelField>> fields{values_};
        add_fields(*added, volumes_, fields);
    }
    const Gaussians& drawn = added ? *added : model;
    SlabRenderer renderer(drawn, own(drawn)->name, functions_.front());
    std::vector<std::vector<ValueResult>> results;
    for (std::size_t f = 0; f < functions_.size(); ++f) {
        renderer.set_transfer(functions_[f]);
        std::vector<ValueResult>& of_function = results.emplace_back();
        for (std::size_t view = 0; view < views_.size(); ++view) {
            const PictureDifference difference = vog::compare(
                reference_[f][view], over(renderer.render(views_[view], width_, height_), kBlack));
            of_function.push_back({difference.psnr_db, difference.ssim});
        }
    }
    return results;
}

}  // namespace vog::evaluation
