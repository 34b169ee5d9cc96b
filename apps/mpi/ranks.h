// ranks.h: the processes that work together, and how they end together.
//
// A rank that throws must not leave the others waiting for it. So every exchange begins with an
// agreement: all ranks say whether they are well, and if one is not, all of them throw its message.
// A rank that has thrown elsewhere comes to its end in main(), which takes part in one last
// agreement, and meets the others there, whichever exchange they were about to begin. What is asked
// of code between exchanges is only that all ranks make the same exchanges in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/distributed.h"
#include "vog/image.h"
#include "vog/linear.h"

namespace vog::mpi {

/// Why a rank ended; code 0: it has not failed.
struct Failure {
    int exit_code = 0;
    std::string text;
};

/// Thrown on every rank once all know that one has failed.
struct Ended {
    Failure failure;
};

class Ranks {
  public:
    Ranks(int* argc, char*** argv);
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int rank() const { return rank_; }
    int count() const { return count_; }
    bool first() const { return rank_ == 0; }  ///< the one that reports and writes
    /// Cores for each rank of this machine, at least 1.
    int fair_threads() const { return fair_threads_; }

    /// Waits for all ranks. throws Ended, on all of them, if any has failed: with the failure of
    /// the first that has
    void agree(const Failure& mine = {}) const;

    // Exchanges. All throw Ended as agree() does.

    /// For the library's conversions.
    const Collective& collective() const { return collective_; }

    /// Sums over all ranks: the same bytes on each.
    void sum(std::span<double> values) const;
    void sum(std::span<std::uint64_t> values) const;
    std::uint64_t sum(std::uint64_t value) const;
    double least(double value) const;
    double largest(double value) const;
    void largest(std::span<double> values) const;  ///< each of them
    Box united(const Box& box) const;
    /// Of each rank its value, in the order of ranks.
    std::vector<std::uint64_t> gather(std::uint64_t value) const;
    std::vector<std::string> gather(const std::string& text) const;
    /// The first rank's text.
    std::string from_first(std::string text) const;
    /// Optical depths summed in double precision into the first rank's image; the others keep
    /// theirs. All have the same size.
    void sum_at_first(DepthImage& depth) const;

  private:
    int rank_ = 0, count_ = 1, fair_threads_ = 1;
    Collective collective_;
};

}  // namespace vog::mpi
