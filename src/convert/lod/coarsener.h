// coarsener.h: coarser models of one model, by one tree (vog/lod.h: coarsen).
#pragma once

#include <cstddef>
#include <memory>

#include "vog/gaussians.h"

namespace vog::lod {

class Coarsener {
  public:
    /// model       must outlive it
    /// fills_space  whether its Gaussians lie side by side, as cells of a mesh: coarser ones then share them (particles/soften.h)
    explicit Coarsener(const Gaussians& model, bool fills_space = false);
    ~Coarsener();
    /// The model with at most `budget` Gaussians, > 0; the tree is built for the first one below the model's size.
    Gaussians model(std::size_t budget);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog::lod
