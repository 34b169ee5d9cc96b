// isosurface_test.cpp: surfaces of volumes are closed, lie where the value is, and are read back from their files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/dense.h"
#include "vog/surface.h"

namespace vog::test {

namespace {

/// Values [edge^3], z fastest.
Volume cube_of(const std::vector<float>& values, int edge, const Affine& map) {
    const DenseBlock block{.value = values.data(),
                           .size = {edge, edge, edge},
                           .stride = {edge * edge, edge, 1},
                           .first = {}};
    return volume_from_dense({&block, 1}, map);
}

/// Values 10 - r around a point, in voxels of 0.5 x 0.5 x 0.25 behind a rotation; zero beyond r = 10.
Volume cone(double mirrored = 1) {
    const int edge = 48;
    std::vector<float> values;
    const Affine map{{{Vec3d{0.3 * mirrored, 0.4, 0}, {-0.4 * mirrored, 0.3, 0}, {0, 0, 0.25}}},
                     {100, -20, 3}};
    const Vec3d centre = map({24, 24, 24});
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
            for (int z = 0; z < edge; ++z)
                values.push_back(static_cast<float>(
                    std::max(10 - length(map({double(x), double(y), double(z)}) - centre), 0.0)));
    return cube_of(values, edge, map);
}

double enclosed(const Surface& s) {
    double six = 0;
    for (const auto& t : s.triangle) {
        const Vec3d a = s.point[t[0]] - s.point[0];
        six += dot(a, cross(s.point[t[1]] - s.point[0], s.point[t[2]] - s.point[0]));
    }
    return six / 6;
}

}  // namespace

TEST(isosurface, of_a_cone_is_a_closed_sphere) {
    for (const double mirrored : {1.0, -1.0}) {
        const Volume volume = cone(mirrored);
        const Surface sphere = isosurface(volume, 7);
        const Vec3d centre = volume.world_from_index({24, 24, 24});
        for (const Vec3d& point : sphere.point) EXPECT_NEAR(length(point - centre), 3, 0.05);
        // Outwards, of a sphere's volume; chords lie within it.
        EXPECT_NEAR(enclosed(sphere) / (4 / 3.0 * M_PI * 27), 1, 0.03);
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (const auto& t : sphere.triangle)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = t[k], b = t[(k + 1) % 3];
                edges[std::minmax(a, b)] += a < b ? 1 : -1;
            }
        for (const auto& [edge, sum] : edges) EXPECT_EQ(sum, 0);
    }
}

TEST(isosurface, closes_at_the_edge_of_the_data_and_above_a_background) {
    Volume volume = cube_of(std::vector<float>(4 * 4 * 4, 2.0f), 4, {});
    const double whole = enclosed(isosurface(volume, 1));
    EXPECT_NEAR(whole, 64, 12);  // half a voxel around the outer centres, without edges and corners
    volume.background = -1000;
    EXPECT_NEAR(enclosed(isosurface(volume, -999)), whole, 1e-4);
    EXPECT_FALSE(isosurface(volume, -999).is_ras);
    volume.standing = {{0, 0, 1}, {0, 1, 0}};
    EXPECT_TRUE(isosurface(volume, -999).is_ras);
}

TEST(isosurface, is_refused_where_there_is_none) {
    EXPECT_NE(refusal([] { (void)isosurface(cone(), 11); }).find("no voxel is above 11"),
              std::string::npos);
    EXPECT_NE(refusal([] { (void)isosurface(cone(), 0); }).find("above 0"), std::string::npos);
    EXPECT_NE(refusal([] { (void)isosurface(cone(), std::nan("")); }).find("value nan"),
              std::string::npos);
    EXPECT_NE(refusal([] { write_surface("a.off", {}); }).find("expected .stl, .ply or .obj"),
              std::string::npos);
}

TEST(isosurface, files_hold_its_triangles) {
    const Surface sphere = isosurface(cone(), 7);
    const std::filesystem::path folder = testing::TempDir();
    const auto text_of = [&](const char* name) {
        write_surface(folder / name, sphere);
        std::ifstream file(folder / name, std::ios::binary);
        return (std::stringstream() << file.rdbuf()).str();
    };
    const std::string stl = text_of("s.stl"), ply = text_of("s.ply"), obj = text_of("s.obj");
    EXPECT_EQ(stl.size(), 84 + 50 * sphere.triangle.size());
    const std::string head = "element vertex " + std::to_string(sphere.point.size()) + "\n";
    EXPECT_NE(ply.find(head), std::string::npos);
    EXPECT_EQ(ply.size(), ply.find("end_header\n") + 11 + 12 * sphere.point.size() +
                              13 * sphere.triangle.size());
    std::istringstream lines(obj);
    std::string word;
    Vec3d first;
    lines >> word >> first.x >> first.y >> first.z;
    EXPECT_LT(length(first - sphere.point[0]), 1e-5);
    EXPECT_EQ(std::ranges::count(obj, 'f'), static_cast<std::ptrdiff_t>(sphere.triangle.size()));
}

}  // namespace vog::test
