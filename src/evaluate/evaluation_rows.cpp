// evaluation_rows.cpp: conversions and views of an evaluation.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/evaluate.h"

namespace vog {

namespace {

/// Distance from the centre of the box to its surface along a unit direction, world units.
double distance_to_face(const Box& box, Vec3d direction) {
    double distance = std::numeric_limits<double>::infinity();
    const Vec3d half = 0.5 * (box.upper - box.lower);
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0)
            distance = std::min(distance, half[axis] / std::abs(direction[axis]));
    return distance;
}

/// Mean and worst of value(view) over views.
template <class View, class Value>
Spread spread_of(const std::vector<View>& views, bool more_is_better, const Value& value) {
    if (views.empty()) return {};
    Spread result{0, value(views.front())};
    for (const View& view : views) {
        result.mean += value(view) / static_cast<double>(views.size());
        result.worst = more_is_better ? std::min(result.worst, value(view))
                                      : std::max(result.worst, value(view));
    }
    return result;
}

}  // namespace

std::vector<Conversion> paper_conversions() {
    const char* labels[] = {"dense 2³, smart grouping", "dense 4³, smart grouping",
                            "dense 8³, smart grouping", "dense 8³, strict blocks",
                            "dense 8³, one per leaf"};
    std::vector<Conversion> conversions;
    for (const Amplitude amplitude : {Amplitude::mean, Amplitude::mass}) {
        const std::string series = amplitude == Amplitude::mean ? "mean" : "mass";
        const auto with_lod = [amplitude](int lod) {
            return [amplitude, lod](const Volume& volume, std::size_t) {
                PaperOptions options = paper_lod(lod);
                options.amplitude = amplitude;
                return convert_paper(volume, options);
            };
        };
        for (int lod = 1; lod <= 5; ++lod)
            conversions.push_back(
                {series, fmt::format("lod{}", lod), labels[lod - 1], 0, with_lod(lod)});
        for (int sigma = 1; sigma <= 3; ++sigma)
            conversions.push_back(
                {series, fmt::format("sigma{}", sigma), labels[2], double(sigma), with_lod(3)});
    }
    return conversions;
}

std::vector<Conversion> moment_conversions() {
    std::vector<Conversion> conversions;
    /// options_of(budget)  options of convert_moments
    const auto add = [&](const char* series, const std::string& step, const std::string& label,
                         const auto& options_of) -> Conversion& {
        Conversion row{series, step, label, 0, {}};
        row.convert = [options_of](const Volume& volume, std::size_t budget) {
            return convert_moments(volume, options_of(budget));
        };
        row.moments = options_of;
        return conversions.emplace_back(std::move(row));
    };
    const int blocks[] = {2, 4, 8, 16};
    for (const int block : blocks)
        add("uniform", fmt::format("block{}", block), fmt::format("cells of {} voxels", block),
            [block](std::size_t) {
                MomentOptions options;
                options.block_voxels = block;
                options.soft_steps = 0;  // hard: the same for any number of vog-mpi's ranks
                return options;
            });
    const auto add_budget = [&](const std::string& step, const std::string& label,
                                const char* of_series) {
        Conversion& row = add("adaptive", step, label, [](std::size_t budget) {
            MomentOptions options;
            options.budget = std::max<std::size_t>(budget, 1);
            return options;
        });
        row.budget_series = of_series;
        row.budget_step = step;
    };
    for (const int block : blocks)
        add_budget(fmt::format("block{}", block), fmt::format("as many as cells of {}³", block),
                   "uniform");
    for (const char* step : {"lod1", "lod5"})
        add_budget(step, "as many as the paper's recipe", "mass");
    add("adaptive", "default",
        fmt::format("error at most {}, or 1/{} of the voxels", kDefaultError, kVoxelsPerGaussian),
        [](std::size_t) { return MomentOptions{}; });
    return conversions;
}

std::vector<Conversion> cell_conversions(std::size_t cells) {
    std::vector<Conversion> conversions;
    const auto add = [&](const std::string& step, const std::string& label, std::size_t budget) {
        Conversion& row = conversions.emplace_back(Conversion{"adaptive", step, label, 0, {}});
        row.moments = [budget](std::size_t) {
            MomentOptions options;
            options.budget = budget;
            return options;
        };
    };
    for (const std::size_t share : {4, 16, 64, 256})
        if (cells >= share)
            add(fmt::format("cells{}", share), fmt::format("one to {} cells", share),
                cells / share);
    add("default",
        fmt::format("error at most {}, or 1/{} of the cells", kDefaultError, kVoxelsPerGaussian),
        0);
    return conversions;
}

std::vector<Conversion> all_conversions() {
    std::vector<Conversion> all = paper_conversions();
    for (Conversion& conversion : moment_conversions()) all.push_back(std::move(conversion));
    return all;
}

Conversion model_row(const std::string& name, Gaussians model) {
    Conversion row{"model", name, model.method, 0, {}};
    row.model = std::make_shared<const Gaussians>(std::move(model));
    return row;
}

std::vector<EvaluationView> evaluation_views(const Box& box) {
    std::vector<EvaluationView> views;
    views.push_back({"paper", paper_view(box), 1, 0, {}});
    // Azimuths in steps of 60 degrees from the paper's; elevations from below to steeply above.
    const double elevations[] = {0, 40, -20, 70, -40};
    for (int n = 0; n < 5; ++n) {
        Orbit orbit;
        orbit.azimuth_degrees += (n + 1) * 60;
        orbit.elevation_degrees = elevations[n];
        orbit.distance_radii = kPaperDistanceRadii;
        views.push_back({fmt::format("around {}", n + 1), orbit_view(box, orbit), 1, 0, {}});
    }
    // Half way from the centre to the face of the box, on the paper's line of sight; wide, so that
    // density beside the eye is in view.
    constexpr double kInsideFovDegrees = 60;
    const Vec3d sight = normalized(views[0].camera.eye - box.center());
    Orbit inside;
    inside.distance_radii = 0.5 * distance_to_face(box, sight) / box.radius();
    inside.fov_degrees = kInsideFovDegrees;
    views.push_back({"inside", orbit_view(box, inside), 1, 0, {}});
    return views;
}

Spread spread(const EvaluationRow& row, double ViewResult::*figure, bool more_is_better) {
    return spread_of(row.views, more_is_better, [=](const ViewResult& v) { return v.*figure; });
}

Spread spread(const EvaluationRow& row, std::size_t field, double FieldResult::*figure) {
    return spread_of(row.views, false,
                     [=](const ViewResult& view) { return view.fields.at(field).*figure; });
}

Spread spread(const EvaluationRow& row, std::size_t function, double ValueResult::*figure) {
    return spread_of(row.values.at(function), true,
                     [=](const ValueResult& view) { return view.*figure; });
}

}  // namespace vog
