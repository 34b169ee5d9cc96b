// evaluate_fields_test.cpp: errors of the maps of fields beside T's, in every file, and their resumption.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "evaluate/evaluation_json.h"
#include "support/command.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/evaluate.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

/// A scalar field that is a plane, and a vector field, at the voxels of volumes.
std::vector<std::vector<VoxelField>> fields_at(std::vector<Volume>& volumes) {
    std::vector<std::vector<VoxelField>> all(2);
    for (const Volume& volume : volumes) {
        VoxelField& scalar = all[0].emplace_back();
        scalar.name = "temperature";
        scalar.component.resize(1);
        VoxelField& vector = all[1].emplace_back();
        vector.name = "velocity";
        vector.component.resize(3);
        for (VoxelValues* values : {&scalar.component[0], &vector.component[0],
                                    &vector.component[1], &vector.component[2]}) {
            values->leaf.resize(volume.leaves.size());
            values->tile.resize(volume.tiles.size());
            for (std::size_t leaf = 0; leaf < volume.leaves.size(); ++leaf)
                for (int n = 0; n < kLeafVoxels; ++n)
                    values->leaf[leaf][static_cast<std::size_t>(n)] =
                        static_cast<float>(300 + volume.leaves[leaf].origin.x + (n >> 6));
        }
    }
    return all;
}

EvaluateOptions options_with_fields() {
    EvaluateOptions options;
    options.width = options.height = 24;
    options.repeats = 1;
    options.read_fields = fields_at;
    std::erase_if(options.conversions, [](const Conversion& conversion) {
        return conversion.step != "block4" && conversion.step != "sigma1" &&
               conversion.series + conversion.step != "meanlod3";
    });
    std::erase_if(options.conversions,
                  [](const Conversion& conversion) { return !conversion.budget_series.empty(); });
    return options;
}

}  // namespace

class evaluate_fields : public CommandLine {};

TEST_F(evaluate_fields, rows_of_adaptive_cuts_are_the_models_of_convert_with_fields) {
    VolumeSet data{{{sample_cloud({.size = 64})}, {}}, Overlap::add};
    std::vector<Volume>& volumes = data.volumes;
    EvaluateOptions options = options_with_fields();
    // A front in a field that the density knows nothing of.
    options.read_fields = [](std::vector<Volume>& of) {
        std::vector<std::vector<VoxelField>> fields = fields_at(of);
        fields.pop_back();
        for (auto& leaf : fields[0][0].component[0].leaf)
            for (float& value : leaf) value = value > 310 ? 1000.0f : 0.0f;
        return fields;
    };
    options.conversions = moment_conversions();
    std::erase_if(options.conversions, [](const Conversion& row) { return row.step != "default"; });
    ASSERT_EQ(options.conversions.size(), 1u);
    options.conversions[0].moments = [](std::size_t) { return MomentOptions{.budget = 500}; };
    const EvaluationRow row = evaluate(data, dir_ / "out", options).rows.at(0);
    const auto fields = options.read_fields(volumes);
    const Gaussians model = convert_for_field(volumes[0], fields, {.budget = 500}, {});
    EXPECT_EQ(row.gaussians, model.size());
    EXPECT_EQ(row.options, "--method " + model.method + " " + model.options);
    EvaluateOptions blind = options;
    blind.conversions = {
        model_row("blind", convert_moments(volumes[0], MomentOptions{.budget = 500}))};
    const EvaluationRow other = evaluate(data, dir_ / "blind", blind).rows.at(0);
    EXPECT_LT(row.views[0].fields[0].mean_l2, other.views[0].fields[0].mean_l2);
}

TEST_F(evaluate_fields, has_their_errors_in_every_file) {
    const VolumeSet volumes{{{sample_cloud({.size = 64})}, {}}, Overlap::add};
    EvaluateOptions options = options_with_fields();
    ASSERT_GE(options.conversions.size(), 2u);
    const Evaluation evaluation = evaluate(volumes, dir_ / "out", options);
    EXPECT_EQ(evaluation.fields, (std::vector<std::string>{"temperature", "velocity"}));
    int with_fields = 0;
    for (const EvaluationRow& row : evaluation.rows)
        for (const ViewResult& view : row.views) {
            ASSERT_EQ(view.fields.size(), row.aabb_sigma > 0 ? 0u : 2u);
            for (const FieldResult& field : view.fields) {
                ++with_fields;
                EXPECT_GT(field.mean_l2, 0);
                EXPECT_LT(field.mean_l2, 0.1);  // 300 ± 32
                EXPECT_LT(field.deviation_l2, 0.2);
            }
        }
    EXPECT_GE(with_fields, 14);
    const auto json = nlohmann::json::parse(read_text(dir_ / "out/results.json"));
    EXPECT_EQ(json["settings"]["fields"][1], "velocity");
    EXPECT_TRUE(json.dump().find("\"deviation_l2\":{\"mean\":") != std::string::npos);
    for (const char* column : {"temperature mean_l2_worst", "velocity deviation_l2_mean"})
        EXPECT_NE(read_text(dir_ / "out/results.csv").find(column), std::string::npos) << column;

    // Read back, and kept where the fields are the same.
    const Evaluation back = evaluation::read_results(dir_ / "out/results.json");
    EXPECT_EQ(back.rows.front().views[0].fields[1].mean_l2,
              evaluation.rows.front().views[0].fields[1].mean_l2);
    options.resume = true;
    options.read_fields = {};
    EXPECT_THROW((void)evaluate(volumes, dir_ / "out", options), Error);
}

TEST_F(evaluate_fields, says_what_is_missing) {
    write_vdb(dir_ / "cloud.vdb", sample_cloud({.size = 64}));
    must_fail(1, "evaluate cloud.vdb -o out --field heat", "cloud.vdb: no grid named 'heat'");
    must_fail(2, "evaluate cloud.vdb -o out --field 'a b'", "a b");
}

}  // namespace vog::test
