// evaluate_values_test.cpp: pictures by value of conversions and of finished models, in every file of an evaluation.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/values/value_functions.h"
#include "evaluate/evaluation_json.h"
#include "support/command.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/evaluate.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

/// Values from 0.002 to 1 about the middle of 32^3 voxels.
Volume bell() {
    Volume volume;
    volume.name = "density";
    volume.source = "bell.vdb";
    for (int l = 0; l < 64; ++l) {
        Leaf& leaf = volume.leaves.emplace_back();
        leaf.origin = {8 * (l >> 4), 8 * (l >> 2 & 3), 8 * (l & 3)};
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Vec3d from_middle{leaf.origin.x + (n >> 6) - 15.5,
                                    leaf.origin.y + (n >> 3 & 7) - 15.5,
                                    leaf.origin.z + (n & 7) - 15.5};
            leaf.set(n, static_cast<float>(std::exp(-dot(from_middle, from_middle) / 120)));
        }
    }
    return volume;
}

}  // namespace

class evaluate_values : public CommandLine {};

TEST_F(evaluate_values, of_finer_cells_are_nearer_in_every_file) {
    const VolumeSet volumes{{{bell()}, {}}, Overlap::add};
    EvaluateOptions options;
    options.width = options.height = 32;
    options.repeats = 1;
    options.by_value = true;
    options.value_functions = {"hot"};
    options.conversions.clear();
    for (const int block : {2, 8}) {
        MomentOptions moments;
        moments.block_voxels = block;
        options.conversions.push_back(model_row("cells" + std::to_string(block) + ".ply",
                                                convert_moments(volumes.volumes[0], moments)));
    }
    const Evaluation evaluation = evaluate(volumes, dir_ / "out", options);
    EXPECT_EQ(evaluation.functions, (std::vector<std::string>{"ramp", "bands", "step", "hot"}));
    for (std::size_t f = 0; f < 4; ++f) {
        const Spread fine = spread(evaluation.rows[0], f, &ValueResult::psnr_rgb_db);
        const Spread coarse = spread(evaluation.rows[1], f, &ValueResult::psnr_rgb_db);
        // Of a smooth bell, coarse planes have its opaque step as well as fine ones.
        if (f != 2) {
            EXPECT_GT(fine.mean, coarse.mean + 2) << f;
        }
        EXPECT_GT(fine.worst, 20) << f;
        EXPECT_LE(fine.worst, fine.mean) << f;
        EXPECT_GT(spread(evaluation.rows[0], f, &ValueResult::ssim).worst,
                  spread(evaluation.rows[1], f, &ValueResult::ssim).worst)
            << f;
    }
    const auto json = nlohmann::json::parse(read_text(dir_ / "out/results.json"));
    EXPECT_EQ(json["rows"][1]["volume"]["step"]["views"][6]["view"], "-z");
    EXPECT_EQ(json["rows"][0]["label"], "moments");
    for (const char* column : {"bands psnr_rgb_db_worst", "step ssim_mean"})
        EXPECT_NE(read_text(dir_ / "out/results.csv").find(column), std::string::npos) << column;
    const Evaluation back = evaluation::read_results(dir_ / "out/results.json");
    EXPECT_EQ(back.rows[1].values[2][6].psnr_rgb_db, evaluation.rows[1].values[2][6].psnr_rgb_db);

    // Functions of another run are other settings; names are distinct and show something.
    options.resume = true;
    options.value_functions = {};
    EXPECT_THROW((void)evaluate(volumes, dir_ / "out", options), Error);
    options.resume = false;
    options.value_functions = {"hot", "hot"};
    EXPECT_THROW((void)evaluate(volumes, dir_ / "out", options), Error);
}

TEST_F(evaluate_values, scale_with_a_percentile) {
    Volume volume;
    Leaf& leaf = volume.leaves.emplace_back();
    for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, 1);
    volume.tiles.push_back({{8, 0, 0}, 8, 2});
    volume.tiles.push_back({{128, 0, 0}, 128, 3});
    // The tile of 128^3 voxels has 99.95 % of them.
    const auto range = [&] {
        VoxelField own = measure_field(volume);
        return comparison::value_range({&volume, 1}, {&own, 1});
    };
    leaf.set(0, 100);
    EXPECT_NEAR(range().upper, 3, 100.0 / 65536);
    EXPECT_EQ(range().lower, 0);
    // Signed values have a lower end too.
    volume.tiles[1].value = -3;
    EXPECT_NEAR(range().lower, -3, 103.0 / 65536);
    EXPECT_NEAR(range().upper, -3, 2 * 103.0 / 65536);
    leaf.set(0, -500);
    EXPECT_NEAR(range().lower, -3, 503.0 / 65536);
}

/// A field other than the measure has its own percentiles.
TEST_F(evaluate_values, of_a_field_scale_with_two_percentiles) {
    Volume volume;
    Leaf& leaf = volume.leaves.emplace_back();
    VoxelField field;
    VoxelValues& values = field.component.emplace_back();
    auto& of_leaf = values.leaf.emplace_back();
    for (int n = 0; n < kLeafVoxels; ++n)
        leaf.set(n, 1), of_leaf[static_cast<std::size_t>(n)] = 200;
    volume.tiles.push_back({{128, 0, 0}, 128, 3});
    values.tile.push_back(1000);
    of_leaf[0] = 5000;
    field.lower = 200, field.upper = 5000;
    const comparison::ValueRange range = comparison::value_range({&volume, 1}, {&field, 1});
    EXPECT_NEAR(range.lower, 1000, 4800.0 / 65536);
    EXPECT_NEAR(range.upper, 1000, 4800.0 / 65536);
    const auto functions = comparison::value_functions({200, 1000}, 12);
    EXPECT_EQ(functions[0].color.front().value, 200);
    EXPECT_EQ(functions[1].color.back().value, 1000);
    EXPECT_EQ(most_opacity(functions[2], 200, 439), 0);
    EXPECT_EQ(most_opacity(functions[2], 441, 1000), kMostOpacity);
}

TEST_F(evaluate_values, by_the_command_with_models_beside_volumes) {
    write_vdb(dir_ / "cloud.vdb", bell());
    must("convert cloud.vdb -o block8.ply --block 8 --no-fields");
    std::filesystem::create_directory(dir_ / "other");
    std::filesystem::copy(dir_ / "block8.ply", dir_ / "other/block8.ply");
    write(
        "tf.json",
        R"({"domain": [0, 1], "unit_distance": 1, "colors": "hot", "opacity": [[0, 0], [1, 0.5]]})");
    const auto report = nlohmann::json::parse(
        must("evaluate cloud.vdb block8.ply other/block8.ply -o out --size 16 --repeat 1 --show "
             "volume --tf tf.json --tf jet --json")
            .out);
    ASSERT_EQ(report["rows"].size(), 2u);
    EXPECT_EQ(report["rows"][1]["step"], "block8.ply-2");
    EXPECT_EQ(report["settings"]["functions"][3], "tf.json");
    EXPECT_EQ(report["rows"][0]["volume"]["jet"], report["rows"][1]["volume"]["jet"]);
    EXPECT_NE(must("evaluate cloud.vdb block8.ply -o out --size 16 --repeat 1 --show volume")
                  .out.find("SSIM"),
              std::string::npos);
    must_fail(2, "evaluate cloud.vdb -o out --tf jet --tf hot", "only --show volume takes several");
    must_fail(2, "evaluate cloud.vdb -o out --show mean", "--show");
    must_fail(1, "evaluate block8.ply -o out", "needs a volume");
    must_fail(1, "evaluate cloud.vdb block8.ply -o out --show volume --tf none.json", "none.json");
}

}  // namespace vog::test
