// exchange_test.cpp: splats of other programs: the same shapes, matched optical depth, bytes as their formats state.
#include "vog/exchange.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

std::string gunzipped(const std::string& bytes, std::size_t size) {
    std::string out(size + 1, '\0');
    z_stream stream{};
    inflateInit2(&stream, 16 + MAX_WBITS);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    inflateEnd(&stream);
    return out;
}

Gaussians cloud(double scale) {
    Gaussians model = random_gaussians(200, 0.05 * scale, 0.2 * scale, 1);
    for (Vec3f& mean : model.mean) mean = static_cast<float>(scale) * mean;
    model.source = "a cloud";
    return model;
}

/// Extinction at which the largest opacity is about a half.
double thin(const Gaussians& model) {
    double most = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3f s = model.scale[i];
        most = std::max(most, double{model.density[i]} * double{std::max({s.x, s.y, s.z})});
    }
    return 0.3 / most;
}

std::vector<Vec3f> random_colors(std::size_t count) {
    Random random(2);
    std::vector<Vec3f> colors;
    for (std::size_t n = 0; n < count; ++n)
        colors.push_back({static_cast<float>(random()), static_cast<float>(random()),
                          static_cast<float>(random())});
    return colors;
}

}  // namespace

TEST(exchange, a_splat_has_the_optical_depth_of_its_gaussian) {
    // One ball: no direction differs. -ln(1 - o exp(-r^2 / 2)) over the screen is the mass times the extinction.
    for (const double extinction : {0.01, 0.3, 1.0}) {
        Gaussians ball;
        add(ball, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 1);
        const double o = splats_of(ball, {}, {extinction, false}).opacity[0];
        double depth = 0;
        constexpr int kSteps = 200000;
        constexpr double kStep = 20.0 / kSteps;
        for (int n = 0; n < kSteps; ++n) {
            const double r = (n + 0.5) * kStep;
            depth -= std::log1p(-o * std::exp(-r * r / 2)) * r * kStep;
        }
        depth *= 2 * std::numbers::pi * 0.25;
        EXPECT_NEAR(depth / (extinction * mass(ball)), 1, 1e-4) << extinction;
    }
    Gaussians dense;
    add(dense, {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 100);
    EXPECT_NEAR(splats_of(dense, {}).opacity[0], 0.9999f, 1e-6);
}

TEST(exchange, mean_optical_depth_is_kept_whatever_the_shape) {
    Gaussians model = cloud(1);
    // Without the cut at alphas of 1/255 the ratio would be 1.
    const double extinction = 4 * thin(model);
    const SplatsError error =
        splats_error(model, splats_of(model, {}, {extinction, false}), extinction);
    EXPECT_NEAR(error.depth, 1, 0.06);
    EXPECT_GT(error.worst_db, 25);
    EXPECT_GE(error.mean_db, error.worst_db);
    EXPECT_EQ(splats_error(Gaussians{}, Splats{}, 1).depth, 1);
    EXPECT_EQ(refusal([&] { (void)splats_error(model, Splats{}, 1); }), "0 splats, expected 200");
}

TEST(exchange, ply_of_3dgs_is_read_with_the_same_shapes) {
    const TempDir dir;
    const Gaussians model = cloud(1);
    const auto colors = random_colors(model.size());
    write_splats(dir / "m.ply", splats_of(model, colors, {thin(model), false}));
    const Gaussians read = read_ply(dir / "m.ply");
    EXPECT_EQ(read.method, "3DGS");
    EXPECT_EQ(read.mean, model.mean);
    for (std::size_t i = 0; i < model.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(read.scale[i][axis] / model.scale[i][axis], 1, 1e-6);
    const std::string bytes = read_bytes(dir / "m.ply");
    const std::size_t body = bytes.find("end_header\n") + 11;
    // f_dc is the seventh property; renderers take 1/2 + f_dc / (2 sqrt(pi)).
    for (std::size_t i = 0; i < model.size(); ++i)
        EXPECT_NEAR(0.5 + 0.28209479 * number_at<float>(bytes, body + (17 * i + 6) * 4),
                    colors[i].x, 1e-6);
}

TEST(exchange, volprim_keeps_the_mass) {
    const TempDir dir;
    const Gaussians model = cloud(1);
    write_volprim(dir / "m.ply", model, 2.5);
    const Gaussians read = read_ply(dir / "m.ply");
    EXPECT_EQ(read.method, "volprim");
    EXPECT_EQ(read.mean, model.mean);
    EXPECT_NEAR(mass(read) / (2.5 * mass(model)), 1, 1e-5);
    EXPECT_EQ(refusal([&] { write_volprim(dir / "m.ply", model, 0); }),
              "extinction 0, expected > 0");
}

TEST(exchange, spz_holds_columns_of_bytes) {
    const TempDir dir;
    const Gaussians model = cloud(10);
    const Splats splats = splats_of(model, random_colors(model.size()), {thin(model), false});
    write_splats(dir / "m.spz", splats);
    const std::size_t n = model.size();
    const std::string bytes = gunzipped(read_bytes(dir / "m.spz"), 16 + 20 * n);
    ASSERT_EQ(bytes.size(), 16 + 20 * n);
    EXPECT_EQ(bytes.substr(0, 4), "NGSP");
    EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 3u);
    EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), n);
    EXPECT_EQ(bytes[12], 0);
    const int bits = bytes[13];
    for (std::size_t i = 0; i < n; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t a = static_cast<std::size_t>(axis), at = 16 + 9 * i + 3 * a;
            const auto fixed =
                static_cast<std::int32_t>(
                    static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at])) << 8 |
                    static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + 1])) << 16 |
                    static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + 2])) << 24) /
                256;
            EXPECT_NEAR(std::ldexp(fixed, -bits), splats.mean[i][axis], std::ldexp(0.51, -bits));
            const auto scale = static_cast<unsigned char>(bytes[16 + 13 * n + 3 * i + a]);
            EXPECT_NEAR(scale / 16.0 - 10, std::log(splats.scale[i][axis]), 0.04);
        }
        EXPECT_NEAR(static_cast<unsigned char>(bytes[16 + 9 * n + i]) / 255.0, splats.opacity[i],
                    0.002);
        // The smallest three: index of the largest in the upper bits, then sign and nine bits of each.
        auto packed = number_at<std::uint32_t>(bytes, 16 + 16 * n + 4 * i);
        const std::uint32_t largest = packed >> 30;
        std::array<double, 4> q{};
        double squares = 0;
        for (std::uint32_t k = 4; k-- > 0;) {
            if (k == largest) continue;
            q[k] = (packed & 511) / 511.0 * std::sqrt(0.5) * (packed >> 9 & 1 ? -1 : 1);
            squares += q[k] * q[k];
            packed >>= 10;
        }
        q[largest] = std::sqrt(1 - squares);
        const Quat r = splats.rotation[i];
        EXPECT_NEAR(std::abs(q[0] * r.x + q[1] * r.y + q[2] * r.z + q[3] * r.w), 1, 1e-4);
    }
}

TEST(exchange, spz_refuses_what_its_positions_cannot_hold) {
    const TempDir dir;
    Gaussians far = cloud(1);
    far.origin = {1e7, 0, 0};
    const auto write = [&](bool unit_box) {
        write_splats(dir / "m.spz", splats_of(far, {}, {1, unit_box}));
    };
    EXPECT_NE(refusal([&] { write(false); }).find("positions beyond 24 bits"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(dir / "m.spz"));
    EXPECT_EQ(refusal([&] { write(true); }), "no error");
    const auto refused = [&](double scale) {
        return refusal([&] {
            write_splats(dir / "n.spz", splats_of(cloud(scale), {}, {1, false}));
        });
    };
    EXPECT_NE(refused(1e4).find("standard deviations from"), std::string::npos);
    EXPECT_NE(refused(1e-5).find("standard deviations from"), std::string::npos);
    Gaussians fine = cloud(1000);
    fine.scale[3] = {6e-5f, 6e-5f, 6e-5f};
    EXPECT_NE(refusal([&] {
                  write_splats(dir / "n.spz", splats_of(fine, {}, {1, false}));
              }).find("have steps of"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(dir / "n.spz"));
}

TEST(exchange, glb_points_into_its_binary_chunk) {
    const TempDir dir;
    const Gaussians model = cloud(1);
    const Splats splats = splats_of(model, {}, {thin(model), true});
    write_splats(dir / "m.glb", splats);
    const std::string bytes = read_bytes(dir / "m.glb");
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), bytes.size());
    const auto text = number_at<std::uint32_t>(bytes, 12);
    EXPECT_EQ(text % 4, 0u);
    const nlohmann::json json = nlohmann::json::parse(bytes.substr(20, text));
    const std::size_t body = 20 + text + 8;
    EXPECT_EQ(number_at<std::uint32_t>(bytes, body - 8), bytes.size() - body);
    EXPECT_EQ(json["buffers"][0]["byteLength"], bytes.size() - body);
    const auto& primitive = json["meshes"][0]["primitives"][0];
    EXPECT_EQ(primitive["mode"], 0);
    const auto first_of = [&](const std::string& name) {
        const auto& accessor = json["accessors"][primitive["attributes"][name].get<std::size_t>()];
        EXPECT_EQ(accessor["count"], model.size());
        return body + json["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"]
                          .get<std::size_t>();
    };
    EXPECT_EQ(number_at<float>(bytes, first_of("POSITION") + 12), splats.mean[1].x);
    EXPECT_EQ(number_at<float>(bytes, first_of("KHR_gaussian_splatting:SCALE") + 12),
              splats.scale[1].x);
    EXPECT_EQ(number_at<float>(bytes, first_of("KHR_gaussian_splatting:ROTATION") + 12),
              splats.rotation[0].w);
    EXPECT_EQ(number_at<float>(bytes, first_of("KHR_gaussian_splatting:OPACITY") + 4),
              splats.opacity[1]);
    // The unit box: at most 1 from 0.
    for (const Vec3f m : splats.mean)
        EXPECT_LE(std::max({std::abs(m.x), std::abs(m.y), std::abs(m.z)}), 1);
}

TEST(exchange, usda_has_the_schemas_attributes) {
    const TempDir dir;
    const Gaussians model = select(cloud(1), std::vector<std::size_t>{0, 1});
    const Splats splats = splats_of(model, {}, {1, false});
    write_splats(dir / "m.usda", splats);
    const std::string text = read_bytes(dir / "m.usda");
    for (const char* line : {"#usda 1.0\n", "def ParticleField3DGaussianSplat \"Splats\"\n",
                             "    point3f[] positions = [(", "    quatf[] orientations = [(",
                             "    float3[] scales = [(", "    float[] opacities = [",
                             "    uniform int radiance:sphericalHarmonicsDegree = 0\n",
                             "    float3[] radiance:sphericalHarmonicsCoefficients = [(1.7724539, "
                             "1.7724539, 1.7724539), "})
        EXPECT_NE(text.find(line), std::string::npos) << line;
}

TEST(exchange, refusals) {
    const TempDir dir;
    const Gaussians model = cloud(1);
    EXPECT_EQ(refusal([&] {
                  (void)splats_of(model, {}, {-1, false});
              }),
              "extinction -1, expected > 0");
    EXPECT_EQ(refusal([&] { (void)splats_of(model, random_colors(3)); }),
              "3 colours, expected 200");
    EXPECT_NE(refusal([&] {
                  write_splats(dir / "m.splat", splats_of(model, {}));
              }).find("expected .ply, .spz, .glb or .usda"),
              std::string::npos);
    for (const char* name : {"m.usdc", "m.usd"}) {
        const std::string message =
            refusal([&] { write_splats(dir / name, splats_of(model, {})); });
        EXPECT_TRUE(message.ends_with(std::string("m.usda -o ") + (dir / name).string()))
            << message;
    }
    EXPECT_NE(refusal([&] {
                  write_splats(dir / "m.spz", Splats{});
              }).find("no splats, expected at least one"),
              std::string::npos);
}

}  // namespace vog::test
