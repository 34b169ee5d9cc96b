// ranks.h: MPI ranks: collective operations that propagate the failure of one rank to all.
//
// A rank that throws must not leave the others blocked in a collective call. Every operation here
// therefore begins with agree(): the ranks exchange their exit codes, and if one has failed, all
// throw its message. A rank that throws elsewhere unwinds to main(), whose last call is agree()
// too, and so meets the others there, whichever operation they were about to begin. The one
// condition for callers: all ranks make the same operations in the same order.
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

/// Exit code and message of a rank that failed; code 0: no failure.
struct Failure {
    int exit_code = 0;
    std::string text;
};

/// Exception thrown on every rank after one has failed.
struct Ended {
    Failure failure;
};

/// All processes of MPI_COMM_WORLD. Initialises MPI, and finalises it at its end.
class Ranks {
  public:
    Ranks(int* argc, char*** argv);
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int rank() const { return rank_; }
    int count() const { return count_; }
    bool first() const { return rank_ == 0; }  ///< the root: reports and writes
    /// Cores of this machine divided by the ranks on it, at least 1.
    int threads_per_rank() const { return threads_per_rank_; }

    /// Barrier that exchanges failures. throws Ended, on every rank, if any has failed: with the
    /// failure of the lowest such rank
    void agree(const Failure& mine = {}) const;

    // Collective operations. All throw Ended as agree() does.

    /// The operations of the library's conversions and pictures.
    const Collective& collective() const { return collective_; }

    /// Element-wise sums over all ranks: the same bytes on each.
    void sum(std::span<double> values) const;
    void sum(std::span<std::uint64_t> values) const;
    std::uint64_t sum(std::uint64_t value) const;
    double min(double value) const;
    double max(double value) const;
    void max(std::span<double> values) const;  ///< element-wise
    Box box_union(const Box& box) const;       ///< bounding box of all ranks' boxes
    /// One value per rank, in the order of ranks, on every rank.
    std::vector<std::uint64_t> gather(std::uint64_t value) const;
    std::vector<std::string> gather(const std::string& text) const;
    /// All-to-all: sends to[n] to rank n.
    /// returns  [ranks] received from each
    std::vector<std::vector<float>> exchange(const std::vector<std::vector<float>>& to) const;
    std::vector<std::string> exchange(const std::vector<std::string>& to) const;
    /// Broadcast: the root's text on every rank.
    std::string from_root(std::string text) const;
    /// Sums T of all ranks' images, which have one size, into the root's, in double precision; the
    /// other ranks keep theirs.
    void sum_at_first(DepthImage& depth) const;

  private:
    template <class List>
    std::vector<List> exchanged(const std::vector<List>& to) const;

    int rank_ = 0, count_ = 1, threads_per_rank_ = 1;
    Collective collective_;
};

}  // namespace vog::mpi
