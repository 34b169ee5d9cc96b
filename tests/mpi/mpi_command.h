// mpi_command.h: fixture that runs vog-mpi with several processes, also more than there are cores.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "support/command.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog::test {

/// Numbers of ranks that properties of any number are tried with: one, and one that divides nothing evenly; by night more.
inline std::vector<int> rank_counts() {
    return nightly() ? std::vector{1, 2, 3, 5, 8} : std::vector{1, 3};
}

/// Two leaves side by side: more ranks have nothing.
inline Volume two_leaves() {
    Volume volume;
    volume.name = "density";
    volume.leaves.resize(2);
    volume.leaves[1].origin = {8, 0, 0};
    for (int n = 0; n < kLeafVoxels; ++n)
        for (Leaf& leaf : volume.leaves) leaf.set(n, 1.0f + static_cast<float>(n % 7));
    return volume;
}

/// Command line tests of vog-mpi.
class Mpi : public CommandLine {
  protected:
    /// Runs mpirun. apps  its arguments: `-n 2 COMMAND a b : -n 1 COMMAND c`, where COMMAND stands
    /// for vog-mpi
    Result mpi(const std::string& apps) const {
        std::string all = apps;
        for (std::size_t at; (at = all.find("COMMAND")) != std::string::npos;)
            all.replace(at, 7, "'" VOG_MPI_COMMAND "'");
        // A deadlocked rank ends by the time limit, with exit code 124. Ranks that wait yield: Open
        // MPI lets two of them spin on two cores. After a failure mpirun sleeps for a second before
        // each of two signals; no rank ends before the first one has reported.
        const std::string command =
            "cd '" + (dir_ / "").string() + "' && " +
            "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
            "OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_odls_base_sigkill_timeout=0 "
            "timeout 120 " VOG_MPIRUN " --oversubscribe --bind-to none " +
            all + " >stdout.txt 2>stderr.txt </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(dir_ / "stdout.txt"),
                read_text(dir_ / "stderr.txt")};
    }
    Result must_mpi(int count, const std::string& arguments) const {
        const Result result = mpi(fmt::format("-n {} COMMAND {}", count, arguments));
        EXPECT_EQ(result.exit_code, 0) << count << " ranks: " << arguments << "\n" << result.error;
        return result;
    }
    /// Expects the exit code and exactly one line from vog-mpi on standard error, with `text`.
    void must_fail_mpi(int exit_code, const std::string& apps, const std::string& text) const {
        const Result result = mpi(apps);
        EXPECT_EQ(result.exit_code, exit_code) << apps << "\n" << result.error;
        EXPECT_NE(result.error.find(text), std::string::npos) << apps << "\n" << result.error;
        int lines = 0;
        std::istringstream in(result.error);
        for (std::string line; std::getline(in, line);) lines += line.starts_with("vog-mpi: ");
        EXPECT_EQ(lines, 1) << apps << "\n" << result.error;
        EXPECT_EQ(result.out, "") << apps;
    }

    /// Largest difference of two T, relative to the larger of both, over all pixels.
    double difference(const std::string& a, const std::string& b) const {
        const DepthImage one = read_depth(dir_ / a), other = read_depth(dir_ / b);
        EXPECT_EQ(one.depth.size(), other.depth.size());
        EXPECT_EQ(one.extinction, other.extinction);
        double largest = 0;
        for (std::size_t n = 0; n < one.depth.size(); ++n) {
            const double x = one.depth[n], y = other.depth[n];
            if (x != y) largest = std::max(largest, std::abs(x - y) / std::max(x, y));
        }
        return largest;
    }
};

/// Largest relative difference of T between any number of ranks and one process: single-precision
/// sums in another order.
inline constexpr double kSameT = 1e-6;

}  // namespace vog::test
