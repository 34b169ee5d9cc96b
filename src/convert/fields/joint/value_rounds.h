// value_rounds.h: refinement of a fitted model where its pictures by value err.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "compare/values/value_views.h"
#include "vog/gaussians.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// Data that a model is fitted to.
struct FittedData {
    std::span<const Volume> levels;
    std::span<const std::vector<VoxelField>> fields;  ///< [fields][levels]
    std::size_t field = 0;          ///< place of the one that Gaussians are fitted to, a scalar
    std::optional<Box> periodic{};  ///< MomentOptions::periodic
};

/// Rounds of split-and-merge in the joint space of position and value, each followed by steps of
/// expectation-maximisation there. A round is kept if the mean error by value falls; the number of Gaussians does not
/// grow.
/// model  with all fields
/// most   error by value in the worst view that a round must not exceed, unless it was exceeded before; 0: none
/// go_on  evaluated before each round; false ends the refinement
void refine_by_value(Gaussians& model, const FittedData& data, const comparison::ValueViews& views,
                     double most, const std::function<bool()>& go_on);

}  // namespace vog::joint
