// camera_file_test.cpp: cameras as JSON: exact round trip, refused files.
#include <gtest/gtest.h>

#include <fstream>

#include "support/refused_files.h"
#include "vog/camera.h"
#include "vog/error.h"

namespace vog::test {

TEST(camera_file, round_trip_is_exact) {
    const TempDir dir;
    const Camera camera = paper_view({{0.1, 0.2, 0.3}, {1.7, 2.9, 3.1}});
    write_camera(dir / "camera.json", camera);
    const Camera back = read_camera(dir / "camera.json");
    EXPECT_EQ(back.eye, camera.eye);
    EXPECT_EQ(back.look_at, camera.look_at);
    EXPECT_EQ(back.up, camera.up);
    EXPECT_EQ(back.fov_degrees, camera.fov_degrees);
}

TEST(camera_file, an_orthographic_camera_keeps_its_width) {
    const TempDir dir;
    Camera camera = paper_view({{0.1, 0.2, 0.3}, {1.7, 2.9, 3.1}});
    camera.orthographic_width = 0.1 + 0.2;
    write_camera(dir / "camera.json", camera);
    EXPECT_EQ(read_camera(dir / "camera.json").orthographic_width, camera.orthographic_width);
}

TEST(camera_file, bad_files_are_refused_by_name_and_reason) {
    const TempDir dir;
    const auto read = [&](const std::string& text) {
        std::ofstream(dir / "c.json") << text;
        return error_of([&] { read_camera(dir / "c.json"); });
    };
    EXPECT_NE(read("{").find("c.json: not a camera file"), std::string::npos);
    EXPECT_NE(read("[1]").find("expected a JSON object"), std::string::npos);
    EXPECT_NE(read(R"({"eye":[0,0,1]})").find("no key 'look_at'"), std::string::npos);
    EXPECT_NE(read(R"({"eye":[0,0],"look_at":[0,0,0]})").find("'eye'"), std::string::npos);
    EXPECT_NE(read(R"({"eye":[0,0,"x"],"look_at":[0,0,0]})").find("not a camera file"),
              std::string::npos);
    EXPECT_NE(read(R"({"eye":[0,0,1],"look_at":[0,0,0],"zoom":2})").find("unknown key 'zoom'"),
              std::string::npos);
    EXPECT_NE(read(R"({"eye":[0,0,1],"look_at":[0,0,0],"orthographic_width":0})")
                  .find("'orthographic_width' is 0, expected above 0"),
              std::string::npos);
    EXPECT_NE(error_of([&] { read_camera(dir / "absent.json"); }).find("no such file"),
              std::string::npos);
}

}  // namespace vog::test
