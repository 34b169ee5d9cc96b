// larger_than_memory.h: fixture for commands under a memory limit: same output, measured peak
// memory. Limits are far from the peaks of both the unlimited and the limited run.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "support/command.h"
#include "vog/volume_io.h"

namespace vog::test {

/// Compares runs with and without --memory.
class LargerThanMemory : public CommandLine {
  protected:
    void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
        GTEST_SKIP() << "not measured: includes the address sanitizer's own memory";
#endif
    }

    /// Writes a cube of `edge`^3 leaves of active voxels, `scale` world units wide, from the origin on: a dozenth of
    /// the time that a sample of as many voxels takes.
    void write_cube(const std::string& name, int edge, double scale = 1) const {
        vog::Volume volume;
        volume.name = "density";
        volume.world_from_index = {{{Vec3d{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}},
                                   {scale / 2, scale / 2, scale / 2}};
        for (int n = 0; n < edge * edge * edge; ++n) {
            Leaf& leaf = volume.leaves.emplace_back();
            leaf.origin = {8 * (n / edge / edge), 8 * (n / edge % edge), 8 * (n % edge)};
            // Steps within leaves, and from leaf to leaf.
            for (int v = 0; v < kLeafVoxels; ++v)
                leaf.set(v, 0.01f * static_cast<float>(1 + v / 16 % 8 + n * 7 % 23));
        }
        write_vdb(dir_ / name, volume);
    }

    /// Runs `command` with an output name appended, with and without a limit, and compares the
    /// outputs.
    /// ending     of the output's name
    /// megabytes  limit, between the peaks of both runs
    void expect_same(const std::string& command, const std::string& ending,
                     std::uint64_t megabytes) const {
        const std::string limit = std::to_string(megabytes);
        const auto free = peak_of(command + " free" + ending);
        const auto bound =
            peak_of(command + " bound" + ending + " --set scratch=. --memory " + limit + "M");
        std::cout << command << ": peaks of " << (free >> 20) << " MB without a limit and "
                  << (bound >> 20) << " MB with " << megabytes << "\n";
        EXPECT_GT(free, megabytes << 20) << command;
        EXPECT_LT(bound, megabytes << 20) << command;
        EXPECT_EQ(read_text(dir_ / ("bound" + ending)), read_text(dir_ / ("free" + ending)))
            << command;
    }

  private:
    std::uint64_t peak_of(const std::string& command) const {
        const auto report =
            nlohmann::json::parse(must(command + " --json --threads 2").out, nullptr, false);
        return report.is_discarded() ? 0 : report.at("peak_memory").get<std::uint64_t>();
    }
};

}  // namespace vog::test
