// mpi_render_test.cpp: vog-mpi render gives the pictures of vog render.
#include <nlohmann/json.hpp>

#include "mpi_command.h"
#include "vog/gaussians.h"
#include "vog/ply.h"
#include "vog/volume_io.h"

namespace vog::test {

/// Parameter: number of ranks.
class mpi_render : public Mpi, public testing::WithParamInterface<int> {
  protected:
    /// Renders by vog and by the ranks.
    /// returns  the largest relative difference of T
    double differs(const std::string& arguments) const {
        const std::string common = " --size 96x80 --extinction 1 " + arguments + " --depth-out ";
        must("render" + common + "one.exr");
        must_mpi(GetParam(), "render" + common + "many.exr");
        return difference("one.exr", "many.exr");
    }
};

TEST_P(mpi_render, volumes_are_the_same) {
    must("sample cloud c.vdb --size 64");
    EXPECT_LE(differs("c.vdb"), kSameT);
    EXPECT_LE(differs("c.vdb --interpolation linear --set step=0"), kSameT);
}

TEST_P(mpi_render, levels_that_hide_each_other_are_the_same) {
    must("sample amr a.vdb --size 64");
    EXPECT_LE(differs("a.vdb --grid 'density_L*'"), kSameT);
    EXPECT_LE(differs("a.vdb --grid 'density_L*' --combine sum"), kSameT);
}

TEST_P(mpi_render, models_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("convert e.vdb -o e.ply --block 4 --no-hierarchy");
    must("convert e.vdb -o f.ply --block 8 --set axis-aligned=1 --no-hierarchy");
    EXPECT_LE(differs("e.ply f.ply --eye 10,20,90 --look-at 24,24,24"), kSameT);
    must("page e.ply f.ply -o site/ --site");
    EXPECT_LE(differs("site/f --pixel-error 0 --eye 10,20,90 --look-at 24,24,24"), kSameT);
    // Rays are traced in single precision about the centre of each rank's part, and round the shares of
    // Gaussians near the size of a pixel there.
    constexpr double kTraced = 1e-4;
    EXPECT_LE(differs("e.ply --renderer trace"), kTraced);
}

TEST_P(mpi_render, particles_are_the_same) {
    must("sample particles p.xyz --size 10");
    EXPECT_LE(differs("p.xyz"), kSameT);
    EXPECT_LE(differs("p.xyz --radius 2 --value speed"), kSameT);
    // 1000 particles cover each pixel: a single process's sum in single precision has an error of
    // about their square root times 6e-8.
    EXPECT_LE(differs("p.xyz --radius 300"), 32 * 3 * 6e-8);
}

/// Three pictures, rendered by up to three ranks; of five ranks two have none.
TEST_P(mpi_render, pictures_of_time_steps_are_the_same) {
    must("sample cloud step_2.vdb --size 64");
    must("sample explosion step_9.vdb --size 64");
    must("sample cloud step_10.vdb --size 64 --set seed=3");
    must("convert 'step_*.vdb' -o models/ --block 8");
    for (const std::string inputs : {"'models/*.ply'", "'step_*.vdb'"}) {
        const std::string common = "render " + inputs + " --size 40 --json ";
        const auto one = nlohmann::json::parse(must(common + "-o one/ --depth-out one/").out);
        const auto many =
            nlohmann::json::parse(must_mpi(GetParam(), common + "-o many/ --depth-out many/").out);
        ASSERT_EQ(many["pictures"].size(), 3u);
        for (int n = 0; n < 3; ++n)
            EXPECT_EQ(many["pictures"][n]["extinction"], one["pictures"][n]["extinction"]);
        EXPECT_EQ(many["pictures"][2]["output"], "many/step_10.png");
        for (const std::string file : {"step_2", "step_9", "step_10"})
            for (const std::string kind : {".png", ".exr"}) {
                const std::string picture = read_text(dir_ / ("many/" + file + kind));
                EXPECT_FALSE(picture.empty());
                EXPECT_EQ(picture, read_text(dir_ / ("one/" + file + kind))) << file << kind;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(ranks, mpi_render, testing::ValuesIn(rank_counts()),
                         testing::PrintToStringParamName());

class mpi_inputs : public Mpi {};

TEST_F(mpi_inputs, auto_extinction_and_report_cover_all_parts) {
    must("sample cloud c.vdb --size 64");
    const auto one = nlohmann::json::parse(must("render c.vdb -o one.png --size 64 --json").out);
    const auto many =
        nlohmann::json::parse(must_mpi(3, "render c.vdb -o many.png --size 64 --json").out);
    EXPECT_EQ(one["active_voxels"], many["active_voxels"]);
    EXPECT_NEAR(one["extinction"].get<double>(), many["extinction"].get<double>(),
                kSameT * one["extinction"].get<double>());
    EXPECT_EQ(one["covered"], many["covered"]);
}

/// One leaf cannot be divided: the other parts are empty.
TEST_F(mpi_inputs, ranks_without_a_leaf_have_nothing_to_draw) {
    Volume volume;
    volume.name = "density";
    volume.leaves.resize(1);
    for (int n = 0; n < kLeafVoxels; ++n) volume.leaves[0].set(n, 1.0f + static_cast<float>(n % 7));
    write_vdb(dir_ / "leaf.vdb", volume);
    must("render leaf.vdb --size 32 --extinction 1 --depth-out one.exr");
    must_mpi(4, "render leaf.vdb --size 32 --extinction 1 --depth-out many.exr");
    EXPECT_LE(difference("one.exr", "many.exr"), kSameT);

    Gaussians model;
    model.mean = {{0, 0, 0}};
    model.scale = {{1, 2, 3}};
    model.density = {1};
    model.source = "one";
    write_ply(dir_ / "one.ply", model);
    must("render one.ply --size 32 --extinction 1 --depth-out one.exr");
    must_mpi(4, "render one.ply --size 32 --extinction 1 --depth-out many.exr");
    EXPECT_LE(difference("one.exr", "many.exr"), kSameT);
}

/// With four or more files per rank, files go to ranks whole.
TEST_F(mpi_inputs, many_files_are_divided_by_files) {
    std::string models, volumes;
    for (int n = 0; n < 8; ++n) {
        must(fmt::format("sample cloud v{}.vdb --size 64 --set seed={}", n, n + 1));
        must(fmt::format("convert v{}.vdb -o m{}.ply --block 8 --no-hierarchy", n, n));
        models += fmt::format(" m{}.ply", n);
        volumes += fmt::format(" v{}.vdb", n);
    }
    const std::string common = " --size 48 --extinction 1 --depth-out ";
    must("render" + models + common + "one.exr");
    must_mpi(2, "render" + models + common + "many.exr");
    EXPECT_LE(difference("one.exr", "many.exr"), kSameT);
    must("render --combine sum" + volumes + common + "one.exr");
    must_mpi(2, "render --combine sum" + volumes + common + "many.exr");
    EXPECT_LE(difference("one.exr", "many.exr"), kSameT);
}

}  // namespace vog::test
