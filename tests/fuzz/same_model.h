// same_model.h: A model's way through a file.
#pragma once

#include "vog/lod.h"

namespace vog::fuzz {

/// Ends the process unless write_ply and read_ply give the model and its hierarchy again, the same
/// bytes. Texts lose what a comment line cannot hold.
void expect_round_trip(const Gaussians& model, const Hierarchy& hierarchy);

}  // namespace vog::fuzz
