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

TEST(read_surface, has_the_area_of_any_polygon) {
    const TempDir folder;
    const std::string points =
        "v 0 0 1\nv 1 0 1\nv 1 0.3 1\nv 0.3 0.3 1\nv 0.3 1 1\nv 0 1 1\n";  // an L
    for (const char* face : {"f 1 2 3 4 5 6", "f 2 3 4 5 6 1", "f 5 6 1 2 3 4", "f 6 5 4 3 2 1",
                             "f 1 2 3 \\\n  4 5 6", "f -6 -5 -4 -3 -2 -1"}) {
        std::ofstream(folder / "l.obj") << points << face << '\n';
        double area = 0;
        for (const auto& [a, b, c] : corners_of(read_surface(folder / "l.obj")))
            area += 0.5 * length(cross(b - a, c - a));
        EXPECT_NEAR(area, 0.51, 1e-12) << face;
    }
    for (const auto& [face, message] : {std::pair{"f 1 2 7", "a face of point 7, expected 1 to 6"},
                                        {"f 0 1 2", "a face of point 0, expected 1 to 6"},
                                        {"f a b c", "'a', expected a number"}}) {
        std::ofstream(folder / "l.obj") << points << face << '\n';
        EXPECT_NE(refusal([&] { (void)read_surface(folder / "l.obj"); }).find(message),
                  std::string::npos)
            << face;
    }
}

TEST(read_surface, takes_stl_as_programs_write_it) {
    const TempDir folder;
    write_surface(folder / "a.stl", tetrahedron());
    std::ofstream(folder / "a.stl", std::ios::binary | std::ios::app) << "     ";
    EXPECT_EQ(read_surface(folder / "a.stl").triangle.size(), 4u);
    std::ofstream(folder / "b.stl")
        << "SOLID B\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\n"
           "VERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID B\n";
    EXPECT_EQ(read_surface(folder / "b.stl").triangle.size(), 1u);
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

TEST(read_surface, turns_left_and_posterior_axes_as_scans) {
    const TempDir folder;
    std::ofstream(folder / "s.obj")
        << "# 3D Slicer output. SPACE=LPS\nv 1 2 3\nv 2 2 3\nv 1 4 3\nf 1 2 3\n";
    std::vector<std::string> notes;
    const Surface surface = read_surface(folder / "s.obj", &notes);
    EXPECT_EQ(surface.point.at(0), (Vec3d{-1, -2, 3}));
    EXPECT_EQ(surface.triangle.at(0), (std::array<std::uint32_t, 3>{0, 1, 2}))
        << "a turn, not a mirror";
    EXPECT_EQ(notes.size(), 1u);
    EXPECT_TRUE(surface.is_ras);
}

TEST(read_surface, states_the_axes_of_scans_as_3d_slicer_does) {
    const TempDir folder;
    for (const bool is_ras : {true, false})
        for (const auto& [name, text] : {std::pair{"s.stl", "SPACE=RAS"},
                                         {"s.ply", "\ncomment SPACE=RAS\n"},
                                         {"s.obj", "# SPACE=RAS\n"}}) {
            Surface surface = tetrahedron();
            surface.is_ras = is_ras;
            write_surface(folder / name, surface);
            std::ifstream in(folder / name, std::ios::binary);
            const std::string bytes{std::istreambuf_iterator<char>(in), {}};
            EXPECT_EQ(bytes.find(text) != std::string::npos, is_ras) << name;
            std::vector<std::string> notes;
            const Surface read = read_surface(folder / name, &notes);
            EXPECT_EQ(read.is_ras, is_ras) << name;
            EXPECT_EQ(read.point.size(), 4u) << name;
            EXPECT_TRUE(notes.empty()) << name;
        }
}

TEST(read_surface, refuses_other_files_in_one_line) {
    const TempDir folder;
    const auto refused = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name) << text;
        return refusal([&] { (void)read_surface(folder / name); });
    };
    EXPECT_NE(refused("e.obj", "v 0 0 0\nv 1 0 0\n").find("e.obj: "), std::string::npos);
    EXPECT_NE(
        refused("e.stl", "").find("no text of STL, and no binary file of 0 triangles: 0 bytes"),
        std::string::npos);
    EXPECT_NE(refused("p.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
                  .find("expected triangles, .stl, .obj or .ply with faces"),
              std::string::npos);
    EXPECT_NE(refused("q.ply",
                      "ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\n"
                      "property list uchar int vertex_indices\nend_header\n")
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
