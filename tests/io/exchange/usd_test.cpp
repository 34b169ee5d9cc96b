// usd_test.cpp: splats of OpenUSD as text and as crates: the numbers that were written, prims that are not drawn, refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include "io/exchange/usd/crate_codes.h"
#include "support/data.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/exchange.h"
#include "vog/model_io.h"

namespace vog::test {

namespace {

using namespace exchange::usd;

std::string whole(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void save(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

Splats some_splats(int count = 150) {
    return splats_of(random_gaussians(count, 0.02, 0.2, 4), {}, {3, false});
}

/// Message of the reader for a layer's text behind its first line.
std::string text_refusal(const std::string& text) {
    const TempDir dir;
    save(dir / "m.usda", "#usda 1.0\n" + text);
    return refusal([&] { read_model(dir / "m.usda"); });
}

constexpr const char* kTwo =
    "    point3f[] positions = [(1, 2, 3), (-4, 5e-1, inf)]\n"
    "    quatf[] orientations = [(1, 0, 0, 0), (0, 1, 0, 0)]\n"
    "    float3[] scales = [(1, 1, 1), (2, 2, 2)]\n"
    "    float[] opacities = [0.5, 0.25]\n";

/// The lines of two splats at finite places.
std::string two() {
    std::string text = kTwo;
    return text.replace(text.find("inf"), 3, "6.5");
}
std::string prim(const std::string& lines) {
    return "def ParticleField3DGaussianSplat \"S\"\n{\n" + lines + "}\n";
}

}  // namespace

TEST(usd, text_and_crate_hold_the_numbers_of_the_splats) {
    const TempDir dir;
    const Splats splats = some_splats();
    write_splats(dir / "m.usda", splats);
    write_splats(dir / "m.usdc", splats);
    write_splats(dir / "m.glb", splats);
    save(dir / "text.usd", whole(dir / "m.usda"));
    save(dir / "crate.USD", whole(dir / "m.usdc"));
    const Gaussians glb = read_model(dir / "m.glb");
    for (const char* name : {"m.usda", "m.usdc", "text.usd", "crate.USD"}) {
        const Gaussians read = read_model(dir / name);
        EXPECT_EQ(read.method, "OpenUSD splats");
        EXPECT_EQ(read.cutoff, 3);
        EXPECT_EQ(read.mean, glb.mean) << name;
        EXPECT_EQ(read.scale, glb.scale) << name;
        EXPECT_EQ(read.density, glb.density) << name;
        for (std::size_t i = 0; i < splats.size(); ++i) {
            const Quat a = read.rotation[i], b = splats.rotation[i];
            EXPECT_TRUE(a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z) << name << i;
        }
    }
}

TEST(usd, numbers_of_crates_come_back) {
    std::mt19937 random(1);
    std::vector<std::vector<std::int32_t>> all{{}, {0}, {-1}, {5, 5, 5, 5, 5}};
    constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min(),
                           kMost = std::numeric_limits<std::int32_t>::max();
    all.push_back({kLeast, kMost, 0, kMost, kLeast, -128, 127, -32768, 32767});
    for (const int bits : {2, 9, 17, 32}) {
        std::vector<std::int32_t> numbers(1000);
        for (std::int32_t& number : numbers)
            number = static_cast<std::int32_t>(random() >> (32 - bits));
        all.push_back(numbers);
    }
    for (const std::vector<std::int32_t>& numbers : all) {
        const std::string packed = crate_coded(numbers);
        EXPECT_EQ(crate_decoded(packed, numbers.size()), numbers);
        for (const std::size_t size : {std::size_t{0}, std::size_t{1}, packed.size() - 1})
            EXPECT_THROW((void)crate_decoded(std::span(packed).first(size), numbers.size()),
                         CrateFault);
    }
}

TEST(usd, blocks_of_lz4_with_repetitions) {
    // Three literals, then 4 + 15 + 2 bytes from 3 back; then one literal.
    const std::string one(
        "\0\x3f"
        "abc"
        "\3\0\2"
        "\x10"
        "d",
        10);
    std::string expected;
    while (expected.size() < 24) expected += "abc";
    expected += 'd';
    EXPECT_EQ(crate_unpacked(one, 100), expected);
    // Two blocks of their own.
    const std::string two(
        "\2"
        "\3\0\0\0"
        "\x20xy"
        "\2\0\0\0"
        "\x10z",
        14);
    EXPECT_EQ(crate_unpacked(two, 100), "xyz");
    EXPECT_EQ(crate_unpacked(crate_packed(expected), 25), expected);
    const std::string long_text(1000, 'q');
    EXPECT_EQ(crate_unpacked(crate_packed(long_text), 1000), long_text);
    EXPECT_THROW((void)crate_unpacked(one, 24), CrateFault);
    for (const std::string& bad :
         {std::string("\0\x10"
                      "a"
                      "\2\0",
                      5),
          std::string("\0\x10"
                      "a"
                      "\0\0",
                      5),
          std::string("\0\xf0", 2), std::string("\1\xff\xff\xff\xff", 5), std::string()})
        EXPECT_THROW((void)crate_unpacked(bad, 100), CrateFault);
}

TEST(usd, layers_of_other_programs) {
    const TempDir dir;
    save(dir / "m.usda",
         "#usda 1.0\n(\n    doc = \"\"\"lines ) of\ntext\"\"\"\n    subLayers = [@a)b.usda@]\n)\n"
         "# a comment {\n"
         "over \"Ignored\" { " +
             two() +
             "}\n"
             "class ParticleField3DGaussianSplat \"Class\" {\n" +
             two() +
             "}\n"
             "def Xform \"World\" (\n    kind = 'group'\n    customData = { string a = \"}\" "
             "}\n)\n{\n"
             "    rel proxyPrim = </World/S>\n"
             "    uniform token[] xformOpOrder = []\n"
             "    double3 xformOp:translate = (1, 2, 3)\n"
             "    variantSet \"look\" = { \"a\" { float x = 1 } \"b\" (doc = \"}\") { } }\n"
             "    def ParticleField3DGaussianSplat \"Off\" ( active = false ) {\n" +
             two() +
             "    }\n"
             "    def ParticleField3DGaussianSplat \"Half\" (prepend apiSchemas = [\"X\"])\n    {\n"
             "        custom float unknown ( doc = \"no value\" )\n"
             "        point3h[] positionsh = [(7, 8, 9),]\n"
             "        quath[] orientationsh = [(1, 0, 0, 0)]; half3[] scalesh = [(1, 1, 2)]\n"
             "        half[] opacitiesh = [0.5] ( interpolation = \"vertex\" )\n"
             "        half[] opacitiesh.connect = </World/S.a>\n"
             "        float[] unknown.timeSamples = { 0: [1, 2], 1: [3] }\n    }\n"
             "    def ParticleField3DGaussianSplat \"S\" {\n        point3h[] positionsh = [(0, 0, "
             "0)]\n" +
             two() + "        point3h[] positionsh = [(0, 0, 0)]\n    }\n}\n");
    const Gaussians read = read_model(dir / "m.usda");
    ASSERT_EQ(read.size(), 3u);
    EXPECT_EQ(read.mean[0], (Vec3f{7, 8, 9}));
    EXPECT_EQ(read.scale[0], (Vec3f{1, 1, 2}));
    EXPECT_EQ(read.mean[2], (Vec3f{-4, 0.5f, 6.5f}));
    EXPECT_EQ(read.rotation[2].x, 1);
}

TEST(usd, text_that_is_no_plain_splats_is_refused) {
    const auto without = [](const std::string& line) {
        std::string text = two();
        const std::size_t at = text.find(line);
        return prim(text.erase(at, text.find('\n', at) + 1 - at));
    };
    const std::vector<std::pair<std::string, const char*>> bad{
        {"", "no splats"},
        {"def Xform \"S\" {\n" + two() + "}\n", "no splats"},
        {prim(kTwo), "m.usda"},
        {without("quatf"), "0 orientations of 2 splats"},
        {without("point3f"), "0 positions of 0 splats"},
        {prim(two() + "float[] opacities.timeSamples = { 0: [1] }\n"), "/S: opacities at several"},
        {prim(two() + "uniform token[] xformOpOrder = [\"xformOp:scale\"]\n"), "/S is moved"},
        {"def Xform \"A\" {\n uniform token[] xformOpOrder = [\"a\"]\n" + prim(two()) + "}\n",
         "/A is moved"},
        {prim(two() + "float[] opacities = [0.5, 1.5]\n"), "opacity 1.5 of splat 1"},
        {prim("float[] opacities = [0.5, 1e99]\n"), "line 4: a number beyond floats"},
        {prim("float[] opacities = [0.5 0.5]\n"), "line 4: expected ',' or ']'"},
        {prim("point3f[] positions = [(1, 2)]\n"), "line 4: ')', expected ','"},
        {prim("point3f[] positions = [(1, 2, x)]\n"), "expected a number"},
        {"def Xform {\n}\n", "line 2: expected the name"},
        {"?", "no splats"},
        {")", "line 2: ')'"},
        {"def \"A\" \"B\" {}\n", "expected '{'"},
        {"def \"A", "truncated in a string"},
        {"def \"A\" ( doc = ", "truncated in metadata"},
        {"def \"A\" { a = [1,", "truncated in a value"},
        {"def \"A\" { a = @b", "truncated, expected '@'"},
        {"def \"A\" { a = 3 \n", "truncated, expected '}'"}};
    for (const auto& [text, word] : bad) {
        const std::string message = text_refusal(text);
        EXPECT_NE(message.find(word), std::string::npos) << text << "\n" << message;
        EXPECT_NE(message.find("m.usda"), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    std::string deep;
    for (int n = 0; n < 65; ++n) deep += "def \"A\" {\n";
    EXPECT_NE(text_refusal(deep).find("below 64 others"), std::string::npos);
}

TEST(usd, files_cut_anywhere_are_refused) {
    const TempDir dir;
    const Splats splats = some_splats(2);
    for (const char* name : {"m.usda", "m.usdc"}) {
        write_splats(dir / name, splats);
        const std::string bytes = whole(dir / name);
        const std::string cut = std::string("cut") + name;
        // Text ends with a bracket and a newline, which may be missing.
        for (std::size_t size = 0; size + 2 <= bytes.size(); size += 5) {
            save(dir / cut, bytes.substr(0, size));
            const std::string message = refusal([&] { read_model(dir / cut); });
            ASSERT_NE(message.find(cut), std::string::npos) << size << message;
        }
    }
}

TEST(usd, every_changed_byte_of_a_crate_is_refused_or_read) {
    const TempDir dir;
    write_splats(dir / "m.usdc", some_splats(2));
    const std::string bytes = whole(dir / "m.usdc");
    std::size_t refused = 0;
    constexpr int kChanges[] = {1, 0x80, 0xff};
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string other = bytes;
        other[at] = static_cast<char>(other[at] ^ kChanges[at % 3]);
        save(dir / "other.usdc", other);
        try {
            validate(read_model(dir / "other.usdc"));
        } catch (const Error& error) {
            ++refused;
            ASSERT_NE(std::string(error.what()).find("other.usdc"), std::string::npos)
                << error.what();
        }
    }
    EXPECT_GT(refused, bytes.size() / 3);  // numbers of splats may change
}

TEST(usd, other_crates_are_refused) {
    const TempDir dir;
    write_splats(dir / "m.usdc", some_splats(2));
    const std::string bytes = whole(dir / "m.usdc");
    const auto changed = [&](std::size_t at, const std::string& by) {
        save(dir / "bad.usdc", std::string(bytes).replace(at, by.size(), by));
        return refusal([&] { read_model(dir / "bad.usdc"); });
    };
    EXPECT_NE(changed(0, "PXR-USDX").find("not a layer of OpenUSD"), std::string::npos);
    EXPECT_NE(changed(8, std::string("\0\6", 2)).find("version 0.6.0"), std::string::npos);
    EXPECT_NE(changed(8, std::string("\0\x20", 2)).find("version 0.32.0"), std::string::npos);
    EXPECT_NE(changed(kTableAt, std::string(7, '\x70')).find("no table"), std::string::npos);
    const std::size_t specs = bytes.rfind("SPECS");
    EXPECT_NE(changed(specs, "XPECS").find("no section SPECS"), std::string::npos);
    const std::size_t type = bytes.find("ParticleField3DGaussianSplat");
    EXPECT_NE(changed(type, "Q").find("no splats"), std::string::npos);
}

}  // namespace vog::test
