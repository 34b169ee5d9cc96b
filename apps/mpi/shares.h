// shares.h: who reads what of the inputs.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ranks.h"
#include "vog/distributed.h"

namespace vog::mpi {

/// Which files are this rank's, if each goes whole to one rank: the largest first, to the rank that
/// has least to read.
std::vector<bool> whole_files_of(std::span<const std::string> files, const Ranks& ranks);

/// What this rank reads of each file; nothing of those without a value. Few files are shared by all
/// ranks, each a part; many go to ranks whole, so that nobody opens them all.
std::vector<std::optional<VolumePart>> shares_of(std::span<const std::string> files,
                                                 const Ranks& ranks);

}  // namespace vog::mpi
