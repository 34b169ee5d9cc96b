// vog/coarsen.h: fewer Gaussians from more: levels of detail of a model whose volume is not at
// hand. Mass, first and second moments of Gaussians add up, after the cut of their kernels, so any
// group of them has one Gaussian that stands for it (docs/web.md, "Levels of detail").
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vog/gaussians.h"

namespace vog {

/// Coarser models of the same mass, mean and covariance. Neighbours are joined by a tree that
/// halves the model across its longest axis, and split again where that gains most.
/// budgets  the most Gaussians each result may have, > 0
/// returns  one model a budget, with the model's cutoff and box. A budget that the model meets gives
///          the model itself; with rotations otherwise. The same bytes for any number of threads
/// throws   vog::Error for a budget of 0 or an invalid model
/// cost     O(N log N) time, once for all budgets; 200 bytes a Gaussian
[[nodiscard]] std::vector<Gaussians> coarsen(const Gaussians& model,
                                             std::span<const std::size_t> budgets);
[[nodiscard]] Gaussians coarsen(const Gaussians& model, std::size_t budget);

/// What levels of detail below a model of this size may have: a quarter as many Gaussians each
/// time, down to about a thousand.
/// most  levels, the model included
[[nodiscard]] std::vector<std::size_t> detail_budgets(std::size_t size, std::size_t most = 8);
/// The model and, coarsened, those below it.
[[nodiscard]] std::vector<Gaussians> detail_levels(Gaussians model, std::size_t most = 8);

}  // namespace vog
