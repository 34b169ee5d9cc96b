// sequence_test.cpp: vog convert of time steps, and of volumes larger than the memory given.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "vog/error.h"
#include "vog/memory.h"

namespace vog::test {

class sequence : public CommandLine {};

TEST_F(sequence, a_folder_gets_a_model_of_each_file_in_natural_order) {
    must("sample cloud frame_2.vdb --size 64");
    must("sample explosion frame_10.vdb --size 64");
    const auto json = nlohmann::json::parse(
        must("convert 'frame_*.vdb' -o models/ --block 4 --memory 256M --json").out);
    ASSERT_EQ(json["models"].size(), 2u);
    EXPECT_EQ(json["models"][0]["output"], "models/frame_2.ply");
    EXPECT_EQ(json["models"][1]["output"], "models/frame_10.ply");
    must("convert frame_10.vdb -o one.ply --block 4");
    EXPECT_EQ(read_text(dir_ / "models/frame_10.ply"), read_text(dir_ / "one.ply"));
}

TEST_F(sequence, what_is_there_already_stays) {
    must("sample cloud frame_1.vdb --size 64");
    must("sample cloud frame_2.vdb --size 64");
    must("convert frame_1.vdb -o models/ --block 8");
    const auto first = std::filesystem::last_write_time(dir_ / "models/frame_1.ply");
    const auto json =
        nlohmann::json::parse(must("convert 'frame_*.vdb' -o models --block 8 --json").out);
    EXPECT_EQ(json["there_already"], 1);
    EXPECT_EQ(json["models"].size(), 1u);
    EXPECT_EQ(std::filesystem::last_write_time(dir_ / "models/frame_1.ply"), first);
    EXPECT_EQ(nlohmann::json::parse(
                  must("convert 'frame_*.vdb' -o models --block 8 --json --again").out)["models"]
                  .size(),
              2u);
    // A frame that has changed since is made anew.
    must("sample explosion frame_1.vdb --size 64");
    std::filesystem::last_write_time(
        dir_ / "frame_1.vdb",
        std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
    EXPECT_EQ(
        nlohmann::json::parse(
            must("convert 'frame_*.vdb' -o models --block 8 --json").out)["models"][0]["output"],
        "models/frame_1.ply");
}

TEST_F(sequence, what_cannot_be_is_said_before_any_work) {
    must("sample cloud a.vdb --size 64");
    std::filesystem::create_directories(dir_ / "other");
    std::filesystem::copy(dir_ / "a.vdb", dir_ / "other/a.vdb");
    must_fail(1, "convert 'none_*.vdb' -o models/", "none_*.vdb: no such files");
    must_fail(1, "convert a.vdb other/a.vdb -o models/", "would be written for both");
    must_fail(2, "convert a.vdb -o a.ply --memory lots", "--memory lots");
    must_fail(1, "convert a.vdb -o a.ply --memory 1M", "at least 67108864");
    must_fail(1, "convert a.vdb -o a.ply --memory 1G --scratch nowhere", "nowhere");
    must_fail(2, "convert a.vdb -o a.ply --scratch other", "--memory");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a.ply"));
}

TEST_F(sequence, a_broken_frame_ends_it_with_its_own_line) {
    must("sample cloud frame_1.vdb --size 64");
    std::ofstream(dir_ / "frame_2.vdb") << "no volume";
    const Result result = run("convert 'frame_*.vdb' -o models/ --block 8");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.error.ends_with("frame_2.vdb: not a VDB file\n")) << result.error;
    EXPECT_TRUE(std::filesystem::exists(dir_ / "models/frame_1.ply"));
}

TEST_F(sequence, pictures_of_time_steps_share_camera_and_extinction) {
    must("sample cloud step_2.vdb --size 64");
    must("sample explosion step_10.vdb --size 64");
    must("convert 'step_*.vdb' -o models/ --block 4");
    for (const std::string inputs : {"'models/*.ply'", "'step_*.vdb'"}) {
        const auto json = nlohmann::json::parse(
            must("render " + inputs + " -o pictures/ --depth-out depths/ --size 32 --json").out);
        ASSERT_EQ(json["pictures"].size(), 2u);
        EXPECT_EQ(json["pictures"][0]["output"], "pictures/step_2.png");
        EXPECT_EQ(json["pictures"][1]["output"], "pictures/step_10.png");
        EXPECT_EQ(json["pictures"][0]["extinction"], json["pictures"][1]["extinction"]);
        EXPECT_TRUE(std::filesystem::exists(dir_ / "depths/step_10.exr"));
    }
    must_fail(2, "render 'models/*.ply' -o pictures/ --depth-out one.exr", "--depth-out");
}

// 16.6 million voxels: 84 MB of leaves, and 45 MB for a process that does next to nothing.
TEST_F(sequence, a_volume_larger_than_the_memory_given_makes_the_same_model) {
    must("sample cloud cloud.vdb --size 512");
    const auto peak_of = [&](const std::string& output, const std::string& options) {
        return nlohmann::json::parse(
                   must("convert cloud.vdb --json --threads 2 -o " + output + options).out)
            .at("peak_memory")
            .get<std::uint64_t>();
    };
    struct Case {
        std::string cut, memory;
        std::uint64_t megabytes;
    };
    for (const Case& c : {Case{" --block 4", " --memory 128M", 128},
                          Case{" --budget 3000", " --memory 160M", 160}}) {
        EXPECT_GT(peak_of("free.ply", c.cut), c.megabytes << 20) << c.cut;
        EXPECT_LT(peak_of("bound.ply", c.cut + c.memory + " --scratch ."), c.megabytes << 20)
            << c.cut;
        EXPECT_EQ(read_text(dir_ / "bound.ply"), read_text(dir_ / "free.ply")) << c.cut;
    }
}

// Leaves and the tree that rays walk through: 234 MB in memory, 121 MB with 168 MB given.
TEST_F(sequence, a_volume_larger_than_the_memory_given_makes_the_same_picture) {
    must("sample cloud cloud.vdb --size 512");
    const auto peak_of = [&](const std::string& output, const std::string& options) {
        return nlohmann::json::parse(must("render cloud.vdb --json --size 64 --threads 2 "
                                          "--depth-out " +
                                          output + options)
                                         .out)
            .at("peak_memory")
            .get<std::uint64_t>();
    };
    EXPECT_GT(peak_of("free.exr", ""), 160u << 20);
    EXPECT_LT(peak_of("bound.exr", " --memory 160M --scratch ."), 160u << 20);
    EXPECT_EQ(read_text(dir_ / "bound.exr"), read_text(dir_ / "free.exr"));
    must_fail(2, "render cloud.vdb -o a.png --scratch .", "--memory");
}

TEST(memory_limit, arrays_in_files_hold_what_is_put_into_them) {
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

}  // namespace vog::test
