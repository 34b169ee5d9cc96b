// splat_frame_test.cpp: splats stand upright in each format and in a unit box, and are read back where the data has them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/exchange.h"
#include "vog/model_io.h"

namespace vog::test {

namespace {

constexpr const char* kFiles[] = {"m.ply", "m.spz", "m.glb", "m.usda"};

/// Writes a copy in which `from` is `to`, both of one length.
void copy_changed(const std::filesystem::path& file, const std::filesystem::path& copy,
                  const std::string& from, const std::string& to) {
    std::string bytes = read_bytes(file);
    const std::size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos) << file << " " << from;
    std::ofstream(copy, std::ios::binary) << bytes.replace(at, to.size(), to);
}

/// A file as programs see it that do not know vog's statement of the frame.
Gaussians read_as_stored(const std::filesystem::path& file) {
    const bool usd = file.extension() == ".usda";
    const std::filesystem::path copy = file.parent_path() / ("other" + file.extension().string());
    copy_changed(file, copy, usd ? "vog:frame" : "vog_frame", usd ? "xyz:frame" : "xyz_frame");
    return read_model(copy);
}

/// 40 Gaussians in a box of edges 30, 60 and 20, away from 0.
Gaussians some_model(Vec3d origin = {}) {
    Gaussians model = random_gaussians(40, 0.02, 0.2, 4);
    for (std::size_t i = 0; i < model.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
            model.mean[i][axis] = 10 * model.mean[i][axis] + 7 * static_cast<float>(axis);
        model.scale[i] = 10.0f * model.scale[i];
    }
    model.origin = origin;
    model.box = {origin + Vec3d{-15, -10, 0}, origin + Vec3d{15, 50, 20}};
    return model;
}

Mat3 covariance(const Gaussians& model, std::size_t i) {
    const Mat3 r = matrix_from_quat(model.rotation[i]);
    Mat3 squares;
    for (int k = 0; k < 3; ++k) squares(k, k) = double{model.scale[i][k]} * model.scale[i][k];
    return r * squares * transpose(r);
}

double largest_difference(const Mat3& a, const Mat3& b) {
    double most = 0;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a(r, c) - b(r, c)));
    return most;
}

/// Largest relative error of a standard deviation, half a step of a sixteenth of a logarithm in .spz, and of a
/// rotation's entries, of 10 bits there.
double shape_error(const std::string& name) { return name == "m.spz" ? 0.5 / 16 + 0.01 : 1e-5; }

/// Turns to y up, by hand: rows of the matrix from the data's axes.
struct Turn {
    Vec3d up;
    Mat3 rows;
};
const Turn kTurns[] = {{{0, 1, 0}, {{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
                       {{0, -1, 0}, {{Vec3d{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}},
                       {{0, 0, 1}, {{Vec3d{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}}},
                       {{0, 0, -1}, {{Vec3d{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}},
                       {{1, 0, 0}, {{Vec3d{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}},
                       {{-1, 0, 0}, {{Vec3d{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}}};

}  // namespace

TEST(splat_frame, every_format_stands_upright_in_a_unit_box) {
    const TempDir dir;
    const Gaussians model = some_model();
    const Splats splats = splats_of(model, {});
    EXPECT_EQ(splats.world_scale, 30);
    EXPECT_EQ(splats.world_center, (Vec3d{0, 20, 10}));
    for (const std::string name : kFiles)
        for (const Turn& turn : kTurns) {
            write_splats(dir / name, splats, turn.up);
            const Gaussians stored = read_as_stored(dir / name);
            ASSERT_EQ(stored.size(), model.size());
            const Mat3 y_down{{Vec3d{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
            const Mat3 rows = name == "m.ply" ? y_down * turn.rows : turn.rows;
            for (std::size_t i = 0; i < model.size(); ++i) {
                const Vec3d p = (1 / 30.0) * (world_mean(model, i) - Vec3d{0, 20, 10});
                EXPECT_LT(length(rows * p - vec_cast<double>(stored.mean[i])), 1e-6)
                    << name << " up " << turn.up.x << turn.up.y << turn.up.z;
                const Mat3 turned = rows * covariance(model, i) * transpose(rows);
                const float s =
                    std::max({model.scale[i].x, model.scale[i].y, model.scale[i].z}) / 30;
                Mat3 expected = turned;
                for (Vec3d& row : expected.row) row = (1 / 900.0) * row;
                EXPECT_LT(largest_difference(expected, covariance(stored, i)),
                          3 * shape_error(name) * double{s} * double{s})
                    << name;
            }
        }
}

TEST(splat_frame, files_are_read_back_in_the_frame_of_the_data) {
    const TempDir dir;
    for (const Vec3d origin : {Vec3d{}, Vec3d{4e6, -3e6, 1e6}})
        for (const bool unit_box : {true, false}) {
            // World coordinates that far from 0 are beyond floats, which is what boxes are for.
            if (!unit_box && origin != Vec3d{}) continue;
            const Gaussians model = some_model(origin);
            const double extinction = 0.01;
            const Splats splats = splats_of(model, {}, {extinction, unit_box});
            const Vec3d ups[] = {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {1, 2, -3}};
            for (const std::string name : kFiles)
                for (const Vec3d up : ups) {
                    write_splats(dir / name, splats, up);
                    const Gaussians read = read_model(dir / name);
                    ASSERT_EQ(read.size(), model.size());
                    // Floats of 24 bits, at the box and again in the world; 24 bits of .spz hold half the box.
                    constexpr double kStep = 60 * 2.4e-7;
                    for (std::size_t i = 0; i < model.size(); ++i) {
                        EXPECT_LT(length(world_mean(read, i) - world_mean(model, i)), kStep)
                            << name << " unit_box " << unit_box;
                        const float s =
                            std::max({model.scale[i].x, model.scale[i].y, model.scale[i].z});
                        EXPECT_LT(largest_difference(covariance(model, i), covariance(read, i)),
                                  3 * shape_error(name) * double{s} * double{s})
                            << name;
                        // Opacity along a ray through the mean: density times length, whatever the unit.
                        const Vec3f r = read.scale[i];
                        const double depth = double{read.density[i]} *
                                             std::sqrt(2 * std::numbers::pi) *
                                             std::cbrt(double{r.x} * r.y * r.z);
                        EXPECT_NEAR(1 - std::exp(-depth), splats.opacity[i],
                                    name == "m.spz" ? 0.51 / 255 : 1e-5);
                    }
                }
        }
}

/// Parts of a file have the origin of the whole.
TEST(splat_frame, parts_have_one_origin) {
    const TempDir dir;
    write_splats(dir / "m.ply", splats_of(some_model({4e6, -3e6, 1e6}), {}));
    const Gaussians whole = read_model(dir / "m.ply");
    EXPECT_NE(whole.origin, Vec3d{});
    for (int part = 0; part < 3; ++part)
        EXPECT_EQ(read_model(dir / "m.ply", {part, 3}).origin, whole.origin);
}

TEST(splat_frame, malformed_statements_are_refused) {
    const TempDir dir;
    const Splats splats = splats_of(some_model(), {});
    for (const std::string name : kFiles) {
        write_splats(dir / name, splats);
        const std::string copy = "bad" + name;
        for (const std::string bad : {"scale -1", "scale x3", "scale 0 ", "SCALE 30"}) {
            copy_changed(dir / name, dir / copy, "scale 30", bad);
            const std::string message = refusal([&] { read_model(dir / copy); });
            EXPECT_NE(message.find(copy + ": "), std::string::npos) << message;
            EXPECT_NE(message.find("expected 'scale S center X Y Z up X Y Z'"), std::string::npos)
                << name << " " << message;
        }
        copy_changed(dir / name, dir / copy, "up 0 1 0", "up 0 0 0");
        EXPECT_NE(refusal([&] { read_model(dir / copy); }).find("expected a direction"),
                  std::string::npos);
    }
    EXPECT_EQ(refusal([&] {
                  write_splats(dir / "m.glb", splats, {0, 0, 0});
              }).substr(0, 9),
              "up 0,0,0:");
}

/// glTF's COLOR_0 is linear; an opacity is one in both.
TEST(splat_frame, gltf_has_colours_for_viewers_that_draw_points) {
    const TempDir dir;
    const Gaussians model = some_model();
    std::vector<Vec3f> colors(model.size(), {1, 0.5f, 0});
    colors[1] = {0.02f, 1, 0};
    const Splats splats = splats_of(model, colors);
    write_splats(dir / "m.glb", splats);
    const std::string bytes = read_bytes(dir / "m.glb");
    std::uint32_t text = 0;
    std::memcpy(&text, bytes.data() + 12, sizeof text);
    const nlohmann::json json = nlohmann::json::parse(bytes.substr(20, text));
    const auto& accessor =
        json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].get<int>()];
    EXPECT_EQ(accessor["type"], "VEC4");
    EXPECT_EQ(accessor["componentType"], 5121);
    EXPECT_EQ(accessor["normalized"], true);
    EXPECT_EQ(accessor["count"], model.size());
    const std::size_t at =
        20 + text + 8 +
        json["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"]
            .get<std::size_t>();
    const auto byte = [&](std::size_t n) { return int{static_cast<unsigned char>(bytes[at + n])}; };
    // sRGB 0.5 is 0.2140 linear, 0.02 is 0.001548.
    for (const auto& [n, expected] :
         {std::pair{0u, 255}, {1u, 55}, {2u, 0}, {4u, 0}, {5u, 255}, {6u, 0}})
        EXPECT_EQ(byte(n), expected) << n;
    for (std::size_t i = 0; i < model.size(); ++i)
        EXPECT_EQ(byte(4 * i + 3), std::lround(255 * splats.opacity[i]));
    EXPECT_TRUE(json["scenes"][0]["extras"].contains("vog_frame"));
}

/// Extras of other programs may be any JSON.
TEST(splat_frame, other_extras_of_a_scene_are_left_alone) {
    const TempDir dir;
    write_splats(dir / "m.glb", splats_of(some_model(), {}));
    const Gaussians stored = read_as_stored(dir / "m.glb");
    EXPECT_EQ(stored.origin, Vec3d{});
    for (const Vec3f mean : stored.mean)
        EXPECT_LE(std::max({std::abs(mean.x), std::abs(mean.y), std::abs(mean.z)}), 1);
}

}  // namespace vog::test
