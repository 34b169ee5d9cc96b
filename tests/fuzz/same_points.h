// same_points.h: The way of particles through a file.
#pragma once

#include <string>

#include "vog/points.h"

namespace vog::fuzz {

/// Ends the process unless write_points and read_points give the particles again: text bit for bit,
/// a .vdb to the single precision of positions within a voxel.
void expect_round_trip(const Points& points, const std::string& extension);

}  // namespace vog::fuzz
