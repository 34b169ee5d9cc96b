// memory_test.cpp: conversions whose data are larger than the memory given: the same bytes, and the
// memory measured. What is asked for lies far from both figures, the free run's and the bound
// one's.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "vog/memory.h"

namespace vog::test {

class larger_than_memory : public CommandLine {
  protected:
    /// Converts both ways: more than 1.2 of the limit is wanted without one, and less than 0.8 of
    /// it with it.
    void expect_same(const std::string& inputs, const std::string& options,
                     std::uint64_t megabytes) const {
        const auto limit = static_cast<double>(megabytes << 20);
        EXPECT_GT(peak_of(inputs, "free.ply", options), 1.2 * limit) << options;
        const std::string bound = limit_text(megabytes);
        EXPECT_LT(peak_of(inputs, "bound.ply", options + bound), 0.8 * limit) << options;
        EXPECT_EQ(read_text(dir_ / "bound.ply"), read_text(dir_ / "free.ply")) << options;
    }

  private:
    static std::string limit_text(std::uint64_t megabytes) {
        return " --memory " + std::to_string(megabytes) + "M --scratch .";
    }
    double peak_of(const std::string& inputs, const std::string& output,
                   const std::string& options) const {
        const Result result =
            must("convert " + inputs + " --json --threads 2 -o " + output + " " + options);
        return nlohmann::json::parse(result.out).at("peak_memory").get<double>();
    }
};

// A million particles: 24 MB of positions, 12 of velocities, then what the conversion takes.
TEST_F(larger_than_memory, particles_make_the_same_model) {
    must("sample particles p.xyz --size 100");
    expect_same("p.xyz", "--radius 3 --budget 20000", 128);
    expect_same("p.xyz", "--radius 3 --block 2 --no-hierarchy", 128);
}

}  // namespace vog::test
