// refine_test.cpp: error, count and mass after a given number of EM steps with split-and-merge.
#include <gtest/gtest.h>

#include <vector>

#include "convert/moments/cut/optimal_cut.h"
#include "convert/moments/moment_job.h"
#include "vog/sample.h"

namespace vog {

using namespace moments;
namespace {

TEST(refine, lowers_the_error_at_the_same_count) {
    const Volume volume = sample_cloud({.size = 64});
    MomentOptions options;
    options.budget = 200;
    options.mass_threshold = 0;
    MomentReport report;
    MomentJob job{{&volume, 1}, world_box(volume), false, options, report};
    job.data_mass = mass(volume) / job.unit_volume;
    const std::vector<LatticeField> fields = job.fields();
    const std::vector<CutTree> trees{cut_tree(fields.front())};
    FieldCells cells = best_cut(trees, options.budget);
    FieldEmSolver em(fields, true);
    em.run(cells, 2);
    const ErrorViews views(job.parts, job.box);
    const MeasuredModel before = measured_model(job, fields, views, cells);

    // Sixteen steps a round: one without splits, then eleven with.
    int calls = 0;
    constexpr int kRounds = 12, kCallsPerRound = 17;
    const FieldCells refined =
        refine(job, fields, em, cells, [&] { return calls++ < kRounds * kCallsPerRound; });
    const MeasuredModel after = measured_model(job, fields, views, refined);
    EXPECT_EQ(refined.front().size(), cells.front().size());
    EXPECT_LT(after.error.mean, 0.95 * before.error.mean);
    EXPECT_LE(views.visible_rms(after.model), views.visible_rms(before.model));
    EXPECT_DOUBLE_EQ(report.measured_error, after.error.worst);
    EXPECT_NEAR(mass(after.model) / mass(volume), 1, 1e-5);  // float32 masses
}

TEST(refine, without_time_cells_stay_and_options_are_recorded) {
    const Volume volume = sample_cloud({.size = 64});
    MomentOptions options;
    options.budget = 100;
    options.soft_steps = 2;
    const Gaussians plain = convert_moments(volume, options);
    options.refine_seconds = 1e-9;
    MomentReport report;
    const Gaussians refined = convert_moments(volume, options, &report);
    EXPECT_EQ(refined.mean, plain.mean);
    EXPECT_EQ(refined.scale, plain.scale);
    EXPECT_NE(refined.options.find("--refine 1e-09"), std::string::npos) << refined.options;
    EXPECT_GT(report.measured_error, 0);
}

}  // namespace
}  // namespace vog
