// splat_files.h: writers of splats, one a format.
#pragma once

#include <array>
#include <fstream>
#include <span>
#include <string>

#include "vog/exchange.h"

namespace vog::exchange {

/// Coefficients of the constant spherical harmonic of a colour.
Vec3f harmonics(Vec3f color);

/// throws  vog::Error naming `where` for positions beyond 24 bits of which 12 are fractions, which start at 1 for splats smaller
///         than theirs
void check_spz(const Splats& splats, const std::string& where);
/// frame  frame_text of the file
void write_spz(std::ofstream& out, const Splats& splats, const std::string& frame);
void write_glb(std::ofstream& out, const Splats& splats, const std::string& frame);
void write_usda(std::ofstream& out, const Splats& splats, const std::string& frame);

}  // namespace vog::exchange
