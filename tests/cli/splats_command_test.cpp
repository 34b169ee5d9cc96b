// splats_command_test.cpp: vog export to splats: white or coloured, upright, in a unit box, and what that prints.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "vog/model_io.h"
#include "vog/ply.h"

namespace vog::test {

class splats_command : public CommandLine {
  protected:
    /// Two balls of other values, the second above the first along z.
    void write_model(bool with_field) const {
        Gaussians model;
        for (const float z : {10.0f, 30.0f}) {
            model.mean.push_back({0, 0, z});
            model.scale.push_back({2, 2, 2});
            model.density.push_back(0.1f);
        }
        model.box = {{-10, -10, 0}, {10, 10, 40}};
        if (with_field)
            model.fields.scalar.push_back(
                {"density", "", 0, 2, true, {}, {0.2f, 1.9f}, {{}, {}}, {0, 0}, {0, 0}});
        write_ply(dir_ / "m.ply", model);
    }
    /// Rows of the 17 properties of a 3DGS PLY.
    std::vector<std::array<float, 17>> rows(const std::string& file) const {
        const std::string bytes = read_text(dir_ / file);
        std::vector<std::array<float, 17>> all(2);
        const std::size_t begin = bytes.find("end_header\n") + 11;
        EXPECT_EQ(bytes.size() - begin, sizeof(float) * 34);
        std::memcpy(all.data(), bytes.data() + begin, sizeof(float) * 34);
        return all;
    }
};

TEST_F(splats_command, default_is_white_upright_and_in_a_unit_box) {
    write_model(true);
    const std::string out = must("export m.ply -o s.ply --as 3dgs --extinction 1 --up z").out;
    EXPECT_NE(
        out.find(
            "\n1 unit is 20 units of the data; the origin lies at 0, 0, 20 in the data. z of the "
            "data is up, -y in this format. Splats are white.\n"),
        std::string::npos)
        << out;
    for (const auto& row : rows("s.ply"))
        for (const int k : {6, 7, 8})
            EXPECT_FLOAT_EQ(row[std::size_t(k)], std::sqrt(std::numbers::pi_v<float>));
    // z of the data is up, which is -y there; the upper ball is half a unit above the centre.
    EXPECT_FLOAT_EQ(rows("s.ply")[1][1], -0.5f);
    EXPECT_FLOAT_EQ(rows("s.ply")[0][1], 0.5f);
    EXPECT_FLOAT_EQ(rows("s.ply")[0][10], std::log(0.1f));
    const Gaussians read = read_model(dir_ / "s.ply");
    EXPECT_EQ(read.mean[1], (Vec3f{0, 0, 30}));
    EXPECT_FLOAT_EQ(read.scale[1].x, 2);
}

TEST_F(splats_command, transfer_functions_colour_fields_and_nothing_else) {
    write_model(true);
    must("export m.ply -o s.ply --as 3dgs --tf ember");
    const auto colored = rows("s.ply");
    EXPECT_NE(colored[0][6], colored[1][6]);
    must("export m.ply -o s.ply --as 3dgs --field density");
    EXPECT_EQ(rows("s.ply"), colored);
    // The opacity of a function weighs the density, and leaves out what it hides.
    std::ofstream(dir_ / "half.json")
        << R"({"colors": "gray", "opacity": [[0, 1], [0.5, 0.5], [1, 0.5]]})";
    const auto opacity_of = [&](const std::string& options, std::size_t n) {
        must("export m.ply -o s.ply --as 3dgs --extinction 0.1" + options);
        return 1 / (1 + std::exp(-double{rows("s.ply")[n][9]}));
    };
    // Thin balls: opacity is nearly proportional to density.
    EXPECT_NEAR(opacity_of(" --tf half.json", 1) / opacity_of("", 1), 0.5, 0.01);
    std::ofstream(dir_ / "upper.json") << R"({"colors": "gray", "opacity": [[0.5, 0], [1, 1]]})";
    EXPECT_NE(must("export m.ply -o s.glb --tf upper.json").out.find("s.glb: 1 splats"),
              std::string::npos);
    std::ofstream(dir_ / "none.json") << R"({"colors": "gray", "opacity": [[0, 0], [1, 0]]})";
    must_fail(1, "export m.ply -o s.glb --tf none.json",
              "none.json makes all values of density transparent");
    write_model(false);
    must("export m.ply -o s.glb");
    must_fail(1, "export m.ply -o s.glb --tf inferno", "leave --tf out for white");
    must_fail(1, "export m.ply -o s.glb --field heat", "(scalar fields: none)");
}

TEST_F(splats_command, units_and_up_of_each_format) {
    write_model(false);
    const std::string out = must("export m.ply -o s.usda --units world").out;
    EXPECT_NE(out.find("\nUnits are the data's. y of the data is up, y in this format. "
                       "Splats are white.\n"),
              std::string::npos)
        << out;
    EXPECT_NE(read_text(dir_ / "s.usda").find("positions = [(0, 0, 10), (0, 0, 30)]"),
              std::string::npos);
    const auto json = nlohmann::json::parse(must("export m.ply -o s.spz --up -x --json").out);
    EXPECT_EQ(json["world_scale"], 20);
    EXPECT_EQ(json["world_center"], (std::vector<double>{0, 0, 20}));
    EXPECT_EQ(json["up"], (std::vector<double>{-1, 0, 0}));
    must("export m.ply -o v.ply --as volprim");
    EXPECT_EQ(read_model(dir_ / "v.ply").mean[1], (Vec3f{0, 0, 30}));
    for (const std::string option : {"--up z", "--tf inferno", "--field density"})
        must_fail(
            2, "export m.ply -o v.ply --as volprim " + option,
            option.substr(0, option.find(' ')) + " has no effect with -o FILE.ply --as volprim");
    must_fail(2, "export m.ply -o v.ply --as volprim --units box",
              "--units has no effect with -o FILE.ply --as volprim");
    must_fail(2, "pack m.ply -o m.vogz --up z", "no option --up here");
    must_fail(2, "export m.ply -o s.ply", "to write a model, use vog convert m.ply -o s.ply");
    for (const std::string output : {"page s.html", "pack s.vogz", "page site/", "render s.png"}) {
        const std::size_t space = output.find(' ');
        must_fail(1, "export m.ply -o " + output.substr(space + 1),
                  "use vog " + output.substr(0, space) + " m.ply -o " + output.substr(space + 1));
    }
    must_fail(1, "page m.ply -o s.glb", "use vog export m.ply -o s.glb");
    must_fail(1, "page m.ply -o s.vogz", "use vog pack m.ply -o s.vogz");
    must_fail(1, "pack m.ply -o s.html", "use vog page m.ply -o s.html");
    must_fail(1, "pack m.ply -o s.ply", "use vog convert m.ply -o s.ply");
    must_fail(1, "convert m.ply -o s.spz", "use vog export m.ply -o s.spz");
    must_fail(1, "export m.ply -o m.usdc", "vog export -o m.usda, then usdcat m.usda -o m.usdc");
}

}  // namespace vog::test
