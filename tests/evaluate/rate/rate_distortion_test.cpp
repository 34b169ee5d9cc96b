// rate_distortion_test.cpp: bytes against error: rows, files, figures at equal error, the command.
#include "vog/rate_distortion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluate/rate/float_codecs.h"
#include "render/reference/reference.h"
#include "support/command.h"
#include "support/refusal.h"
#include "vog/compare.h"
#include "vog/error.h"
#include "vog/evaluate.h"
#include "vog/sample.h"
#include "vog/vogz.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using Json = nlohmann::json;
using evaluation::sz3_codec;
using evaluation::zfp_codec;

RateRow row_of(const std::string& series, std::uint64_t bytes, double psnr, double tolerance) {
    RateRow row;
    row.series = series;
    row.bytes = bytes;
    row.tolerance = tolerance;
    row.psnr_v_db.assign(7, psnr);
    row.psnr_v_db[2] = psnr - 7;
    return row;
}

}  // namespace

class rate_distortion_of : public CommandLine {
  protected:
    static RateDistortionOptions small() {
        RateDistortionOptions options;
        options.width = options.height = 40;
        options.model_sizes = options.tolerances = 2;
        return options;
    }
};

TEST(rate_figures, bytes_between_two_rows_are_geometric_in_decibels) {
    RateDistortion results;
    results.rows = {row_of("ZFP", 1000, 40, 0.1), row_of("ZFP", 16000, 48, 0.01),
                    row_of("vdb", 500, 30, 0), row_of("vdb", 9000, HUGE_VAL, 0)};
    EXPECT_EQ(rate_series(results), (std::vector<std::string>{"ZFP", "vdb"}));
    EXPECT_NEAR(*rate_figure(results.rows[0], RateFigure::v_mean), 39, 1e-12);
    EXPECT_NEAR(*rate_figure(results.rows[0], RateFigure::v_worst), 33, 1e-12);
    EXPECT_NEAR(*rate_figure(results.rows[0], RateFigure::v_paper), 40, 1e-12);
    EXPECT_NEAR(*rate_figure(results.rows[0], RateFigure::v_axes), 40 - 7.0 / 6, 1e-12);
    EXPECT_FALSE(rate_figure(results.rows[0], RateFigure::rgb_mean));
    // Halfway between 1000 and 16000 is their geometric mean; below the first row its bytes; above the last none.
    EXPECT_NEAR(*bytes_at(results, "ZFP", RateFigure::v_paper, 44), 4000, 1e-6);
    EXPECT_NEAR(*bytes_at(results, "ZFP", RateFigure::v_paper, 48), 16000, 1e-6);
    EXPECT_EQ(*bytes_at(results, "ZFP", RateFigure::v_paper, 20), 1000);
    EXPECT_FALSE(bytes_at(results, "ZFP", RateFigure::v_paper, 48.1));
    // Rows without a tolerance are no curve.
    EXPECT_EQ(*bytes_at(results, "vdb", RateFigure::v_paper, 44), 9000);
    EXPECT_FALSE(bytes_at(results, "SZ3", RateFigure::v_paper, 44));
}

TEST_F(rate_distortion_of, rows_are_files_and_more_bytes_err_less) {
    SampleOptions sample;
    sample.size = 64;
    Volume volume = sample_cloud(sample);
    volume.source = "cloud.vdb";
    double last = 0;
    RateDistortionOptions options = small();
    options.value_functions = {"hot"};
    options.progress = [&](double fraction) { last = fraction; };
    const RateDistortion results = rate_distortion(volume, dir_ / "out", options);
    EXPECT_DOUBLE_EQ(last, 1);
    EXPECT_EQ(results.functions, (std::vector<std::string>{"ramp", "bands", "step", "hot"}));
    const std::size_t series = 5 + (zfp_codec() ? 2 : 0) + (sz3_codec() ? 2 : 0);
    EXPECT_EQ(rate_series(results).size(), series);

    double mass_of_codes = 0;
    for (std::size_t n = 0; n < results.rows.size(); ++n) {
        const RateRow& row = results.rows[n];
        SCOPED_TRACE(row.series + ", " + row.step);
        EXPECT_EQ(row.bytes, std::filesystem::file_size(dir_ / "out" / row.file));
        EXPECT_LT(row.side_bytes, row.bytes);
        ASSERT_EQ(row.psnr_v_db.size(), 7u);
        EXPECT_EQ(row.psnr_rgb_db.size(), row.series == "model" ? 0u : 4u);
        EXPECT_LE(*rate_figure(row, RateFigure::v_worst), *rate_figure(row, RateFigure::v_mean));
        if (is_model_series(row.series)) {
            EXPECT_NEAR(row.mass_ratio, 1, 1e-3);
        }
        EXPECT_NEAR(row.mass_ratio, 1, 0.25);
        mass_of_codes = std::max(mass_of_codes, std::abs(row.mass_ratio - 1));
        // Rows of one curve follow each other, coarse ones first.
        if (n == 0 || results.rows[n - 1].series != row.series) continue;
        if (row.tolerance == 0 && row.gaussians == 0) continue;
        EXPECT_GT(row.bytes, results.rows[n - 1].bytes);
        EXPECT_GT(*rate_figure(row, RateFigure::v_mean),
                  *rate_figure(results.rows[n - 1], RateFigure::v_mean) + 1);
        EXPECT_LT(row.voxels.relative_l2, results.rows[n - 1].voxels.relative_l2);
    }
    EXPECT_GT(mass_of_codes, 0);

    // Floats without loss have no error; half floats have one.
    for (const RateRow& row : results.rows) {
        if (row.series != "vdb") continue;
        const bool lossless = row.step.starts_with("float");
        EXPECT_EQ(row.voxels.relative_l2 == 0, lossless);
        EXPECT_EQ(std::isinf(row.voxels.psnr_db), lossless);
        EXPECT_GT(row.voxels.psnr_db, 60);
    }

    // Figures are those of the files: measured again from one of them.
    const auto fp4 = std::ranges::find(results.rows, "Fp4", &RateRow::step);
    ASSERT_NE(fp4, results.rows.end());
    const Volume read = read_nvdb(dir_ / "out" / fp4->file);
    Orbit orbit;
    orbit.distance_radii = 3;
    set_view(orbit, "+y");
    const Camera camera = orbit_view(world_box(volume), orbit);
    const std::vector<VoxelGrid> a{voxel_grid(volume)}, b{voxel_grid(read)};
    DepthImage reference = render_reference(a, camera, 40, 40);
    set_extinction(reference, auto_extinction(reference));
    EXPECT_NEAR(compare(reference, render_reference(b, camera, 40, 40)).grey.psnr_db,
                fp4->psnr_v_db[3], 1e-6);
    EXPECT_STREQ(kValueViews[3], "+y");

    const Json json = Json::parse(read_text(dir_ / "out/rate_distortion.json"));
    EXPECT_EQ(json["rows"].size(), results.rows.size());
    EXPECT_EQ(json["title"], "cloud.vdb density");
    EXPECT_TRUE(json["rows"][4]["voxels"]["psnr_db"].is_null());  // float: no error
    const std::string csv = read_text(dir_ / "out/rate_distortion.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), std::ptrdiff_t(results.rows.size()) + 1);
    EXPECT_TRUE(csv.starts_with("series,step,file,bytes,"));
    const std::string tables = read_text(dir_ / "out/rate_distortion.md");
    EXPECT_NE(tables.find("| model with values |"), std::string::npos);
    EXPECT_EQ(tables.find("SZ3: not in this build") != std::string::npos, sz3_codec() == nullptr);
    for (const char* plot : {"V", "V-worst", "ramp", "bands", "step", "hot", "voxels"}) {
        const std::string svg = read_text(dir_ / "out" / (std::string(plot) + ".svg"));
        EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"")) << plot;
        EXPECT_TRUE(svg.ends_with("</svg>\n")) << plot;
        EXPECT_NE(svg.find("NanoVDB"), std::string::npos) << plot;
    }
}

TEST_F(rate_distortion_of, options_and_volumes_are_checked_first) {
    Volume volume = sample_cloud({64});
    const auto message = [&](const Volume& of, const RateDistortionOptions& options) {
        return refusal([&] { (void)rate_distortion(of, dir_ / "out", options); });
    };
    RateDistortionOptions options = small();
    options.model_sizes = 0;
    EXPECT_NE(message(volume, options).find("0 model sizes"), std::string::npos);
    options = small();
    options.tolerances = 101;
    EXPECT_NE(message(volume, options).find("101 tolerances"), std::string::npos);
    options = small();
    options.extinction = -1;
    EXPECT_NE(message(volume, options).find("extinction -1"), std::string::npos);
    EXPECT_NE(message({}, small()).find("no active voxel"), std::string::npos);
    for (Leaf& leaf : volume.leaves) leaf.value.fill(0);
    volume.tiles.clear();
    EXPECT_NE(message(volume, small()).find("no value above 0"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
}

TEST_F(rate_distortion_of, the_command_writes_tables_and_refuses_in_one_line) {
    must("sample cloud cloud.vdb --size 64");
    const std::string measure = "evaluate cloud.vdb --rate-distortion --size 24 ";
    const Result result = must(measure + "--model-sizes 2 --tolerances 1 --max-loss 0.5 -o out");
    EXPECT_NE(result.out.find("rate_distortion.md"), std::string::npos);
    EXPECT_NE(result.out.find("model with values"), std::string::npos);
    const Json json = Json::parse(read_text(dir_ / "out/rate_distortion.json"));
    EXPECT_EQ(json["max_loss_db"], 0.5);
    EXPECT_EQ(json["width"], 24);

    must("convert cloud.vdb -o model.ply --budget 100");
    must_fail(1, "evaluate model.ply --rate-distortion -o out", "model.ply: holds no volume");
    must_fail(1, "evaluate cloud.vdb model.ply --rate-distortion -o out",
              "model.ply: holds no volume");
    must_fail(1, "evaluate cloud.vdb cloud.vdb --sum --rate-distortion -o out", "2 volumes");
    must_fail(1, measure + "-o cloud.vdb", "cloud.vdb: is a file");
    must_fail(1, measure + "-o /proc/none", "/proc/none/files: cannot create");
    must_fail(1, "evaluate none.vdb --rate-distortion -o out", "none.vdb");
    for (const char* other : {"--voxels", "--resume", "--repeat 2", "--field density", "--show T"})
        must_fail(2, measure + "-o out " + other, "excludes --rate-distortion");
    must_fail(2, "evaluate cloud.vdb --model-sizes 2 -o out", "--model-sizes");
    must_fail(2, measure + "--max-loss 0 -o out", "--max-loss");
}

}  // namespace vog::test
