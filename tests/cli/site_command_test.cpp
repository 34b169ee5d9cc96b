// site_command_test.cpp: sites by the command: export, contents, pictures of views, repeated and refused exports.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"

namespace vog::test {

class site_command : public CommandLine {};

namespace {

using Json = nlohmann::json;

}  // namespace

TEST_F(site_command, a_models_views_are_those_of_the_whole_model) {
    must("sample cloud c.vdb --size 128");
    must("convert c.vdb -o c.ply --block 2 --set soft-steps=0");
    const Json made = Json::parse(must("page c.ply -o site/ --json").out);
    const Json whole = Json::parse(must("info c.ply --json").out)["files"][0]["model"];
    EXPECT_EQ(made["gaussians"], whole["gaussians"]);
    EXPECT_GT(made["chunks"], 1);
    EXPECT_EQ(made["kept"], 0);
    const Json site = Json::parse(must("info site --json").out)["files"][0]["site"];
    EXPECT_EQ(site["models"][0]["gaussians"], whole["gaussians"]);
    EXPECT_EQ(site["models"][0]["levels"][0]["chunks"], 1);
    EXPECT_NE(must("site/").out.find("vog serve site"), std::string::npos);
    // From afar a part of the chunks, near and by value all that is in view.
    for (const std::string view :
         {"--size 64 --extinction 100", "--size 160 --distance 0.8 --extinction 100",
          "--size 96 --orthographic --view +x --extinction 100",
          "--size 96 --show mean --field density --range 0,2",
          "--size 96 --show volume --tf viridis --unit-distance 0.05 --range 0,2"}) {
        const Json a = Json::parse(must("render c.ply -o a.png --json " + view).out);
        const Json b = Json::parse(must("render site -o b.png --json " + view).out);
        EXPECT_LE(b["gaussians"], a["gaussians"]) << view;
        const Json difference = Json::parse(must("compare a.png b.png --json").out);
        EXPECT_GT(difference["psnr_rgb_db"].get<double>(), 38) << view << "\n" << difference;
    }
    const Json far = Json::parse(must("render site -o far.png --size 32 --distance 5 --json").out);
    EXPECT_LT(far["gaussians"].get<int>(), whole["gaussians"].get<int>() / 4);
    const Json maximum =
        Json::parse(must("render site -o m.png --size 32 --show maximum --json").out);
    EXPECT_EQ(maximum["gaussians"], whole["gaussians"]);
    const Json all =
        Json::parse(must("render site -o all.png --size 32 --pixel-error 0 --json").out);
    EXPECT_EQ(all["gaussians"], whole["gaussians"]);
    // Whole models elsewhere.
    must("pack site -o back.vogz");
    must("render site -o turn/ --turntable 2 --size 16");
}

TEST_F(site_command, layers_of_sites_are_read_for_the_view) {
    must("sample cloud c.vdb --size 128");
    must("sample fire f.vdb --size 64");
    must("convert c.vdb -o c.ply --block 2 --set soft-steps=0");
    must("convert f.vdb -o f.ply --budget 300");
    must("page c.ply -o c/");
    must("page f.ply -o f/");
    const std::string cloud = ",tf=viridis,unit-distance=0.05,range=0,2",
                      fire = ",tf=hot,unit-distance=0.1,range=0,2";
    const auto draw = [&](const std::string& input, const std::string& layers,
                          const std::string& output) {
        return Json::parse(must("render " + input + " --show volume " + layers + " -o " + output +
                                " --json --size 96")
                               .out);
    };
    const Json whole = draw("c.ply", "--layer c.ply" + cloud + " --layer f.ply" + fire, "a.png");
    EXPECT_FALSE(whole.contains("site"));
    const std::pair<std::string, std::string> sites[] = {
        {"c", "f.ply"}, {"c", "f"}, {"f.ply", "c"}, {"c.ply", "f"}};
    for (const auto& [first, second] : sites) {
        const auto layer = [&](const std::string& input) {
            return " --layer " + input + (input[0] == 'c' ? cloud : fire);
        };
        const Json made = draw(first, layer(first) + layer(second), "b.png");
        EXPECT_GT(made["site"]["chunks"], 0) << first << " " << second;
        EXPECT_LE(made["gaussians"], whole["gaussians"]);
        const Json difference = Json::parse(must("compare a.png b.png --json").out);
        EXPECT_GT(difference["psnr_rgb_db"].get<double>(), 38) << first << " " << second;
    }
    const Json far = Json::parse(must("render f.ply --show volume --layer c" + cloud +
                                      " -o far.png --size 32 --distance 5 --json")
                                     .out);
    EXPECT_LT(far["gaussians"].get<int>(), whole["gaussians"].get<int>() / 2);
}

TEST_F(site_command, an_export_again_keeps_what_is_there) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 2");
    const Json first = Json::parse(must("page c.ply -o site/ --json").out);
    const std::string manifest = read_text(dir_ / "site/manifest.json");
    const Json again = Json::parse(must("page c.ply -o site/ --json --title Other").out);
    EXPECT_EQ(again["kept"], first["chunks"]);
    EXPECT_EQ(read_text(dir_ / "site/manifest.json"), manifest);
    const Json coarse =
        Json::parse(must("page c.ply -o site --json --set rounding=0.1 --no-fields").out);
    EXPECT_EQ(coarse["kept"], 0);
    EXPECT_GT(coarse["removed"], 0);
    EXPECT_LT(coarse["bytes"], first["bytes"]);
    must("render site -o after.png --size 16");
}

TEST_F(site_command, volumes_particles_and_steps_become_sites) {
    must("sample cloud c.vdb --size 64");
    must("sample explosion e.vdb --size 64");
    must("sample particles p.xyz --size 16");
    must("page c.vdb -o volume/ --memory 500M");
    must("page p.xyz -o particles/");
    must("convert c.vdb -o step_1.ply --budget 300");
    must("convert e.vdb -o step_2.ply --budget 300");
    must("page 'step_*.ply' -o steps/ --site");
    const Json steps = Json::parse(must("info steps --json").out)["files"][0]["site"];
    EXPECT_EQ(steps["steps"], true);
    EXPECT_EQ(steps["models"].size(), 2u);
    must("render steps -o pictures/ --size 16");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "pictures/step_2.png"));
    must("render steps/step_2 -o second.png --size 16 --extinction 3");
    must("render step_2.ply -o whole.png --size 16 --extinction 3");
    EXPECT_GT(Json::parse(must("compare second.png whole.png --json").out)["psnr_rgb_db"], 38);
    EXPECT_NE(must("render steps -o first.png --size 16").error.find("the first of 2 models"),
              std::string::npos);
    must("page steps -o copy/");
    const Json copy = Json::parse(must("info copy --json").out)["files"][0]["site"];
    EXPECT_EQ(copy["steps"], true);
    ASSERT_EQ(copy["models"].size(), 2u);
    EXPECT_EQ(copy["models"][1]["name"], "step_2");
    must_fail(1, "page steps -o steps/", "steps/ is an input and would be overwritten");
    must_fail(1, "page steps/step_2 -o steps", "is an input and would be overwritten");
    must("page steps -o page.html");
    EXPECT_NE(read_text(dir_ / "page.html").find("step_2"), std::string::npos);
    must("convert steps/step_2 -o second.ply");
    EXPECT_EQ(Json::parse(must("info second.ply --json").out)["files"][0]["model"]["gaussians"],
              steps["models"][1]["gaussians"]);
    must_fail(1, "render steps/none -o none.png",
              "steps/none: no model of this name, expected step_1, step_2");
    must("page step_1.ply step_2.ply -o two/ --site --name A --name B");
    EXPECT_EQ(Json::parse(must("info two --json").out)["files"][0]["site"]["models"][1]["name"],
              "B");
    must("page step_1.ply step_2.ply -o pages/");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "pages/step_1.html"));
}

TEST_F(site_command, pages_of_models_elsewhere_hold_no_model) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 2");
    must("page c.ply -o site/");
    must("pack c.ply -o c.vogz --hierarchy --deflate");
    const std::string own = read_text(dir_ / "site/index.html");
    for (const std::string input : {"site", "c.vogz"}) {
        const std::string url = "HTTPS://data.example.org:8443/a/" + input;
        const Json made =
            Json::parse(must("page " + input + " -o page.html --json --from " + url).out);
        const std::string page = read_text(dir_ / "page.html");
        EXPECT_EQ(made["bytes"], page.size());
        EXPECT_EQ(made["from"], input == "site" ? url + "/" : url);
        EXPECT_NE(page.find("connect-src https://data.example.org:8443;"), std::string::npos);
        EXPECT_NE(page.find(made["from"].dump()), std::string::npos);
        EXPECT_LT(page.size(), own.size() + 20000);
        must("page " + input + " -o page.html --from ../a%20folder/" + input +
             " --title Elsewhere --show mean --field density --name Cloud");
        EXPECT_NE(read_text(dir_ / "page.html").find("connect-src 'self';"), std::string::npos);
    }
    std::filesystem::remove(dir_ / "page.html");
    must_fail(2, "page c.ply -o page.html --from https://host/c.ply", "--from needs one input");
    must_fail(2, "page site c.vogz -o page.html --from https://host/", "--from needs one input");
    must_fail(2, "pack c.vogz -o d.vogz --from https://host/c.vogz", "only in vog page");
    must_fail(2, "page c.vogz -o page.html --from https://host/c.vogz --budget 9", "--budget");
    must_fail(2, "page c.vogz -o page.html --from https://host/c.vogz --set rounding=0.1",
              "--set rounding");
    must_fail(1, "page c.vogz -o page.html --from ftp://host/c.vogz", "https or http");
    must_fail(1, "page c.vogz -o page.html --from https://a:b@host/c.vogz", "without a user");
    must_fail(1, "page site -o page.html --from https://host/?a", "with a query");
    must("pack c.ply -o zstd.vogz --hierarchy");
    must_fail(1, "page zstd.vogz -o page.html --from zstd.vogz", "--hierarchy --deflate");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "page.html"));
}

TEST_F(site_command, an_export_that_has_not_ended_is_said) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 2");
    must("page c.ply -o site/");
    std::filesystem::remove(dir_ / "site/manifest.json");
    must_fail(1, "info site", "site: an incomplete site; run vog page again");
    std::filesystem::remove(dir_ / "site/index.html");
    must("page c.ply -o site/");
    must("info site");
}

TEST_F(site_command, requests_without_sense_are_refused) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --budget 100");
    must_fail(2, "page c.ply -o c.html --site", "--site has no effect with -o FILE.html");
    must_fail(2, "page c.ply -o c.html --memory 1G", "--memory");
    must_fail(2, "page c.ply -o site/ --set levels=3", "--set levels");
    must_fail(2, "page c.ply -o site/ --hierarchy", "no option --hierarchy here, only in vog pack");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "site"));
    std::filesystem::create_directories(dir_ / "mine");
    std::ofstream(dir_ / "mine/index.html") << "mine";
    must_fail(1, "page c.ply -o mine/", "mine");
    EXPECT_EQ(read_text(dir_ / "mine/index.html"), "mine");
    must("page c.ply -o site/");
    std::filesystem::remove_all(dir_ / "site/chunks");
    must_fail(1, "render site -o a.png", "no such file");
    std::ofstream(dir_ / "site/manifest.json") << "{";
    must_fail(1, "render site -o a.png", "not JSON");
}

}  // namespace vog::test
