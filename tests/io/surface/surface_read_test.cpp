// surface_read_test.cpp: triangles of files as they were written, and files that are none.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "support/data.h"
#include "support/refusal.h"
#include "vog/error.h"
#include "vog/surface.h"

namespace vog::test {

namespace {

Surface tetrahedron() {
    Surface surface;
    surface.point = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 0.5}};
    surface.triangle = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return surface;
}

/// Corners of triangles, by place.
std::vector<std::array<Vec3d, 3>> corners_of(const Surface& surface) {
    std::vector<std::array<Vec3d, 3>> all;
    for (const auto& [a, b, c] : surface.triangle)
        all.push_back({surface.point[a], surface.point[b], surface.point[c]});
    return all;
}

}  // namespace

TEST(read_surface, has_the_triangles_that_were_written) {
    const TempDir folder;
    for (const char* name : {"a.stl", "a.ply", "a.obj"}) {
        const auto file = folder / name;
        write_surface(file, tetrahedron());
        EXPECT_TRUE(is_surface_file(file));
        const Surface read = read_surface(file);
        EXPECT_EQ(read.point.size(), 4u) << name;
        EXPECT_EQ(corners_of(read), corners_of(tetrahedron())) << name;
        EXPECT_TRUE(read.color.empty());
    }
}

TEST(read_surface, has_colours_of_points_and_triangles_of_polygons) {
    const TempDir folder;
    std::ofstream(folder / "c.ply")
        << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
           "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face "
           "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n"
           "1 1 0 0 0 255\n0 1 0 51 51 51\n4 0 1 2 3\n";
    const Surface read = read_surface(folder / "c.ply");
    EXPECT_EQ(read.triangle.size(), 2u);
    ASSERT_EQ(read.color.size(), 4u);
    for (std::size_t n = 0; n < 4; ++n)
        if (read.point[n] == Vec3d{0, 1, 0}) {
            EXPECT_EQ(read.color[n], (std::array{0.2f, 0.2f, 0.2f}));
        }
}

TEST(read_surface, leaves_out_triangles_that_are_none_and_says_so) {
    const TempDir folder;
    Surface surface = tetrahedron();
    surface.point.push_back({0, std::nan(""), 0});
    surface.triangle.push_back({0, 1, 4});
    surface.triangle.push_back({0, 1, 1});
    write_surface(folder / "n.stl", surface);
    std::vector<std::string> notes;
    EXPECT_EQ(read_surface(folder / "n.stl", &notes).triangle.size(), 4u);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("2 of 6 triangles left out"), std::string::npos);
}

TEST(read_surface, refuses_other_files_in_one_line) {
    const TempDir folder;
    const auto refused = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name) << text;
        return refusal([&] { (void)read_surface(folder / name); });
    };
    EXPECT_NE(refused("e.obj", "v 0 0 0\nv 1 0 0\n").find("e.obj: "), std::string::npos);
    EXPECT_NE(refused("e.stl", "").find("0 bytes are no STL file"), std::string::npos);
    EXPECT_NE(refused("p.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
                  .find("expected triangles, .stl, .obj or .ply with faces"),
              std::string::npos);
    EXPECT_NE(refusal([&] { (void)read_surface(folder / "absent.stl"); }).find("no such file"),
              std::string::npos);
}

TEST(read_surface, survives_every_truncation) {
    const TempDir folder;
    for (const std::string name : {"a.stl", "a.ply", "a.obj"}) {
        write_surface(folder / name, tetrahedron());
        std::ifstream in(folder / name, std::ios::binary);
        const std::string whole{std::istreambuf_iterator<char>(in), {}};
        for (std::size_t size = 0; size < whole.size(); ++size) {
            std::ofstream(folder / ("cut_" + name), std::ios::binary) << whole.substr(0, size);
            try {
                EXPECT_LE(read_surface(folder / ("cut_" + name)).triangle.size(), 4u);
            } catch (const Error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            }
        }
    }
}

}  // namespace vog::test
