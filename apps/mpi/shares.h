// shares.h: assignment of input files to ranks: whole, or one part of each file per rank.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ranks.h"
#include "vog/distributed.h"

namespace vog::mpi {

/// Files assigned to this rank where each goes whole to one rank: greedy by size, the largest
/// first, to the rank with the fewest bytes so far.
/// returns  one flag per file
std::vector<bool> whole_files_of(std::span<const std::string> files, const Ranks& ranks);

/// Part of each file that this rank reads; no value: none. Below four files a rank, every file is
/// divided among all ranks; from there on files go to ranks whole, so that no rank opens them all.
std::vector<std::optional<VolumePart>> shares_of(std::span<const std::string> files,
                                                 const Ranks& ranks);

}  // namespace vog::mpi
