// vog/budget_search.h: search of a conversion for the smallest model whose measured error is low enough. Not in vog/vog.h:
// vog-mpi uses it, whose models are spread over processes.
#pragma once

#include <cstddef>
#include <functional>

#include "vog/distributed.h"

namespace vog {

/// Search of a conversion for an error: among budgets up to `few`, then, where none has it, up to `finest`.
struct ErrorSearch {
    double target = 0;
    std::size_t few = 0,  ///< default_count
        finest = 0;       ///< Gaussians of the finest cut
    bool beyond_few = true;
    double first = 0;  ///< guess of the count; 0: a hundredth of `few`
    /// Converts with a budget and measures.
    std::function<RelativeError(std::size_t budget)> error_of_budget;
    /// Keeps the model of the last call of error_of_budget, the best so far.
    std::function<void()> keep;
    /// Measures one Gaussian a voxel.
    std::function<RelativeError()> error_of_voxels;
};
/// The search for error_beyond_interpolation as convert_moments has it: it ends where one Gaussian a voxel would gain less
/// than an eighth.
/// interpolation  errors of the voxels interpolated linearly; where `few` miss the target, at least 9/8 of those of one
///                Gaussian a voxel
/// returns        error of the model kept last
RelativeError find_budget(const ErrorSearch& search, RelativeError& interpolation);

}  // namespace vog
