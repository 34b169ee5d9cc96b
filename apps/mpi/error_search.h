// error_search.h: the error of a model of which every rank has a part, and the smallest model that
// has no more of it than asked.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "ranks.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::mpi {

/// Relative L2 of T of all parts against all voxels, over the views of MomentReport.
class WholeError {
  public:
    /// volumes  of this rank, which add up; box of the whole
    WholeError(std::span<const Volume> volumes, const Box& box, const Ranks& ranks);
    /// The same on every rank.
    double of(const std::vector<Gaussians>& models) const;

  private:
    const Ranks& ranks_;
    std::vector<Camera> cameras_;
    std::vector<DepthImage> references_;  ///< of the whole on the first rank
};

/// This rank's part of the smallest budget, to 5 %, whose error is at most `target`; of the largest
/// budget where none is. All ranks search together.
/// make  make(budget): this rank's part of a model of so many Gaussians in all
std::vector<Gaussians> smallest_models(
    double target, std::size_t largest, const WholeError& error,
    const std::function<std::vector<Gaussians>(std::size_t budget)>& make);

}  // namespace vog::mpi
