// mpi_values_test.cpp: vog-mpi render of models by value and of their fields gives the pictures of vog render.
#include <cmath>
#include <nlohmann/json.hpp>

#include "mpi_command.h"
#include "vog/compare_maps.h"

namespace vog::test {

/// Parameter: number of ranks.
class mpi_values : public Mpi, public testing::WithParamInterface<int> {
  protected:
    /// Renders to a file by vog and by the ranks.
    void render_both(const std::string& arguments, const std::string& output) const {
        must("render e.ply --size 150x90 " + arguments + " one" + output);
        must_mpi(GetParam(), "render e.ply --size 150x90 " + arguments + " many" + output);
    }
    /// Largest difference of colours and alpha of pictures over a transparent background.
    double picture_difference(const std::string& arguments) const {
        render_both(arguments + " --show volume --background transparent -o", ".exr");
        const Image one = read_image(dir_ / "one.exr"), many = read_image(dir_ / "many.exr");
        EXPECT_EQ(one.pixel.size(), many.pixel.size());
        double largest = 0, most = 0;
        for (std::size_t n = 0; n < one.pixel.size(); ++n) {
            const Rgba &a = one.pixel[n], &b = many.pixel[n];
            most = std::max(most, double{a.a});
            // Files divide by alpha: colours of faint pixels have the digits of the product alone.
            for (const float d :
                 {a.r * a.a - b.r * b.a, a.g * a.a - b.g * b.a, a.b * a.a - b.b * b.a, a.a - b.a})
                largest = std::max(largest, std::abs(double{d}));
        }
        EXPECT_GT(most, 0.5);
        return largest;
    }
    /// Largest difference of maps, relative to the largest value; they cover the same pixels.
    static double map_difference(const std::vector<float>& one, const std::vector<float>& many) {
        EXPECT_EQ(one.size(), many.size());
        double largest = 0, most = 0;
        for (std::size_t n = 0; n < one.size(); ++n) {
            EXPECT_EQ(std::isnan(one[n]), std::isnan(many[n])) << n;
            if (std::isnan(one[n])) continue;
            most = std::max(most, std::abs(double{one[n]}));
            largest = std::max(largest, std::abs(double{one[n]} - double{many[n]}));
        }
        EXPECT_GT(most, 0);
        return largest / most;
    }
};

/// Sums of single precision in another order.
constexpr double kSamePicture = 1e-6;

TEST_P(mpi_values, models_by_value_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("convert e.vdb -o e.ply --block 4 --no-hierarchy");
    // From inside the model: Gaussians around the eye as well.
    EXPECT_LE(picture_difference(
                  "--band 0.02,0.1,orange,0.2 --iso 0.4,white --light head --unit-distance 0.1 "
                  "--eye 40,30,50 --look-at 24,24,24"),
              kSamePicture);
    EXPECT_LE(
        picture_difference("--orthographic --view +x --tf viridis --unit-distance 0.1 --slabs 7 "
                           "--clip 0,0,0,40,90,90"),
        kSamePicture);
    render_both("--show maximum --values-out", ".npy");
    EXPECT_LE(map_difference(read_map(dir_ / "one.npy").value, read_map(dir_ / "many.npy").value),
              kSamePicture);
    for (const std::string clip : {"", "--clip -0.2,-0.4,-1,0.3,0.2,1 --clip-plane 1,1,0,-0.1 "}) {
        SCOPED_TRACE(clip);
        render_both(clip + "--show mean --field density --values-out", ".exr");
        const FieldMaps one = read_field_maps(dir_ / "one.exr"),
                        many = read_field_maps(dir_ / "many.exr");
        EXPECT_LE(map_difference(one.column, many.column), kSamePicture);
        EXPECT_LE(map_difference(one.mean, many.mean), kSamePicture);
        // One process makes deviations of differences of squares in single precision.
        EXPECT_LE(map_difference(one.deviation, many.deviation), 1e-4);
    }
}

INSTANTIATE_TEST_SUITE_P(ranks, mpi_values, testing::Values(2, 8),
                         testing::PrintToStringParamName());

class mpi_value_inputs : public Mpi {};

/// One Gaussian; the other ranks have none, and take part in choosing the unit distance.
TEST_F(mpi_value_inputs, ranks_without_a_gaussian_choose_the_same_unit_distance) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 32 --no-hierarchy");
    const std::string render = "render c.ply --show volume --size 70 --json -o ";
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
    must_fail_mpi(2, "-n 2 COMMAND render c.vdb -o c.png --show volume",
                  "--show volume: of volumes is of one process");
    must_fail_mpi(2, "-n 2 COMMAND render c.ply -o c.png --show volume --renderer trace",
                  "--renderer trace: --show volume needs all Gaussians of a ray");
    must_fail_mpi(1, "-n 2 COMMAND render c.ply -o c.png --show volume --field heat",
                  "needs a scalar field 'heat'");
}

}  // namespace vog::test
