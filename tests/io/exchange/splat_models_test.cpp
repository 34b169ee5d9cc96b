// splat_models_test.cpp: Gaussians of .spz and .glb: the splats that were written, placed by their nodes; refusals.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/exchange.h"
#include "vog/model_io.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

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

std::string gunzipped(const std::string& bytes) {
    z_stream stream{};
    inflateInit2(&stream, 16 + MAX_WBITS);
    std::string out(std::size_t{1} << 20, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    inflateEnd(&stream);
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
    write_bytes(dir / "m.spz", gzipped(bytes + std::string(9, '\x80')));
    const Gaussians read = read_model(dir / "m.spz");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read.mean[0], (Vec3f{1, -1, 0.5f}));
    EXPECT_FLOAT_EQ(read.scale[0].x, 1);
    EXPECT_FLOAT_EQ(read.scale[0].y, std::exp(-1.0f));
    EXPECT_NEAR(read.rotation[0].x, 1, 1e-3);
    write_bytes(dir / "short.spz", gzipped(bytes));
    EXPECT_NE(refusal([&] { read_model(dir / "short.spz"); }).find("truncated"), std::string::npos);
    write_bytes(dir / "long.spz", gzipped(bytes + std::string(10, '\x80')));
    EXPECT_NE(refusal([&] { read_model(dir / "long.spz"); }).find("longer than"),
              std::string::npos);
    for (const auto& [at, value, word] : {std::tuple{4u, '\4', "version 4"},
                                          {0u, 'X', "not an SPZ file"},
                                          {12u, '\5', "degree 5"},
                                          {11u, '\x7f', "splats in"}}) {
        std::string other = bytes + std::string(9, '\x80');
        other[at] = value;
        write_bytes(dir / "other.spz", gzipped(other));
        EXPECT_NE(refusal([&] { read_model(dir / "other.spz"); }).find(word), std::string::npos)
            << word;
    }
    write_bytes(dir / "plain.spz", bytes);
    EXPECT_NE(refusal([&] { read_model(dir / "plain.spz"); }).find("version 2 without gzip"),
              std::string::npos);
}

/// Version 4 has the columns of version 3, each a zstd stream behind a table. Source: github.com/nianticlabs/spz, README.
TEST(splat_models, spz_of_version_4_holds_the_columns_of_version_3) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.spz", splats);
    const std::string three = gunzipped(read_bytes(dir / "m.spz"));
    const auto number = [](std::uint64_t value, std::size_t bytes) {
        std::string text(reinterpret_cast<const char*>(&value), bytes);
        return text;
    };
    // A frame of one segment with its size in 4 bytes, and one raw block, the last.
    const auto frame = [&](const std::string& bytes) {
        return "\x28\xb5\x2f\xfd\xa0" + number(bytes.size(), 4) + number(bytes.size() << 3 | 1, 3) +
               bytes;
    };
    const std::size_t count = splats.size();
    const auto made = [&](std::size_t harmonics, const std::string& extension) {
        std::string table, streams;
        std::size_t at = 16;
        int number_of_streams = 0;
        const auto add = [&](const std::string& column) {
            if (column.empty()) return;
            const std::string packed = frame(column);
            table += number(packed.size(), 8) + number(column.size(), 8);
            streams += packed;
            ++number_of_streams;
        };
        for (const std::size_t width : {9u, 1u, 3u, 3u, 4u}) {
            add(three.substr(at, width * count));
            at += width * count;
        }
        constexpr std::size_t kHarmonics[] = {0, 9, 24, 45, 72};
        add(std::string(kHarmonics[harmonics] * count, '\x80'));
        std::string head = "NGSP" + number(4, 4) + three.substr(8, 4);
        head += number(harmonics, 1) + three.substr(13, 1) + number(extension.empty() ? 0 : 2, 1) +
                number(static_cast<std::uint64_t>(number_of_streams), 1);
        head += number(32 + extension.size(), 4) + std::string(12, '\0');
        return head + extension + table + streams;
    };
    const Gaussians expected = read_model(dir / "m.spz");
    for (const std::size_t harmonics : {0u, 1u, 4u})
        for (const std::string& extension : {std::string(), std::string(20, 'e')}) {
            write_bytes(dir / "four.spz", made(harmonics, extension));
            const Gaussians read = read_model(dir / "four.spz");
            EXPECT_EQ(read.mean, expected.mean);
            EXPECT_EQ(read.scale, expected.scale);
            EXPECT_EQ(read.density, expected.density);
            EXPECT_TRUE(std::ranges::equal(read.rotation, expected.rotation, [](Quat a, Quat b) {
                return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
            }));
        }
    const std::string good = made(1, "");
    for (std::size_t size = 0; size < good.size(); size += 61) {
        write_bytes(dir / "cut.spz", good.substr(0, size));
        EXPECT_NE(refusal([&] { read_model(dir / "cut.spz"); }).find("truncated"),
                  std::string::npos)
            << size;
    }
    // Version, number of streams, place of the table, sizes of the first stream, magic of its frame.
    for (const auto& [at, value, word] : {std::tuple{4u, '\5', "version 5"},
                                          {15u, '\3', "version 4"},
                                          {16u, '\0', "version 4"},
                                          {32u, '\1', "version 4"},
                                          {40u, '\1', "version 4"},
                                          {128u, 'x', "version 4"}}) {
        std::string bad = good;
        bad[at] = value;
        write_bytes(dir / "bad.spz", bad);
        const std::string message = refusal([&] { read_model(dir / "bad.spz"); });
        EXPECT_NE(message.find(word), std::string::npos) << at << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(splat_models, a_glb_without_scenes_has_its_root_nodes) {
    const TempDir dir;
    write_splats(dir / "m.glb", some_splats());
    write_bytes(dir / "moved.glb", changed_glb(read_bytes(dir / "m.glb"), [](nlohmann::json& json) {
                    json.erase("scenes"), json.erase("scene");
                    json["nodes"] = {{{"mesh", 0}, {"translation", {1, 0, 0}}},
                                     {{"children", {0}}, {"translation", {2, 0, 0}}}};
                }));
    const Gaussians plain = read_model(dir / "m.glb"), read = read_model(dir / "moved.glb");
    ASSERT_EQ(read.size(), plain.size());
    EXPECT_NEAR(read.mean[0].x, plain.mean[0].x + 3, 1e-6);
}

TEST(splat_models, splats_without_finite_numbers_are_left_out_where_that_is_asked_for) {
    const TempDir dir;
    for (const char* name : {"m.ply", "m.glb", "m.usda"}) {
        Splats splats = some_splats();
        splats.mean[3].y = std::numeric_limits<float>::quiet_NaN();
        splats.scale[5].z = std::numeric_limits<float>::infinity();
        splats.opacity[7] = std::numeric_limits<float>::quiet_NaN();
        write_splats(dir / name, splats);
        const std::string message = refusal([&] { read_model(dir / name); });
        EXPECT_NE(message.find("3 splats with a number that is not finite, or with a rotation of "
                               "0, the first is number 3"),
                  std::string::npos)
            << name << message;
        EXPECT_NE(message.find("--skip-nonfinite"), std::string::npos) << message;
        ValueNotes notes;
        const Gaussians read = read_model(dir / name, nullptr, {.skip_nonfinite = true}, &notes);
        EXPECT_EQ(read.size(), splats.size() - 3) << name;
        EXPECT_EQ(notes.skipped_nonfinite, 3u) << name;
        EXPECT_EQ(read.mean[3], splats.mean[4]) << name;
    }
}

TEST(splat_models, files_in_the_table_of_reports) {
    const auto folder = source_dir() / ".." / "shared" / "reported";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    const Gaussians glb = read_model(folder / "g_noscenes.glb"),
                    ply = read_model(folder / "mlsharp.ply");
    EXPECT_EQ(glb.size(), 50u);
    EXPECT_EQ(ply.mean, glb.mean);
    // A table at byte 0, and streams of zeros.
    EXPECT_NE(refusal([&] { read_model(folder / "v4.spz"); }).find("version 4"), std::string::npos);
}

TEST(splat_models, nodes_place_their_splats) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.glb", splats);
    const float r = std::sqrt(0.5f);
    // A quarter turn about z and a factor of 2, below a node that moves.
    write_bytes(
        dir / "placed.glb", changed_glb(read_bytes(dir / "m.glb"), [&](nlohmann::json& json) {
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

TEST(splat_models, files_may_require_what_leaves_splats_alone) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.glb", splats);
    const std::string glb = read_bytes(dir / "m.glb");
    write_bytes(dir / "lit.glb", changed_glb(glb, [](nlohmann::json& json) {
                    json["extensionsRequired"] = {"KHR_gaussian_splatting", "KHR_materials_unlit",
                                                  "KHR_texture_transform", "KHR_lights_punctual",
                                                  "KHR_mesh_quantization"};
                }));
    EXPECT_EQ(read_model(dir / "lit.glb").mean, read_model(dir / "m.glb").mean);
    // Whole numbers of KHR_mesh_quantization are places as they are, or shares of the largest number.
    for (const bool normalized : {false, true}) {
        write_bytes(
            dir / "whole.glb", changed_glb(glb, [&](nlohmann::json& json) {
                nlohmann::json& accessor =
                    json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
                                          .get<std::size_t>()];
                accessor["componentType"] = 5123;
                accessor["normalized"] = normalized;
            }));
        const Gaussians read = read_model(dir / "whole.glb");
        std::array<std::uint16_t, 3> stored{};
        std::memcpy(stored.data(), splats.mean.data(), sizeof stored);
        const float factor = normalized ? 1 / 65535.0f : 1;
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_FLOAT_EQ(read.mean[0][axis],
                            factor * static_cast<float>(stored[static_cast<std::size_t>(axis)]));
    }
}

TEST(splat_models, files_that_are_no_plain_splats_are_refused) {
    const TempDir dir;
    write_splats(dir / "m.glb", some_splats());
    const std::string glb = read_bytes(dir / "m.glb");
    const auto message = [&](const std::function<void(nlohmann::json&)>& change) {
        write_bytes(dir / "bad.glb", changed_glb(glb, change));
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
        {[](json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
         "needs the extension \"KHR_draco_mesh_compression\""},
        {[](json& j) {
             j["extensionsRequired"] = {"KHR_lights_punctual", "EXT_meshopt_compression"};
         },
         "needs the extension \"EXT_meshopt_compression\""},
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
        write_bytes(dir / "cut.glb", glb.substr(0, size));
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
