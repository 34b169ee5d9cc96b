// value_comparison.cpp: differences of pictures by value, row by row.
#include "evaluate/values/value_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "evaluate/evaluated_volumes.h"
#include "vog/compare.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/text.h"

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

ValueComparison::ValueComparison(const VolumeSet& data, const Box& box,
                                 const EvaluateOptions& options)
    : data_(&data), box_(box), width_(options.width), height_(options.height) {
    const std::vector<Volume>& volumes = data.volumes;
    // One name for all volumes, as a field of a mesh has.
    const std::string name = volumes.front().name.empty() ? "density" : volumes.front().name;
    for (const Volume& volume : volumes) values_.push_back(measure_field(volume, name));
    const double lower = std::ranges::min(values_, {}, &VoxelField::lower).lower;
    const double upper = std::ranges::max(values_, {}, &VoxelField::upper).upper;
    if (!(upper > volumes.front().background))
        throw Error(fmt::format("{}: no value above {}, expected some for pictures by value",
                                volumes.front().source, volumes.front().background));
    begin(scene_in(box, VoxelSource{borrowed(data), {{name, "", false, values_}}}), name, lower,
          upper, comparison::value_range(volumes, values_), options);
}

ValueComparison::ValueComparison(const Scene& cells, const EvaluateOptions& options)
    : box_(cells.subject.box), width_(options.width), height_(options.height) {
    const ScalarField& own = cells.model().model->fields.scalar.back();
    begin(cells, own.name, own.lower, own.upper, {std::min(own.lower, 0.0), own.spread.high},
          options);
}

void ValueComparison::begin(const Scene& scene, const std::string& field, double lower,
                            double upper, const comparison::ValueRange& range,
                            const EvaluateOptions& options) {
    functions_ =
        functions_of(options.value_functions, comparison::value_functions(range, box_.radius()),
                     lower, upper, box_.radius());
    for (const char* view : kValueViews) {
        Orbit orbit;
        orbit.distance_radii = kPaperDistanceRadii;
        set_view(orbit, view);
        views_.push_back(orbit_view(box_, orbit, double(width_) / height_));
    }
    reference_.resize(functions_.size());
    draw(scene, field, [&](std::size_t function, std::size_t, Image picture) {
        reference_[function].push_back(std::move(picture));
    });
}

std::vector<std::string> ValueComparison::names() const {
    std::vector<std::string> names;
    for (const ValueTransfer& function : functions_) names.push_back(function.name);
    return names;
}

void ValueComparison::draw(
    Scene scene, const std::string& field,
    const std::function<void(std::size_t function, std::size_t view, Image)>& take) const {
    PictureRequest request;
    request.show = Show::volume, request.field = field;
    request.width = width_, request.height = height_;
    request.transfer.may_be_empty = true;  // of other data the functions may show nothing
    PictureRenderer renderer(std::move(scene));
    Sums sums;
    for (std::size_t function = 0; function < functions_.size(); ++function) {
        request.transfer.points = transfer_points(functions_[function]);
        ResolvedPicture picture = resolve(request, renderer.scene());
        for (std::size_t view = 0; view < views_.size(); ++view) {
            picture.request.camera = views_[view];
            renderer.draw(picture, sums);
            take(function, view, over(sums.light, width_, height_, kBlack));
        }
    }
}

std::vector<std::vector<ValueResult>> ValueComparison::compare(Scene scene,
                                                               const std::string& field) const {
    std::vector<std::vector<ValueResult>> results(functions_.size());
    draw(std::move(scene), field,
         [&](std::size_t function, std::size_t view, const Image& picture) {
             const PictureDifference difference = vog::compare(reference_[function][view], picture);
             results[function].push_back({difference.psnr_db, difference.ssim});
         });
    return results;
}

std::vector<std::vector<ValueResult>> ValueComparison::compare(const Gaussians& model) const {
    const auto own = [](const Gaussians& of) {
        return std::ranges::find(of.fields.scalar, true, &ScalarField::is_measure);
    };
    std::optional<Gaussians> added;
    if (own(model) == model.fields.scalar.end()) {
        if (!data_)
            throw Error(
                fmt::format("{}: a model without the cells' density as a field, expected one of "
                            "vog.convert(cells)",
                            model.source));
        added = model;
        added->fields = {};
        const std::vector<std::vector<VoxelField>> fields{values_};
        add_fields(*added, data_->volumes, fields);
    }
    const Gaussians& drawn = added ? *added : model;
    return compare(scene_in(box_, drawn), own(drawn)->name);
}

}  // namespace vog::evaluation
