// splat_models_test.cpp: Gaussians of .spz and .glb: the splats that were written, placed by their nodes; refusals.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "support/data.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/exchange.h"
#include "vog/model_io.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

std::string whole(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void save(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

Splats some_splats() {
    const Gaussians model = random_gaussians(150, 0.02, 0.2, 4);
    Splats splats = splats_of(model, {}, {3, false});
    splats.opacity[0] = 0.25f;
    return splats;
}

/// A .glb of changed JSON.
std::string changed_glb(const std::string& glb,
                        const std::function<void(nlohmann::json&)>& change) {
    std::uint32_t size = 0;
    std::memcpy(&size, glb.data() + 12, sizeof size);
    auto json = nlohmann::json::parse(glb.substr(20, size));
    change(json);
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string out = glb.substr(0, 20) + text + glb.substr(20 + size);
    const auto put = [&](std::size_t at, std::size_t value) {
        const auto word = static_cast<std::uint32_t>(value);
        std::memcpy(out.data() + at, &word, sizeof word);
    };
    put(8, out.size());
    put(12, text.size());
    return out;
}

std::string gzipped(const std::string& bytes) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, bytes.size()) + 32, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

/// Difference of two rotations as matrices.
double turn_between(Quat a, Quat b) {
    const Mat3 p = matrix_from_quat(a), q = matrix_from_quat(b);
    double most = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(p(i, j) - q(i, j)));
    return most;
}

}  // namespace

TEST(splat_models, glb_holds_the_numbers_of_the_splats) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.glb", splats);
    write_splats(dir / "m.ply", splats);
    const Gaussians read = read_model(dir / "m.glb"), ply = read_ply(dir / "m.ply");
    EXPECT_EQ(read.method, "glTF splats");
    EXPECT_EQ(read.cutoff, 3);
    EXPECT_TRUE(std::ranges::equal(read.mean, splats.mean));
    EXPECT_TRUE(std::ranges::equal(read.scale, splats.scale));
    for (std::size_t i = 0; i < splats.size(); ++i) {
        EXPECT_LT(turn_between(read.rotation[i], splats.rotation[i]), 1e-6);
        // A ray through the mean of a ball of this density sees the opacity.
        const Vec3f s = read.scale[i];
        const double depth = double{read.density[i]} * std::sqrt(2 * std::numbers::pi) *
                             std::cbrt(double{s.x} * s.y * s.z);
        EXPECT_NEAR(1 - std::exp(-depth), splats.opacity[i], 1e-6);
        EXPECT_NEAR(read.density[i] / ply.density[i], 1, 1e-4);
    }
}

TEST(splat_models, spz_holds_them_to_its_bytes) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.SPZ", splats);
    const Gaussians read = read_model(dir / "m.SPZ");
    ASSERT_EQ(read.size(), splats.size());
    EXPECT_EQ(read.method, "SPZ");
    for (std::size_t i = 0; i < splats.size(); ++i) {
        EXPECT_LT(length(vec_cast<double>(read.mean[i] - splats.mean[i])), 1e-5);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(std::log(read.scale[i][axis] / splats.scale[i][axis]), 0, 1.01 / 32);
        EXPECT_LT(turn_between(read.rotation[i], splats.rotation[i]), 0.01);
        const Vec3f s = read.scale[i];
        const double depth = double{read.density[i]} * std::sqrt(2 * std::numbers::pi) *
                             std::cbrt(double{s.x} * s.y * s.z);
        EXPECT_NEAR(1 - std::exp(-depth), std::min(0.9999f, splats.opacity[i]), 0.51 / 255);
    }
}

/// Rotations of version 2 are three bytes; harmonics are skipped.
TEST(splat_models, spz_of_version_2_with_harmonics) {
    const TempDir dir;
    std::string bytes("NGSP\2\0\0\0\1\0\0\0\1\x0c\0\0", 16);
    bytes += std::string("\x00\x10\x00\x00\xf0\xff\x00\x08\x00", 9);  // 1, -1, 1/2 in 12 bits
    bytes += '\x80';                                                  // opacity
    bytes += "abc";                                                   // colour
    bytes += std::string("\xa0\x90\xa0", 3);                          // logarithms 0, -1, 0
    bytes += std::string("\xff\x7f\x7f", 3);                          // about x, half a turn
    save(dir / "m.spz", gzipped(bytes + std::string(9, '\x80')));
    const Gaussians read = read_model(dir / "m.spz");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read.mean[0], (Vec3f{1, -1, 0.5f}));
    EXPECT_FLOAT_EQ(read.scale[0].x, 1);
    EXPECT_FLOAT_EQ(read.scale[0].y, std::exp(-1.0f));
    EXPECT_NEAR(read.rotation[0].x, 1, 1e-3);
    save(dir / "short.spz", gzipped(bytes));
    EXPECT_NE(refusal([&] { read_model(dir / "short.spz"); }).find("truncated"), std::string::npos);
    save(dir / "long.spz", gzipped(bytes + std::string(10, '\x80')));
    EXPECT_NE(refusal([&] { read_model(dir / "long.spz"); }).find("longer than"),
              std::string::npos);
    for (const auto& [at, value, word] : {std::tuple{4u, '\4', "version 4"},
                                          {0u, 'X', "not an SPZ file"},
                                          {12u, '\4', "degree 4"},
                                          {11u, '\x7f', "splats in"}}) {
        std::string other = bytes + std::string(9, '\x80');
        other[at] = value;
        save(dir / "other.spz", gzipped(other));
        EXPECT_NE(refusal([&] { read_model(dir / "other.spz"); }).find(word), std::string::npos)
            << word;
    }
    save(dir / "plain.spz", bytes);
    EXPECT_NE(refusal([&] { read_model(dir / "plain.spz"); }).find("not an SPZ file"),
              std::string::npos);
}

TEST(splat_models, nodes_place_their_splats) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.glb", splats);
    const float r = std::sqrt(0.5f);
    // A quarter turn about z and a factor of 2, below a node that moves.
    save(dir / "placed.glb", changed_glb(whole(dir / "m.glb"), [&](nlohmann::json& json) {
             json["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1}}},
                              {{"rotation", {0, 0, r, r}}, {"scale", {2, 2, 2}}, {"mesh", 0}}};
         }));
    const Gaussians read = read_model(dir / "placed.glb");
    for (std::size_t i = 0; i < splats.size(); ++i) {
        const Vec3f m = splats.mean[i];
        const Vec3f placed{10 - 2 * m.y, 2 * m.x, 2 * m.z};
        EXPECT_LT(length(vec_cast<double>(read.mean[i] - placed)), 1e-5);
        EXPECT_EQ(read.scale[i], 2.0f * splats.scale[i]);
    }
    const Mat3 own = matrix_from_quat(splats.rotation[3]),
               turned = matrix_from_quat(read.rotation[3]);
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(turned(0, k), -own(1, k), 1e-6);
        EXPECT_NEAR(turned(1, k), own(0, k), 1e-6);
    }
}

TEST(splat_models, files_that_are_no_plain_splats_are_refused) {
    const TempDir dir;
    write_splats(dir / "m.glb", some_splats());
    const std::string glb = whole(dir / "m.glb");
    const auto message = [&](const std::function<void(nlohmann::json&)>& change) {
        save(dir / "bad.glb", changed_glb(glb, change));
        return refusal([&] { read_model(dir / "bad.glb"); });
    };
    using nlohmann::json;
    const std::vector<std::pair<std::function<void(json&)>, const char*>> bad{
        {[](json& j) {
             j["nodes"][0]["scale"] = {1, 2, 1};
         },
         "expected one factor"},
        {[](json& j) { j["nodes"][0]["matrix"] = {1}; }, "matrix"},
        {[](json& j) { j["nodes"][0]["children"] = {0}; }, "node 0"},
        {[](json& j) { j["scenes"][0]["nodes"] = {7}; }, "corrupt"},
        {[](json& j) { j["buffers"][0]["uri"] = "m.bin"; }, "another file"},
        {[](json& j) { j["accessors"][0]["count"] = 1 << 30; }, "rows"},
        {[](json& j) { j["accessors"][0]["count"] = 7; }, "splats"},
        {[](json& j) { j["bufferViews"][1]["byteOffset"] = 1ull << 63; }, "rows"},
        {[](json& j) { j["accessors"][0]["componentType"] = 5125; }, "component type"},
        {[](json& j) { j["accessors"][1]["type"] = "VEC2"; }, "VEC2"},
        {[](json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); },
         "without POSITION"},
        {[](json& j) { j["meshes"][0]["primitives"][0].erase("extensions"); }, "no splats"},
        {[](json& j) {
             const json one = j["meshes"][0]["primitives"][0];
             for (int n = 0; n < 20; ++n) j["meshes"][0]["primitives"].push_back(one);
         },
         "splats in"},
        {[](json& j) {
             j["meshes"][0]["primitives"][0]["extensions"]["KHR_gaussian_splatting"]["extensions"] =
                 {{"KHR_gaussian_splatting_compression_spz_2", json::object()}};
         },
         "packed by KHR_gaussian_splatting_compression_spz_2"}};
    for (const auto& [change, word] : bad) {
        const std::string text = message(change);
        EXPECT_NE(text.find(word), std::string::npos) << text;
        EXPECT_NE(text.find("bad.glb"), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
    for (const std::size_t size : {0ul, 11ul, 19ul, 40ul, glb.size() / 2, glb.size() - 1}) {
        save(dir / "cut.glb", glb.substr(0, size));
        EXPECT_NE(refusal([&] { read_model(dir / "cut.glb"); }), "no error") << size;
    }
    EXPECT_NE(refusal([&] {
                  write_model(dir / "out.glb", random_gaussians(2, 0.1, 0.2, 1));
              }).find("write_splats"),
              std::string::npos);
}

TEST(splat_models, parts_make_up_the_whole) {
    const TempDir dir;
    write_splats(dir / "m.glb", some_splats());
    const Gaussians all = read_model(dir / "m.glb");
    Gaussians joined;
    for (int part = 0; part < 3; ++part) append(joined, read_model(dir / "m.glb", {part, 3}));
    EXPECT_EQ(joined.mean, all.mean);
    EXPECT_EQ(joined.density, all.density);
}

}  // namespace vog::test
