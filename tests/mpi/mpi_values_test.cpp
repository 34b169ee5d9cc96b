// mpi_values_test.cpp: vog-mpi render of models by value and of their fields gives the pictures of vog render.
#include <nlohmann/json.hpp>

#include "mpi_pictures.h"

namespace vog::test {

class mpi_values : public MpiPictures {};

/// Light of layers is made of logarithms of what passes a slab.
constexpr double kSameLayers = 1e-5;

TEST_P(mpi_values, models_by_value_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("convert e.vdb -o e.ply --block 4 --no-hierarchy");
    // From inside the model: Gaussians around the eye as well.
    EXPECT_LE(
        picture_difference(
            "e.ply --band 0.02,0.1,orange,0.2 --iso 0.4,white --light head --unit-distance 0.1 "
            "--eye 40,30,50 --look-at 24,24,24"),
        kSamePicture);
    EXPECT_LE(picture_difference("e.ply --orthographic --view +x --tf viridis --unit-distance 0.1 "
                                 "--slabs 7 --frame data --clip 0,0,0,40,90,90"),
              kSamePicture);
    EXPECT_LE(picture_difference("e.ply --light studio --tf viridis"), kSamePicture);
    EXPECT_LE(maximum_difference("e.ply"), kSamePicture);
    for (const std::string clip : {"", "--clip -0.2,-0.4,-1,0.3,0.2,1 --clip 1,1,0,-0.1 "}) {
        SCOPED_TRACE(clip);
        const Differences maps = field_difference("e.ply " + clip + "--show mean --field density");
        EXPECT_LE(std::max(maps.column, maps.mean), kSamePicture);
        // One process makes deviations of differences of squares in single precision.
        EXPECT_LE(maps.deviation, 1e-4);
    }
}

TEST_P(mpi_values, layers_of_models_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("sample cloud c.vdb --size 64");
    must("convert e.vdb -o e.ply --block 4 --no-hierarchy");
    must("convert c.vdb -o c.ply --block 8 --no-hierarchy");
    must("export e.vdb --iso 0.4 -o e.stl");
    const std::string layers =
        "e.ply --layer tf=hot,unit-distance=0.1 --layer c.ply,tf=viridis,unit-distance=0.05 ";
    EXPECT_LE(picture_difference(layers), kSameLayers);
    EXPECT_LE(picture_difference(
                  layers + "--light studio --slabs 9 --frame data --clip -0.2,-0.4,-1,0.3,0.4,1"),
              kSameLayers);
    EXPECT_LE(picture_difference(layers + "--layer e.stl,color=white,opacity=0.5 --light head"),
              kSameLayers);
}

TEST_P(mpi_values, slices_of_models_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("convert e.vdb -o e.ply --block 4 --no-hierarchy");
    for (const std::string options :
         {"--plane z", "--plane 1,2,1,0.1 --field density", "--plane x --thickness 0.1",
          "--plane y --thickness 0.1 --field density --clip 1,0,0,0"}) {
        SCOPED_TRACE(options);
        EXPECT_LE(value_difference("e.ply --show slice " + options), kSamePicture);
    }
}

INSTANTIATE_TEST_SUITE_P(ranks, mpi_values, testing::ValuesIn(rank_counts()),
                         testing::PrintToStringParamName());

class mpi_value_inputs : public Mpi {};

/// One Gaussian; the other ranks have none, and take part in choosing the unit distance.
TEST_F(mpi_value_inputs, ranks_without_a_gaussian_choose_the_same_unit_distance) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 32 --no-hierarchy");
    const std::string render = "render c.ply --show volume --set precision=0 --size 70 --json -o ";
    const auto one = nlohmann::json::parse(must(render + "one.png").out);
    const auto many = nlohmann::json::parse(must_mpi(8, render + "many.png").out);
    EXPECT_EQ(one["unit_distance"], many["unit_distance"]);
    EXPECT_EQ(one["notes"], many["notes"]);
    EXPECT_EQ(one["gaussians"], many["gaussians"]);
    EXPECT_NEAR(one["mean_opacity"].get<double>(), many["mean_opacity"].get<double>(), 1e-6);
}

/// Each picture of a sequence is drawn by one rank.
TEST_F(mpi_value_inputs, sequences_by_value_have_the_bytes_of_one_process) {
    must("sample cloud a.vdb --size 64");
    must("sample explosion b.vdb --size 64");
    must("convert a.vdb b.vdb -o models/ --block 8");
    for (const std::string show : {"volume", "mean --field density"}) {
        const std::string render = "render models/a.ply models/b.ply --size 40 --show " + show;
        must(render + " -o one/");
        must_mpi(2, render + " -o many/");
        for (const std::string file : {"a.png", "b.png"}) {
            EXPECT_EQ(read_text(dir_ / ("many/" + file)), read_text(dir_ / ("one/" + file)))
                << show;
            EXPECT_FALSE(read_text(dir_ / ("many/" + file)).empty());
        }
    }
}

TEST_F(mpi_value_inputs, pictures_that_do_not_add_are_refused) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 16");
    must_fail_mpi(2, "-n 2 COMMAND render c.ply -o c.png --show volume --renderer trace",
                  "--renderer trace: --show volume needs all Gaussians of a ray");
    must_fail_mpi(1, "-n 2 COMMAND render c.ply -o c.png --show volume --field heat",
                  "no scalar field 'heat'");
    must_fail_mpi(2, "-n 2 COMMAND render c.ply -o c.png --show volume --layer c.vdb,tf=hot",
                  "--layer: vog-mpi draws layers of models or layers of volumes, not both");
    must_fail_mpi(2, "-n 2 COMMAND render c.ply -o c.png --show volume --layer plane=z,tf=hot",
                  "--layer plane: vog-mpi draws no slices in volumes; use vog render");
}

}  // namespace vog::test
