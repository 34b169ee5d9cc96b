// larger_than_memory.h: commands on data larger than the memory given: the same bytes, and the
// memory measured. What is given lies far from both figures, the free run's and the bound one's.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "support/command.h"

namespace vog::test {

class LargerThanMemory : public CommandLine {
  protected:
    void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
        GTEST_SKIP() << "the address sanitizer's own memory counts too: not measured";
#endif
    }

    /// Runs `command` and the name of an output, which ends as asked, with and without a limit.
    void expect_same(const std::string& command, const std::string& ending,
                     std::uint64_t megabytes) const {
        const std::string limit = std::to_string(megabytes);
        const auto free = peak_of(command + " free" + ending);
        const auto bound =
            peak_of(command + " bound" + ending + " --scratch . --memory " + limit + "M");
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
