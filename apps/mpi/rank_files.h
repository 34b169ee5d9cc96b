// rank_files.h: input files of the ranks: their assignment, whole or in parts, and the check that
// all ranks read the same.
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

/// Whether there are so many files that each goes whole to one rank, where the data allow it.
bool are_many(std::size_t files, const Ranks& ranks);
/// Part of each file that this rank reads; no value: none. Below four files a rank, every file is
/// divided among all ranks; from there on files go to ranks whole, so that no rank opens them all.
std::vector<std::optional<VolumePart>> shares_of(std::span<const std::string> files,
                                                 const Ranks& ranks);

/// Files that all ranks read in parts, under the same names. Nodes may mount other folders there:
/// parts of different files would make half a model. Copies of one file on every node are valid.
class SameFiles {
  public:
    /// Compares names, sizes and samples of the contents of all ranks' files; where their times
    /// differ, all of their contents.
    /// divided  false: each file is read by one rank alone; then names and sizes only
    /// throws   vog::Error, on every rank, that names the first file and rank to differ
    SameFiles(std::span<const std::string> files, const Ranks& ranks, bool divided = true);
    /// throws vog::Error if a file was replaced or written since. Called after reading.
    void check_unchanged() const;

  private:
    std::vector<std::string> files_, stamps_;
};

}  // namespace vog::mpi
