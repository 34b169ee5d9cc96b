// evaluate_test.cpp: rows, views and files of an evaluation, and its resumption.
#include "vog/evaluate.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "evaluate/evaluation_json.h"
#include "render/reference/reference.h"
#include "support/command.h"
#include "support/data.h"
#include "support/scenes.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/error.h"
#include "vog/sample.h"
#include "vog/volume_io.h"
#include "vog/voxelize.h"

namespace vog::test {

using namespace vog::evaluation;

namespace {

namespace fs = std::filesystem;

/// A ball of 16 voxels: some leaves dense, most partly filled.
Volume ball() {
    Volume volume;
    volume.name = "density";
    volume.source = "ball.vdb";
    for (int z = -16; z < 16; z += 8)
        for (int y = -16; y < 16; y += 8)
            for (int x = -16; x < 16; x += 8) {
                Leaf leaf;
                leaf.origin = {x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n) {
                    const double dx = x + (n >> 6) + 0.5, dy = y + (n >> 3 & 7) + 0.5,
                                 dz = z + (n & 7) + 0.5;
                    const double r = std::sqrt(dx * dx + dy * dy + dz * dz);
                    if (r < 14) leaf.set(n, static_cast<float>(0.1 + (14 - r) / 14));
                }
                if (leaf.active_count()) volume.leaves.push_back(leaf);
            }
    sort_nodes(volume);
    return volume;
}

EvaluateOptions quick() {
    EvaluateOptions options;
    options.width = options.height = 48;
    options.repeats = 1;
    return options;
}

/// Volumes that add up.
VolumeSet added(std::vector<Volume> volumes) { return {{std::move(volumes), {}}, Overlap::add}; }

/// The row of a series and step; null: none.
const EvaluationRow* find_row(const Evaluation& evaluation, const std::string& series,
                              const std::string& step) {
    const auto found = std::ranges::find_if(evaluation.rows, [&](const EvaluationRow& row) {
        return row.series == series && row.step == step;
    });
    return found == evaluation.rows.end() ? nullptr : &*found;
}

int count_of(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size())
        ++count;
    return count;
}

}  // namespace

TEST(evaluate, views_stand_around_the_box_and_one_inside_it) {
    const Box box{{-1, -2, -1}, {1, 2, 1}};
    const std::vector<EvaluationView> views = evaluation_views(box);
    ASSERT_EQ(views.size(), 7u);
    const auto inside = [&](Vec3d p) {
        return std::abs(p.x) < 1 && std::abs(p.y) < 2 && std::abs(p.z) < 1;
    };
    const Camera paper = paper_view(box);
    EXPECT_EQ(views[0].camera.eye, paper.eye);
    for (std::size_t n = 0; n < 6; ++n) {
        EXPECT_NEAR(length(views[n].camera.eye), 3 * box.radius(), 1e-9) << views[n].name;
        EXPECT_FALSE(inside(views[n].camera.eye)) << views[n].name;
    }
    EXPECT_TRUE(inside(views[6].camera.eye));
}

TEST(evaluate, paper_rows_are_five_levels_and_three_extents_of_two_amplitudes) {
    const std::vector<Conversion> conversions = paper_conversions();
    ASSERT_EQ(conversions.size(), 16u);
    const Volume volume = ball();
    // Levels 3 to 5 coarsen the sparse leaves, 1 to 3 the dense ones; amplitudes change no count.
    std::vector<std::size_t> count;
    for (const Conversion& conversion : conversions)
        count.push_back(conversion.convert(volume, 0).size());
    for (std::size_t n = 0; n < 8; ++n) EXPECT_EQ(count[n], count[n + 8]) << conversions[n].step;
    EXPECT_GT(count[0], count[1]);
    EXPECT_GT(count[1], count[2]);
    EXPECT_GT(count[2], count[4]);
    for (std::size_t n = 5; n < 8; ++n) {
        EXPECT_EQ(count[n], count[2]);
        EXPECT_EQ(conversions[n].aabb_sigma, static_cast<double>(n - 4));
    }
}

TEST(evaluate, adaptive_rows_keep_to_the_count_of_the_row_they_are_held_against) {
    const TempDir dir;
    const VolumeSet volumes = added({ball(), ball()});
    EvaluateOptions options = quick();
    options.conversions = moment_conversions();
    std::erase_if(options.conversions,
                  [](const Conversion& c) { return !c.step.starts_with("block"); });
    const Evaluation evaluation = evaluate(volumes, dir / "out", options);
    for (const char* step : {"block2", "block4", "block8", "block16"}) {
        const EvaluationRow* uniform = find_row(evaluation, "uniform", step);
        const EvaluationRow* adaptive = find_row(evaluation, "adaptive", step);
        ASSERT_TRUE(uniform && adaptive) << step;
        EXPECT_LE(adaptive->gaussians, uniform->gaussians) << step;
        EXPECT_GT(adaptive->gaussians, uniform->gaussians / 2) << step;
        EXPECT_NEAR(uniform->mass_ratio, 1, 1e-3) << step;
    }
    // A budget that refers to a missing row.
    options.conversions = {moment_conversions()[4]};
    EXPECT_THROW((void)evaluate(volumes, dir / "none", options), Error);
}

TEST(evaluate, levels_are_one_model_against_the_masked_reference) {
    const TempDir dir;
    VolumeSet levels;
    levels.overlap = Overlap::hide;
    levels.volumes = sample_levels({.size = 64});
    const Composite data = composite(levels);
    EvaluateOptions options = quick();
    options.conversions = moment_conversions();
    std::erase_if(options.conversions, [](const Conversion& c) { return c.step != "block4"; });
    options.voxels = true;
    const Evaluation evaluation = evaluate(levels, dir / "out", options);
    EXPECT_EQ(evaluation.active_voxels, data.voxels);
    // All levels share one budget: separate conversions would give other counts.
    MomentOptions uniform;
    uniform.block_voxels = 4;
    uniform.soft_steps = 0;
    const std::size_t cells = convert_moments(data, uniform).size();
    MomentOptions adaptive;
    adaptive.budget = cells;
    EXPECT_EQ(find_row(evaluation, "uniform", "block4")->gaussians, cells);
    EXPECT_EQ(find_row(evaluation, "adaptive", "block4")->gaussians,
              convert_moments(data, adaptive).size());
    // The extinction is the reference's, in which every piece of a ray belongs to one level.
    const EvaluationView& paper = evaluation.views.front();
    const DepthImage depth =
        render_reference(level_grids(levels), paper.camera, options.width, options.height);
    EXPECT_EQ(paper.extinction, auto_extinction(depth));
    for (const EvaluationRow& row : evaluation.rows) {
        EXPECT_NEAR(row.mass_ratio, 1, 1e-3) << row.series;
        // In the visible voxels of all levels.
        ASSERT_TRUE(row.voxels.has_value()) << row.series;
        EXPECT_EQ(row.voxels->relative_l2,
                  voxel_error(data.parts,
                              convert_moments(data, row.series == "uniform" ? uniform : adaptive))
                      .relative_l2)
            << row.series;
        EXPECT_GT(row.views.front().psnr_v_db, 25) << row.series;
    }
    // Masks without an active voxel inside are an error.
    levels.masks.resize(levels.volumes.size());
    for (std::size_t n = 0; n < levels.masks.size(); ++n)
        levels.masks[n].world_from_index = levels.volumes[n].world_from_index;
    EXPECT_THROW((void)evaluate(levels, dir / "none", options), Error);
}

TEST(evaluate, results_hold_every_row_and_view_and_have_pictures) {
    const TempDir dir;
    const VolumeSet volumes = added({ball()});
    const Evaluation evaluation = evaluate(volumes, dir / "out", quick());
    ASSERT_EQ(evaluation.rows.size(), all_conversions().size());
    for (const EvaluationRow& row : evaluation.rows) {
        ASSERT_EQ(row.views.size(), 7u) << row.step;
        for (const ViewResult& view : row.views) {
            EXPECT_GT(view.psnr_v_db, 10) << row.series << row.step << view.view;
            EXPECT_GT(view.render.median_ms, 0);
        }
    }
    // Amplitude `mass` conserves the mass; the paper's `mean` loses some.
    EXPECT_NEAR(find_row(evaluation, "mass", "lod1")->mass_ratio, 1, 1e-4);
    EXPECT_LT(find_row(evaluation, "mean", "lod1")->mass_ratio, 0.8);
    EXPECT_NEAR(find_row(evaluation, "mass", "lod1")->views.front().bias, 1, 0.02);

    const auto json = nlohmann::json::parse(read_text(dir / "out/results.json"));
    EXPECT_EQ(json.at("rows").size(), evaluation.rows.size());
    EXPECT_EQ(json.at("views").size(), 7u);
    EXPECT_EQ(json.at("data").at("active_voxels").get<std::uint64_t>(),
              active_voxels(volumes.volumes[0]));

    for (const EvaluationRow& row : evaluation.rows)
        for (const char* picture : {"paper", "paper-difference", "inside", "inside-difference"})
            EXPECT_TRUE(fs::exists(dir / "out/pictures" /
                                   fmt::format("{}-{}-{}.png", row.series, row.step, picture)));
    EXPECT_TRUE(fs::exists(dir / "out/pictures/reference-inside.png"));
    const std::string table = read_text(dir / "out/results.csv");
    EXPECT_EQ(count_of(table, "\n"), static_cast<int>(evaluation.rows.size()) + 1);
    EXPECT_EQ(table.find("\"series\",\"step\",\"label\""), 0u);
    EXPECT_EQ(count_of(table, ",\"psnr_v_db_worst\","), 1);
    const EvaluationRow& last = evaluation.rows.back();
    EXPECT_EQ(
        count_of(table, fmt::format(",{},", spread(last, &ViewResult::psnr_v_db, true).worst)), 1);
}

TEST(evaluate, results_survive_the_file) {
    const TempDir dir;
    const VolumeSet volumes = added({ball()});
    EvaluateOptions options = quick();
    options.conversions.resize(2);
    Evaluation evaluation = evaluate(volumes, dir / "out", options);
    evaluation.rows[0].views[0].psnr_v_db = HUGE_VAL;  // infinite figures are null in the file
    write_results(dir / "one.json", evaluation);
    const Evaluation read = read_results(dir / "one.json");
    EXPECT_TRUE(std::isinf(read.rows[0].views[0].psnr_v_db));
    write_results(dir / "two.json", read);
    EXPECT_EQ(read_text(dir / "one.json"), read_text(dir / "two.json"));
}

TEST(evaluate, finished_rows_are_kept_when_interrupted_and_not_made_again) {
    const TempDir dir;
    const VolumeSet volumes = added({ball()});
    EvaluateOptions options = quick();
    options.conversions.resize(3);
    // The third conversion fails, as if interrupted.
    const auto third = options.conversions[2].convert;
    options.conversions[2].convert = [](const Volume&, std::size_t) -> Gaussians {
        throw Error("stop");
    };
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
    EXPECT_EQ(read_results(dir / "out/results.json").rows.size(), 2u);

    int made = 0;
    options.conversions[0].convert = options.conversions[1].convert =
        [](const Volume&, std::size_t) -> Gaussians { throw Error("made again"); };
    options.conversions[2].convert = [&](const Volume& volume, std::size_t budget) {
        ++made;
        return third(volume, budget);
    };
    options.resume = true;
    std::vector<double> progress;
    options.progress = [&](double share) { progress.push_back(share); };
    EXPECT_EQ(evaluate(volumes, dir / "out", options).rows.size(), 3u);
    EXPECT_GT(made, 0);
    EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
    EXPECT_NEAR(progress.back(), 1, 1e-12);
}

TEST(evaluate, resuming_other_data_or_settings_throws) {
    const TempDir dir;
    VolumeSet volumes = added({ball()});
    EvaluateOptions options = quick();
    options.conversions.resize(1);
    (void)evaluate(volumes, dir / "out", options);
    options.resume = true;
    options.width = 40;
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
    options = quick();
    options.conversions.resize(1);
    options.resume = true;
    volumes.volumes[0].leaves.pop_back();
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
    std::ofstream(dir / "out/results.json") << "{\"format\": \"other\"}";
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
    std::ofstream(dir / "out/results.json") << "{\"format\": ";
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
}

TEST(evaluate, voxels_of_models_are_compared_on_request) {
    const TempDir dir;
    const VolumeSet volumes = added({ball()});
    EvaluateOptions options = quick();
    std::erase_if(options.conversions, [](const Conversion& c) {
        return !(c.series == "uniform" && (c.step == "block2" || c.step == "block8")) &&
               !(c.series == "mass" && c.step == "sigma3");
    });
    EXPECT_FALSE(evaluate(volumes, dir / "without", options).rows.front().voxels);
    EXPECT_EQ(count_of(read_text(dir / "without/results.json"), "voxels\": {"), 0);
    options.voxels = true;
    const Evaluation evaluation = evaluate(volumes, dir / "out", options);
    ASSERT_EQ(evaluation.rows.size(), 3u);
    const EvaluationRow &boxes = *find_row(evaluation, "mass", "sigma3"),
                        &fine = *find_row(evaluation, "uniform", "block2"),
                        &coarse = *find_row(evaluation, "uniform", "block8");
    EXPECT_FALSE(boxes.voxels);  // boxes are of pictures
    // The figures are those of voxelize on the ball's lattice.
    MomentOptions cells;
    cells.block_voxels = 8;
    cells.soft_steps = 0;
    const Volume voxels =
        voxelize(convert_moments(volumes.volumes[0], cells), volumes.volumes[0].world_from_index)
            .volume;
    const VoxelError expected = voxel_error(volumes.volumes[0], voxels);
    ASSERT_TRUE(coarse.voxels && fine.voxels);
    EXPECT_DOUBLE_EQ(coarse.voxels->relative_l2, expected.relative_l2);
    EXPECT_DOUBLE_EQ(coarse.voxels->worst, expected.worst);
    EXPECT_LT(fine.voxels->relative_l2, 0.5 * coarse.voxels->relative_l2);
    EXPECT_GT(fine.voxels->psnr_db, coarse.voxels->psnr_db + 6);
    EXPECT_LT(fine.voxels->mean, fine.voxels->worst);
    // Files have them, and are read back.
    const Evaluation read = read_results(dir / "out/results.json");
    EXPECT_TRUE(read.voxels);
    EXPECT_DOUBLE_EQ(find_row(read, "uniform", "block8")->voxels->psnr_db, coarse.voxels->psnr_db);
    EXPECT_GT(count_of(read_text(dir / "out/results.csv"),
                       fmt::format(",{},", coarse.voxels->relative_l2)),
              0);
    // Rows without them are not resumed, and parts are refused.
    options.resume = true;
    EXPECT_THROW((void)evaluate(volumes, dir / "without", options), Error);
    EXPECT_THROW((void)evaluate(added({ball(), ball()}), dir / "two", options), Error);
}

TEST(evaluate, nothing_to_evaluate_throws) {
    const TempDir dir;
    const VolumeSet none, empty = added({Volume{}});
    EXPECT_THROW((void)evaluate(none, dir / "out", quick()), Error);
    EXPECT_THROW((void)evaluate(empty, dir / "out", quick()), Error);
    EvaluateOptions options = quick();
    options.repeats = 0;
    const VolumeSet volumes = added({ball()});
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Error);
}

TEST(evaluate, real_data_give_the_figures_of_the_design) {
    // Prototype figures at 512²: mean amplitude LOD 1 30.1 dB, bias 0.68; mass 44.2 dB, bias 1.00.
    VOG_NEEDS_DATA("smoke.vdb");
    const TempDir dir;
    const VolumeSet volumes = added({read_vdb(data_dir() / "smoke.vdb")});
    EvaluateOptions options;
    options.width = options.height = 256;
    options.repeats = 1;
    std::erase_if(options.conversions,
                  [](const Conversion& c) { return c.step != "lod1" || c.series == "adaptive"; });
    const Evaluation evaluation = evaluate(volumes, dir / "out", options);
    const ViewResult* mean = &find_row(evaluation, "mean", "lod1")->views.front();
    const ViewResult* mass = &find_row(evaluation, "mass", "lod1")->views.front();
    EXPECT_NEAR(mean->psnr_v_db, 30.1, 1);
    EXPECT_NEAR(mean->bias, 0.68, 0.02);
    EXPECT_NEAR(mass->psnr_v_db, 44.2, 1);
    EXPECT_NEAR(mass->bias, 1, 0.01);
}

}  // namespace vog::test
