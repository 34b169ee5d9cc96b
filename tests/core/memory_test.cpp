// memory_test.cpp: BigVectors in files, and commands on data larger than the memory limit.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "support/larger_than_memory.h"
#include "vog/error.h"
#include "vog/memory.h"

namespace vog::test {

TEST(memory_limit, arrays_in_files_keep_their_values) {
    const MemoryLimit limit(64 << 20);
    EXPECT_THROW(MemoryLimit(64 << 20), Error);  // one at a time
    BigVector<std::uint64_t> numbers;
    for (std::uint64_t n = 0; n < (32u << 20); ++n) numbers.push_back(n * n);  // 256 MB
    EXPECT_GE(limit.scratch_bytes(), sizeof(std::uint64_t) * numbers.size());
    for (std::uint64_t n = 0; n < numbers.size(); ++n) ASSERT_EQ(numbers[n], n * n);
}

TEST(memory_limit, arrays_outlive_it) {
    BigVector<int> numbers;
    {
        const MemoryLimit limit(64 << 20);
        numbers.assign(8u << 20, 7);
    }
    const BigVector<int> copy = numbers;  // in memory
    EXPECT_EQ(copy, numbers);
}

class larger_than_memory : public LargerThanMemory {};

// 17 million voxels: 84 MB of leaves, and 45 MB for an idle process.
TEST_F(larger_than_memory, a_volume_makes_the_same_model) {
    write_cube("cube.vdb", 32);
    expect_same("convert cube.vdb --block 4 --set soft-steps=0 -o", ".ply", 136);
    // Overlapping cells read the neighbours of each leaf; the model alone has 92 MB.
    expect_same("convert cube.vdb --block 2 --no-hierarchy --no-fields -o", ".ply", 160);
    write_cube("large.vdb", 28);
    expect_same("convert large.vdb --budget 3000 --set soft-steps=1 -o", ".ply", 112);
}

// Leaves and the tree for ray traversal: 234 MB.
TEST_F(larger_than_memory, a_volume_makes_the_same_picture) {
    write_cube("cube.vdb", 32);
    expect_same("render cube.vdb --size 64 --depth-out", ".exr", 168);
    must_fail(2, "render cube.vdb -o a.png --set scratch=.", "--memory");
}

// Two levels with 20 million voxels in all, the finer one in a corner of the coarser.
TEST_F(larger_than_memory, levels_make_the_same_model) {
    write_cube("coarse.vdb", 20, 2);
    write_cube("fine.vdb", 31, 1);
    expect_same("convert coarse.vdb fine.vdb --block 8 --set soft-steps=0 -o", ".ply", 192);
}

// A million particles: 24 MB of positions, 12 MB of velocities, and the conversion.
TEST_F(larger_than_memory, particles_make_the_same_model) {
    must("sample particles p.xyz --size 100");
    expect_same("convert p.xyz --radius 3 --budget 20000 -o", ".ply", 160);
    must("convert p.xyz -o p.vdb");
    expect_same("convert p.vdb --radius 3 --block 2 --no-hierarchy -o", ".ply", 160);
}

TEST_F(larger_than_memory, particles_in_no_order_make_the_same_model) {
    must("sample particles p.xyz --size 60");
    // Every 1009th line, cyclically: neighbours in the file are far apart in space.
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
    must("convert q.xyz -o bound.ply --block 4 --memory 64M --set scratch=.");
    EXPECT_EQ(read_text(dir_ / "bound.ply"), read_text(dir_ / "free.ply"));
}

}  // namespace vog::test
