// larger_than_memory.h: conversions of data larger than the memory given: the same bytes, and the
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
    /// Converts both ways: without a limit more than 1.2 of it is taken, with it less than 0.8.
    void expect_same(const std::string& inputs, const std::string& options,
                     std::uint64_t megabytes) const {
        const double free = peak_of(inputs, "free.ply", options);
        const double bound =
            peak_of(inputs, "bound.ply",
                    options + " --memory " + std::to_string(megabytes) + "M --scratch .");
        EXPECT_EQ(read_text(dir_ / "bound.ply"), read_text(dir_ / "free.ply")) << options;
#ifdef __SANITIZE_ADDRESS__
        GTEST_SKIP() << "the address sanitizer's own memory counts too: not measured";
#endif
        const auto limit = static_cast<double>(megabytes << 20);
        EXPECT_GT(free, 1.2 * limit) << inputs << options;
        EXPECT_LT(bound, 0.8 * limit) << inputs << options;
    }

  private:
    double peak_of(const std::string& inputs, const std::string& output,
                   const std::string& options) const {
        const Result result =
            must("convert " + inputs + " --json --threads 2 -o " + output + " " + options);
        const auto report = nlohmann::json::parse(result.out, nullptr, false);
        return report.is_discarded() ? 0 : report.at("peak_memory").get<double>();
    }
};

}  // namespace vog::test
