// value_rounds.cpp: rounds of splits, merges and joint steps, kept or undone.
#include "convert/fields/joint/value_rounds.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "convert/fields/joint/joint_cells.h"
#include "convert/fields/joint/joint_steps.h"

namespace vog::joint {

namespace {

/// A model, and the errors of its pictures.
struct Judged {
    Gaussians model;
    comparison::ValueErrors errors;
};

/// The model after a round; its fields are those of the data.
Gaussians round_of(const Judged& best, const FittedData& data, const Layout& layout,
                   const comparison::ValueViews& views, double share, SplitAlong along) {
    constexpr int kSteps = 3;  // 2 and 8 end within 2 % of the same error
    const Gaussians& model = best.model;
    const Layout::Part& part = layout.parts[layout.first_part[data.field]];
    JointCells cells(model, *model.fields.find_scalar(data.fields[data.field].front().name), part);
    cells.split_and_merge(views.error_of_each_gaussian(model, best.errors), share, along);
    Gaussians tried = cells.to_gaussians(model);
    const std::vector<ValueDistribution> start = cells.distributions();
    FieldEntries entries(data.fields, layout, tried.size());
    add_by_joint_steps(tried, data.levels, data.fields, layout,
                       {data.field, kSteps, start, data.periodic}, {}, entries);
    std::move(entries).move_to(tried);
    remove_empty(tried);
    return tried;
}

}  // namespace

void refine_by_value(Gaussians& model, const FittedData& data, const comparison::ValueViews& views,
                     double most, const std::function<bool()>& go_on) {
    // Splits along the gradient follow surfaces of equal value, those across the longest axis the rest. The share of cells
    // that a round splits is halved whenever neither helped, down to a hundredth.
    constexpr double kShare = 0.1, kLeastShare = 0.01;
    const Layout layout(data.fields);
    comparison::ValueErrors before = views.errors(model);
    const double limit = most > 0 ? std::max(most, before.relative_l2.worst)
                                  : std::numeric_limits<double>::infinity();
    Judged best{std::move(model), std::move(before)};
    double share = kShare;
    SplitAlong along = SplitAlong::gradient;
    bool other_failed = false;
    while (share >= kLeastShare && go_on()) {
        Judged tried{round_of(best, data, layout, views, share, along), {}};
        tried.errors = views.errors(tried.model);
        if (tried.errors.relative_l2.mean < best.errors.relative_l2.mean &&
            tried.errors.relative_l2.worst <= limit) {
            best = std::move(tried);
            other_failed = false;
            continue;
        }
        along = along == SplitAlong::gradient ? SplitAlong::longest_axis : SplitAlong::gradient;
        if (other_failed) share *= 0.5;
        other_failed = !other_failed;
    }
    model = std::move(best.model);
}

}  // namespace vog::joint
