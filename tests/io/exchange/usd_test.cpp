// usd_test.cpp: splats of OpenUSD as text: the numbers that were written, prims that are not drawn, refusals.
#include <gtest/gtest.h>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/exchange.h"
#include "vog/model_io.h"

namespace vog::test {

namespace {

Splats random_splats(int count = 150) {
    return splats_of(random_gaussians(count, 0.02, 0.2, 4), {}, {3, false});
}

/// Message of the reader for a layer's text behind its first line.
std::string text_refusal(const std::string& text) {
    const TempDir dir;
    write_bytes(dir / "m.usda", "#usda 1.0\n" + text);
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

TEST(usd, text_holds_the_numbers_of_the_splats) {
    const TempDir dir;
    const Splats splats = random_splats();
    write_splats(dir / "m.usda", splats);
    write_splats(dir / "m.glb", splats);
    write_bytes(dir / "text.usd", read_bytes(dir / "m.usda"));
    const Gaussians glb = read_model(dir / "m.glb");
    for (const char* name : {"m.usda", "text.usd"}) {
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

TEST(usd, layers_of_other_programs) {
    const TempDir dir;
    write_bytes(
        dir / "m.usda",
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
    write_splats(dir / "m.usda", random_splats(2));
    const std::string bytes = read_bytes(dir / "m.usda");
    // Text ends with a bracket and a newline, which may be missing.
    for (std::size_t size = 0; size + 2 <= bytes.size(); size += 5) {
        write_bytes(dir / "cut.usda", bytes.substr(0, size));
        const std::string message = refusal([&] { read_model(dir / "cut.usda"); });
        ASSERT_NE(message.find("cut.usda"), std::string::npos) << size << message;
    }
}

TEST(usd, binary_layers_are_refused_with_the_line_that_makes_text_of_them) {
    const TempDir dir;
    for (const char* name : {"m.usdc", "m.usd"}) {
        std::string layer = "PXR-USDC";
        layer.resize(90, '\0');
        write_bytes(dir / name, layer);
        const std::string file = (dir / name).string(), text = (dir / "m.usda").string();
        EXPECT_EQ(refusal([&] { read_model(dir / name); }),
                  file + ": OpenUSD's binary layer, expected one of text: usdcat " + file + " -o " +
                      text);
    }
    write_bytes(dir / "m.usd", "PXR-USDX");
    EXPECT_NE(refusal([&] { read_model(dir / "m.usd"); }).find("not a layer of OpenUSD"),
              std::string::npos);
}

}  // namespace vog::test
