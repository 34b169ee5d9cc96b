// paper_figures.h: what the paper's tables say of the data they name, to stand beside ours.
#pragma once

#include <string>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// How the paper's figures were made, as far as it tells.
inline constexpr const char* kPaperHardware =
    "made on a GeForce RTX 4090 Laptop GPU with a Core i9-14900HX; the paper does not state view, "
    "exposure, transfer function or resolution";

/// One column of the paper's tables 1 to 4.
struct PaperFigures {
    const char* step;
    double psnr_db, frames_per_second;
    const char* gaussians;       ///< as printed
    const char* bounding_share;  ///< of bounding-box voxels, as printed; table 4 only
};

/// The paper's figures for a step of its own recipe, or null: of other data, or not in its tables.
const PaperFigures* paper_figures(const Evaluation& evaluation, const std::string& step);

}  // namespace vog::evaluation
