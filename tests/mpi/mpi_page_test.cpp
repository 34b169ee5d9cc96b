// mpi_page_test.cpp: sites by vog-mpi page: the whole model of vog-mpi convert, its views, its mass in every depth.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "mpi_command.h"
#include "support/model_psnr.h"
#include "vog/ply.h"
#include "vog/site.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Of a sum of thousands of masses, each rounded in steps of 1/40: 0.007 over the root of their number.
constexpr double kSameMass = 1e-3;

/// Integral of a model's scalar field over its mass.
double field_mass(const Gaussians& model, const std::string& name) {
    double sum = 0;
    const ScalarField* field = model.fields.find_scalar(name);
    if (!field) return 0;
    for (std::size_t i = 0; i < model.size(); ++i) sum += mass(model, i) * double{field->value[i]};
    return sum;
}

std::set<std::string> files_in(const fs::path& folder) {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.insert(fs::relative(entry.path(), folder).string());
    return files;
}

}  // namespace

class mpi_page : public Mpi {
  protected:
    Json exported(int count, const std::string& arguments) const {
        return Json::parse(must_mpi(count, "page " + arguments + " --json").out);
    }
    /// Expects a site's whole model, its coarsest chunk and its views to be of a model.
    /// least_db  of V at the default pixel error
    void expect_site(const std::string& site, const Gaussians& model, double least_db = 50) const {
        const Gaussians whole = read_site(dir_ / site);
        EXPECT_EQ(whole.size(), model.size()) << site;
        EXPECT_NEAR(mass(whole), mass(model), kSameMass * mass(model)) << site;
        EXPECT_EQ(whole.fields.names(), model.fields.names()) << site;
        for (const ScalarField& field : model.fields.scalar) {
            EXPECT_NEAR(field_mass(whole, field.name), field_mass(model, field.name),
                        kSameMass * mass(model) * (field.upper - field.lower))
                << site << " " << field.name;
            EXPECT_EQ(whole.fields.find_scalar(field.name)->lower, field.lower) << site;
            EXPECT_EQ(whole.fields.find_scalar(field.name)->upper, field.upper) << site;
        }
        EXPECT_EQ(whole.box, model.box) << site;
        EXPECT_EQ(whole.origin, model.origin) << site;

        const Camera camera = paper_view(view_box(model));
        SiteCut coarsest(dir_ / site), cut(dir_ / site);
        const Gaussians& root = coarsest.choose(frame_of(camera, 64, 64), {1e9, false});
        EXPECT_EQ(coarsest.report().chunks, 1u) << site;
        EXPECT_LE(root.size(), 8192u) << site;
        EXPECT_NEAR(mass(root), mass(model), kSameMass * mass(model)) << site;
        for (const int size : {96, 160}) {
            EXPECT_GT(psnr(model, cut.choose(frame_of(camera, size, size)), camera, size), least_db)
                << site << " " << size;
        }
    }
    /// Expects levels of a manifest to be those of its chunks, all of which are there and nothing else.
    void expect_whole(const std::string& site, const Json& report) const {
        const Json about = Json::parse(must("info " + site + " --json").out)["files"][0]["site"];
        std::uint64_t chunks = 0;
        double error = 1e30;
        for (const Json& level : about["models"][0]["levels"]) {
            chunks += level["chunks"].get<std::uint64_t>();
            EXPECT_LE(level["error"].get<double>(), error) << site;
            error = level["error"];
        }
        EXPECT_EQ(about["models"][0]["levels"][0]["chunks"], 1) << site;
        EXPECT_EQ(report["chunks"], chunks) << site;
        EXPECT_EQ(report["gaussians"], about["models"][0]["gaussians"]) << site;
        std::uint64_t shapes = 0;
        for (const std::string& file : files_in(dir_ / site)) {
            shapes += file.ends_with(".vogz");
            EXPECT_FALSE(fs::path(file).filename().string().starts_with('.')) << file;
        }
        EXPECT_EQ(shapes, chunks) << site;
    }
};

class mpi_page_ranks : public mpi_page, public testing::WithParamInterface<int> {};

TEST_P(mpi_page_ranks, sites_have_the_models_of_convert) {
    must("sample cloud c.vdb --size 128");
    for (const std::string cut : {"--block 2", "--budget 20000"}) {
        must_mpi(GetParam(), "convert c.vdb -o c.ply " + cut);
        const Json report = exported(GetParam(), "c.vdb -o site/ " + cut);
        const Gaussians model = read_ply(dir_ / "c.ply");
        expect_site("site", model);
        expect_whole("site", report);
        // Of the file, whose parts are runs of its Gaussians.
        const Json again = exported(GetParam(), "c.ply -o model/ --view +x");
        expect_site("model", model);
        expect_whole("model", again);
    }
}

INSTANTIATE_TEST_SUITE_P(ranks, mpi_page_ranks, testing::ValuesIn(rank_counts()),
                         testing::PrintToStringParamName());

TEST_F(mpi_page, one_rank_writes_the_bytes_of_one_process) {
    must("sample cloud c.vdb --size 128");
    must("convert c.vdb -o c.ply --block 2 --set soft-steps=0");
    must("page c.ply -o one/ --tf jet --show mean --field density");
    for (const std::string input : {"c.ply", "c.vdb --block 2"}) {
        must_mpi(1, "page " + input + " -o many/ --tf jet --show mean --field density");
        EXPECT_EQ(files_in(dir_ / "one"), files_in(dir_ / "many")) << input;
        for (const std::string file : {"manifest.json", "index.html"})
            EXPECT_TRUE(read_text(dir_ / "one" / file) == read_text(dir_ / "many" / file))
                << input << " " << file;
    }
}

/// Nine ranks join in two rounds.
TEST_F(mpi_page, parts_join_in_rounds_and_may_be_empty) {
    must("sample cloud c.vdb --size 128");
    must_mpi(1, "convert c.vdb -o c.ply --block 1 --no-fields");
    const Json report = exported(9, "c.vdb -o site/ --block 1 --no-fields");
    expect_site("site", read_ply(dir_ / "c.ply"));
    expect_whole("site", report);
    // Two leaves: three ranks have nothing.
    write_vdb(dir_ / "two.vdb", two_leaves());
    must_mpi(1, "convert two.vdb -o two.ply --block 4");
    const Json few = exported(5, "two.vdb -o few/ --block 4");
    EXPECT_EQ(few["chunks"], 1);
    // Sixteen Gaussians, as rounded.
    expect_site("few", read_ply(dir_ / "two.ply"), 45);
}

TEST_F(mpi_page, two_fields_have_one_lattice_on_all_ranks) {
    must("sample cloud c.vdb --size 128");
    must("sample explosion h.vdb --size 128");
    const std::string cut = " --block 2 ";
    must_mpi(3, "convert c.vdb -o c.ply --field heat=h.vdb:density" + cut);
    must_mpi(3, "page c.vdb -o site/ --field heat=h.vdb:density --show mean" + cut);
    expect_site("site", read_ply(dir_ / "c.ply"));
    EXPECT_NE(read_text(dir_ / "site/index.html").find("heat"), std::string::npos);
}

TEST_F(mpi_page, levels_of_a_mesh_and_steps_become_sites) {
    must("sample amr a.vdb --size 64");
    must_mpi(3, "convert a.vdb --grid 'density_L*' -o a.ply --block 2");
    const Json report = exported(3, "a.vdb --grid 'density_L*' -o mesh/ --block 2");
    expect_site("mesh", read_ply(dir_ / "a.ply"));
    expect_whole("mesh", report);
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o step_1.ply --budget 300");
    must("convert c.vdb -o step_2.ply --block 2");
    must_mpi(2, "page 'step_*.ply' -o steps/");
    const Json steps = Json::parse(must("info steps --json").out)["files"][0]["site"];
    EXPECT_EQ(steps["steps"], true);
    ASSERT_EQ(steps["models"].size(), 2u);
    EXPECT_EQ(steps["models"][1]["gaussians"], read_ply(dir_ / "step_2.ply").size());
    must_mpi(2, "page step_1.ply step_2.ply -o two/ --site --name A --name B --no-fields");
    const Json two = Json::parse(must("info two --json").out)["files"][0]["site"];
    EXPECT_EQ(two["steps"], false);
    EXPECT_EQ(two["models"][1]["name"], "B");
    EXPECT_TRUE(read_site(dir_ / "two", 1).fields.empty());
    // A site of several.
    must_mpi(2, "page two/ -o copy/");
    EXPECT_EQ(Json::parse(must("info copy --json").out)["files"][0]["site"]["models"][1]["name"],
              "B");
    must_fail_mpi(1, "-n 2 COMMAND page two/ -o two/", "is an input and would be overwritten");
    // A model in several files.
    must_mpi(2, "convert c.vdb -o split.ply --block 2 --split");
    must_mpi(2, "convert c.vdb -o whole.ply --block 2");
    must_mpi(3, "page split.json -o split/");
    expect_site("split", read_ply(dir_ / "whole.ply"));
}

TEST_F(mpi_page, an_export_again_keeps_chunks_and_removes_old_ones) {
    must("sample cloud c.vdb --size 128");
    const Json first = exported(3, "c.vdb -o site/ --block 2");
    const std::string manifest = read_text(dir_ / "site/manifest.json");
    const Json again = exported(3, "c.vdb -o site/ --block 2 --title Other");
    EXPECT_EQ(again["kept"], first["chunks"]);
    EXPECT_EQ(again["removed"], 0);
    EXPECT_EQ(read_text(dir_ / "site/manifest.json"), manifest);
    // As after an interruption.
    fs::remove(dir_ / "site/manifest.json");
    fs::remove(dir_ / "site/index.html");
    const std::set<std::string> files = files_in(dir_ / "site");
    const auto chunk = std::ranges::find_if(
        files, [](const std::string& file) { return file.ends_with(".vogz"); });
    ASSERT_NE(chunk, files.end());
    fs::remove(dir_ / "site" / *chunk);
    const Json resumed = exported(3, "c.vdb -o site/ --block 2");
    EXPECT_EQ(resumed["kept"].get<int>(), first["chunks"].get<int>() - 1);
    EXPECT_EQ(read_text(dir_ / "site/manifest.json"), manifest);
    const Json coarse = exported(2, "c.vdb -o site/ --block 2 --set rounding=0.1 --no-fields");
    EXPECT_EQ(coarse["kept"], 0);
    EXPECT_GT(coarse["removed"], 0);
    expect_whole("site", coarse);
    must("render site -o after.png --size 16");
}

TEST_F(mpi_page, a_rank_that_fails_leaves_the_earlier_site) {
    must("sample cloud c.vdb --size 128");
    must_mpi(2, "page c.vdb -o site/ --block 4");
    const std::string manifest = read_text(dir_ / "site/manifest.json");
    write("small.sh", "#!/bin/sh\nulimit -f 100\nexec \"$@\"\n");
    const std::string work = "COMMAND page c.vdb -o site/ --block 1";
    must_fail_mpi(1, "-n 2 " + work + " : -n 1 sh small.sh " + work, "cannot write");
    EXPECT_EQ(read_text(dir_ / "site/manifest.json"), manifest);
    for (const std::string& file : files_in(dir_ / "site"))
        EXPECT_FALSE(fs::path(file).filename().string().starts_with('.')) << file;
    must("render site -o after.png --size 32");
    // Chunks of the failed run that are of no use go with the next one.
    EXPECT_GT(exported(2, "c.vdb -o site/ --block 4")["removed"], 0);
    // A name under which one rank has another folder.
    fs::create_directories(dir_ / "other");
    write("there.sh", "#!/bin/sh\nmount --bind other site && exec \"$@\"\n");
    if (std::system("unshare -m true 2>/dev/null") != 0)
        GTEST_SKIP() << "this system lets us mount no folder (root and unshare needed)";
    must_fail_mpi(1, "-n 1 " + work + " : -n 1 unshare -m sh there.sh " + work,
                  "site/: the folder of the first process is not there");
    EXPECT_EQ(read_text(dir_ / "site/manifest.json"), manifest);
}

TEST_F(mpi_page, requests_without_sense_are_refused) {
    must("sample cloud c.vdb --size 64");
    must("sample particles p.xyz --size 8");
    must("convert c.vdb -o c.ply --budget 100");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o c.html", "-o c.html: vog-mpi page writes sites");
    must_fail_mpi(1, "-n 2 COMMAND page p.xyz -o site/", "p.xyz: particles, expected volumes");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o site/ --budget 10",
                  "--budget has no effect with models");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o site/ --field heat --field cold", "--field");
    must_fail_mpi(2, "-n 2 COMMAND page c.vdb -o site/ --block 2 --budget 9", "exclude");
    must_fail_mpi(2, "-n 2 COMMAND page c.vdb -o site/ --refine 1", "--refine");
    must_fail_mpi(2, "-n 2 COMMAND page c.vdb", "-o is missing: vog-mpi page c.vdb -o c/");
    must_fail_mpi(2, "-n 2 COMMAND page c.vdb -o site/ --carry heat",
                  "no option --carry; use --field");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o site/ --set levels=3", "--set levels");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o site/ --scale log", "--scale");
    must_fail_mpi(2, "-n 2 COMMAND page c.ply -o site/ --name A --name B", "--name");
    must_fail_mpi(1, "-n 2 COMMAND page c.ply -o site/ --show mean --field heat", "heat");
    EXPECT_FALSE(fs::exists(dir_ / "site"));
    fs::create_directories(dir_ / "mine");
    write("mine/index.html", "mine");
    must_fail_mpi(1, "-n 2 COMMAND page c.ply -o mine/", "mine");
    EXPECT_EQ(read_text(dir_ / "mine/index.html"), "mine");
    EXPECT_EQ(files_in(dir_ / "mine").size(), 1u);
}

}  // namespace vog::test
