// sequence_test.cpp: time series, converted and rendered file by file.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command.h"

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

TEST_F(sequence, models_newer_than_their_input_are_kept) {
    must("sample cloud frame_1.vdb --size 64");
    must("sample cloud frame_2.vdb --size 64");
    must("convert frame_1.vdb -o models/ --block 8");
    // File times are set, so that neither the clock nor its resolution on disk matters.
    const auto first = std::filesystem::last_write_time(dir_ / "models/frame_1.ply");
    std::filesystem::last_write_time(dir_ / "frame_1.vdb", first - std::chrono::hours(1));
    const auto json =
        nlohmann::json::parse(must("convert 'frame_*.vdb' -o models --block 8 --json").out);
    EXPECT_EQ(json["there_already"], 1);
    EXPECT_EQ(json["models"].size(), 1u);
    EXPECT_EQ(std::filesystem::last_write_time(dir_ / "models/frame_1.ply"), first);
    EXPECT_EQ(nlohmann::json::parse(
                  must("convert 'frame_*.vdb' -o models --block 8 --json --again").out)["models"]
                  .size(),
              2u);
    // A frame that has changed since is converted again.
    must("sample explosion frame_1.vdb --size 64");
    const auto model = std::filesystem::last_write_time(dir_ / "models/frame_1.ply");
    std::filesystem::last_write_time(dir_ / "frame_1.vdb", model + std::chrono::hours(1));
    EXPECT_EQ(
        nlohmann::json::parse(
            must("convert 'frame_*.vdb' -o models --block 8 --json").out)["models"][0]["output"],
        "models/frame_1.ply");
}

TEST_F(sequence, invalid_requests_fail_before_any_work) {
    must("sample cloud a.vdb --size 64");
    std::filesystem::create_directories(dir_ / "other");
    std::filesystem::copy(dir_ / "a.vdb", dir_ / "other/a.vdb");
    must_fail(1, "convert 'none_*.vdb' -o models/", "none_*.vdb: no such files");
    must_fail(1, "convert a.vdb other/a.vdb -o models/", "would be written for both");
    must_fail(2, "convert a.vdb -o a.ply --memory lots", "--memory lots");
    must_fail(1, "convert a.vdb -o a.ply --memory 1M", "at least 67108864");
    must_fail(1, "convert a.vdb -o a.ply --memory 1G --set scratch=nowhere", "nowhere");
    must_fail(2, "convert a.vdb -o a.ply --set scratch=other", "--memory");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a.ply"));
}

TEST_F(sequence, a_broken_frame_ends_the_sequence_with_its_error) {
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

}  // namespace vog::test
