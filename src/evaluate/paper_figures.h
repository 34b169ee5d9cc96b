// paper_figures.h: figures published in the paper's tables, for comparison.
#pragma once

#include <string>

#include "vog/evaluate.h"

namespace vog::evaluation {

/// Conditions of the paper's figures, as far as they are published.
inline constexpr const char* kPaperHardware =
    "made on a GeForce RTX 4090 Laptop GPU with a Core i9-14900HX; the paper does not state view, "
    "exposure, transfer function or resolution";

/// The paper's figures for one of its steps.
struct PaperFigures {
    const char* step;
    double psnr_db, frames_per_second;
    const char* gaussians;  ///< as printed
    const char*
        bounding_share;  ///< fraction of the bounding box's voxels, as printed; table 4 only
};

/// The paper's figures for a step; null for other data and for steps that its tables lack.
const PaperFigures* paper_figures(const Evaluation& evaluation, const std::string& step);

}  // namespace vog::evaluation
