// memory_test.cpp: particles larger than the memory given.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "support/larger_than_memory.h"

namespace vog::test {

class larger_than_memory : public LargerThanMemory {};

// A million particles: 24 MB of positions, 12 of velocities, then what the conversion takes.
TEST_F(larger_than_memory, particles_make_the_same_model) {
    must("sample particles p.xyz --size 100");
    expect_same("p.xyz", "--radius 3 --budget 20000", 128);
    expect_same("p.xyz", "--radius 3 --block 2 --no-hierarchy", 128);
}

TEST_F(larger_than_memory, particles_in_no_order_make_the_same_model) {
    must("sample particles p.xyz --size 60");
    // Every 1009th line, round and round: neighbours in the file are far apart.
    const std::string text = read_text(dir_ / "p.xyz");
    std::vector<std::string_view> lines;
    for (std::size_t at = 0, end; (end = text.find('\n', at)) != text.npos; at = end + 1)
        lines.push_back(std::string_view(text).substr(at, end + 1 - at));
    std::string mixed(lines.front());
    for (std::size_t n = 1, at = 0; n < lines.size(); ++n) {
        at = (at + 1009) % (lines.size() - 1);
        mixed += lines[1 + at];
    }
    write("q.xyz", mixed);
    must("convert q.xyz -o free.ply --block 4");
    must("convert q.xyz -o bound.ply --block 4 --memory 64M --scratch .");
    EXPECT_EQ(read_text(dir_ / "bound.ply"), read_text(dir_ / "free.ply"));
}

}  // namespace vog::test
