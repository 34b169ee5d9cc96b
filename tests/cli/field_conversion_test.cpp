// field_conversion_test.cpp: fields of vog convert: a volume's own values by default, --field, --for,
// --no-fields.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "data/fields/field_limits.h"
#include "support/command.h"
#include "support/random_volume.h"
#include "support/voxel_fields.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/lod.h"
#include "vog/ply.h"
#include "vog/volume_io.h"

namespace vog::test {

class field_conversion_command : public CommandLine {
  protected:
    field_conversion_command() { write_vdb(dir_ / "cloud.vdb", small_volume()); }
    static Volume small_volume() {
        Volume volume = random_volume(3);
        volume.tiles.clear();
        return volume;
    }
};

/// The model without fields is that of the library, byte by byte; with them it has the same Gaussians.
TEST_F(field_conversion_command, volumes_carry_their_own_values_unless_they_shall_not) {
    for (const std::string options : {"--block 4", "--budget 50", "--method paper"}) {
        SCOPED_TRACE(options);
        const auto json =
            nlohmann::json::parse(must("convert cloud.vdb -o carried.ply --json " + options).out);
        EXPECT_EQ(json["fields"], nlohmann::json::array({"density"}));
        const auto none = nlohmann::json::parse(
            must("convert cloud.vdb -o plain.ply --json --no-fields " + options).out);
        EXPECT_FALSE(none.contains("fields"));

        Hierarchy hierarchy;
        Gaussians model = read_ply(dir_ / "carried.ply", &hierarchy);
        const Volume volume = read_vdb(dir_ / "cloud.vdb");
        ASSERT_EQ(model.fields.names(), std::vector<std::string>{"density"});
        const VoxelField own = own_field(volume);
        EXPECT_EQ(model.fields.scalar[0].lower, own.lower);
        EXPECT_EQ(model.fields.scalar[0].upper, own.upper);
        EXPECT_EQ(hierarchy.nodes.fields.names(), model.fields.names());
        model.fields = {}, hierarchy.nodes.fields = {};
        write_ply(dir_ / "stripped.ply", model, hierarchy);
        EXPECT_EQ(read_text(dir_ / "stripped.ply"), read_text(dir_ / "plain.ply"));
    }
    MomentOptions options;
    options.block_voxels = 4;
    const Volume volume = read_vdb(dir_ / "cloud.vdb");
    options.origin = model_origin(world_box(volume));
    Gaussians model = convert_moments(volume, options);
    must("convert cloud.vdb -o plain.ply --block 4 --no-fields --no-hierarchy");
    write_ply(dir_ / "library.ply", model);
    EXPECT_EQ(read_text(dir_ / "library.ply"), read_text(dir_ / "plain.ply"));
    const std::vector<std::vector<VoxelField>> fields{{measure_field(volume)}};
    add_fields(model, std::span(&volume, 1), fields);
    must("convert cloud.vdb -o carried.ply --block 4 --no-hierarchy");
    write_ply(dir_ / "library.ply", model);
    EXPECT_EQ(read_text(dir_ / "library.ply"), read_text(dir_ / "carried.ply"));
}

TEST_F(field_conversion_command, fields_come_beside_the_own_values) {
    const auto names = [&](const std::string& options) {
        must("convert cloud.vdb -o m.ply --block 8 --no-hierarchy " + options);
        return read_ply(dir_ / "m.ply").fields.names();
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names("--field T=density"), Names{"T"});  // the own values under another name
    EXPECT_EQ(names("--field density"), Names{"density"});
    Volume heat = small_volume();
    heat.name = "heat";
    write_vdb(dir_ / "heat.vdb", heat);
    EXPECT_EQ(names("--field heat.vdb:heat"), (Names{"heat", "density"}));
    EXPECT_EQ(names("--field density=heat.vdb:heat"), Names{"density"});
    const Gaussians both = [&] {
        must("convert cloud.vdb -o m.ply --block 8 --field heat.vdb:heat");
        return read_ply(dir_ / "m.ply");
    }();
    EXPECT_EQ(both.fields.scalar[0].value, both.fields.scalar[1].value);
    must_fail(2, "convert cloud.vdb -o m.ply --field heat.vdb:heat --no-fields",
              "--no-fields and --field exclude each other");
}

/// --for moves the Gaussians; what T loses is reported, in the file too.
TEST_F(field_conversion_command, adaptive_cuts_follow_the_fields) {
    // Without gaps, which a cut divides before it looks at fields.
    Volume dense = small_volume(), heat = dense;
    for (std::size_t l = 0; l < dense.leaves.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n) {
            dense.leaves[l].set(n, 1 + 0.1F * static_cast<float>(n % 3));
            heat.leaves[l].set(n, n % 8 < 4 ? 1 : 500);
        }
    write_vdb(dir_ / "dense.vdb", dense);
    write_vdb(dir_ / "heat.vdb", heat);
    must(
        "convert dense.vdb -o carried.ply --budget 50 --no-hierarchy --field "
        "heat=heat.vdb:density");
    Volume volume = read_vdb(dir_ / "dense.vdb");
    MomentOptions options;
    options.budget = 50, options.origin = model_origin(world_box(volume));
    std::vector<std::vector<VoxelField>> fields{
        {read_field({dir_ / "heat.vdb", "density", "heat"}, volume)}, {measure_field(volume)}};
    const Gaussians model = convert_for_field(volume, fields, options, {});
    write_ply(dir_ / "library.ply", model);
    EXPECT_EQ(read_text(dir_ / "library.ply"), read_text(dir_ / "carried.ply"));
    EXPECT_NE(model.mean, convert_moments(volume, options).mean);
}

TEST_F(field_conversion_command, for_a_field_fits_the_gaussians_to_it) {
    Volume heat = small_volume();
    heat.name = "heat";
    write_vdb(dir_ / "heat.vdb", heat);
    must("convert cloud.vdb -o plain.ply --block 8 --no-hierarchy");
    for (const std::string chosen : {"volume", "density", "heat"}) {
        SCOPED_TRACE(chosen);
        const auto json = nlohmann::json::parse(
            must("convert cloud.vdb -o fitted.ply --block 8 --no-hierarchy --json --field "
                 "heat.vdb:heat --set joint-steps=1 --for " +
                 chosen)
                .out);
        EXPECT_EQ(json["joint"]["field"], chosen);
        EXPECT_GT(json["joint"]["error_before"], 0.0);
        EXPECT_GT(json["joint"]["error_after"], 0.0);
        const Gaussians plain = read_ply(dir_ / "plain.ply"),
                        fitted = read_ply(dir_ / "fitted.ply");
        EXPECT_NE(plain.mean, fitted.mean);
        EXPECT_NE(fitted.options.find("--for " + chosen), std::string::npos);
        EXPECT_NE(fitted.summary.find("fitted to " + chosen + ": measured error"),
                  std::string::npos);
        EXPECT_NEAR(mass(fitted), mass(read_vdb(dir_ / "cloud.vdb")), 1e-4 * mass(fitted));
    }
    must("convert cloud.vdb -o signed.ply --block 8 --measure volume --for volume");
    EXPECT_EQ(read_ply(dir_ / "signed.ply").fields.names(), std::vector<std::string>{"density"});
    const std::string start = "convert cloud.vdb -o m.ply --block 8 ";
    must_fail(1, start + "--for heat",
              "no field 'heat' to fit the Gaussians to (there are: density)");
    // Refused before the conversion: no stage of it is reported.
    for (const std::string typed : {"--field heat.vdb:heat --for temperature",
                                    "--field heat.vdb:cold", "--field T=heat.vdb:cold --for T"}) {
        SCOPED_TRACE(typed);
        const Result refused = run(start + "--verbose " + typed);
        EXPECT_EQ(refused.exit_code, 1);
        EXPECT_NE(refused.error.find(typed.ends_with("temperature")
                                         ? "no field 'temperature' to fit the Gaussians to (there "
                                           "are: heat, density)"
                                         : "no grid named 'cold'"),
                  std::string::npos)
            << refused.error;
        EXPECT_NE(refused.error.find("load"), std::string::npos) << refused.error;
        EXPECT_EQ(refused.error.find("convert:"), std::string::npos) << refused.error;
        EXPECT_EQ(refused.error.find("octree"), std::string::npos) << refused.error;
    }
    must("convert cloud.vdb -o m.ply --block 8 --set joint-steps=1 --field heat.vdb --for heat");
    EXPECT_EQ(read_ply(dir_ / "m.ply").fields.names(),
              (std::vector<std::string>{"heat", "density"}));
    must(
        "convert cloud.vdb -o m.ply --block 8 --measure volume --set joint-steps=1 --field "
        "hu=density "
        "--for volume");
    EXPECT_EQ(read_ply(dir_ / "m.ply").fields.names(), std::vector<std::string>{"hu"});
    must_fail(2, start + "--for volume --no-fields", "--no-fields and --for exclude each other");
    must_fail(2, "convert cloud.vdb -o m.ply --for volume --method paper",
              "--for has no effect with --method paper");
    must_fail(2, start + "--for volume --set spread=1.2",
              "--set spread and --for exclude each other");
    must_fail(2, start + "--set joint-steps=3", "--set joint-steps needs --for");
    must("sample particles p.csv --size 8");
    must_fail(2, "convert p.csv -o m.ply --for volume", "--for has no effect with particles");
}

/// With --for, --error and --refine are of pictures by value.
TEST_F(field_conversion_command, for_a_field_errors_are_by_value) {
    const auto joint = [&](const std::string& options) {
        const auto json = nlohmann::json::parse(
            must("convert cloud.vdb -o fitted.ply --no-hierarchy --json --for volume " + options)
                .out);
        return json["joint"];
    };
    EXPECT_FALSE(joint("--block 8").contains("value_error"));
    const auto met = joint("--error 0.5");
    EXPECT_LE(met["value_error"], 0.5);
    const Gaussians few = read_ply(dir_ / "fitted.ply");
    EXPECT_NE(few.options.find("--error 0.5"), std::string::npos) << few.options;
    EXPECT_NE(few.summary.find("error by value 0."), std::string::npos) << few.summary;
    // How far depends on the machine's speed; that rounds help is convert_for_field.rounds_lower_the_error_by_value...
    const double refined = joint("--budget 40 --refine 2")["value_error"];
    const double alone = joint("--budget 40 --refine 1e-9")["value_error"];
    EXPECT_LE(refined, 1.05 * alone);
    EXPECT_GT(alone, 0);
    const std::string flags = read_ply(dir_ / "fitted.ply").options;
    EXPECT_NE(flags.find("--refine 1e-09 --for volume"), std::string::npos) << flags;
    const Result missed = run("convert cloud.vdb -o m.ply --for volume --error 1e-6");
    EXPECT_EQ(missed.exit_code, 0);
    EXPECT_NE(missed.error.find("cloud.vdb density: error by value "), std::string::npos);
    EXPECT_NE(missed.error.find("above --error 1e-06: the least of all cuts that were tried"),
              std::string::npos)
        << missed.error;
}

/// Levels have one field: the values of each, under a name that all share.
TEST_F(field_conversion_command, levels_carry_their_own_values) {
    Volume coarse = small_volume(), fine = coarse;
    coarse.name = "density_L0", fine.name = "density_L1";
    for (Leaf& leaf : fine.leaves)
        for (float& value : leaf.value) value *= 3;
    fine.world_from_index = {{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}, {-0.25, -0.25, -0.25}};
    const std::vector<Volume> levels{coarse, fine};
    write_vdb(dir_ / "amr.vdb", levels);
    must("convert amr.vdb -o m.ply --grid 'density_L*' --combine mesh --block 4 --no-hierarchy");
    const Gaussians model = read_ply(dir_ / "m.ply");
    ASSERT_EQ(model.fields.names(), std::vector<std::string>{"density"});
    EXPECT_EQ(model.fields.scalar[0].upper, own_field(fine).upper);
    must(
        "convert amr.vdb -o T.ply --grid 'density_L*' --combine mesh --block 4 --no-hierarchy "
        "--field 'T=density_L*'");
    const Gaussians named = read_ply(dir_ / "T.ply");
    ASSERT_EQ(named.fields.names(), std::vector<std::string>{"T"});
    EXPECT_EQ(named.fields.scalar[0].value, model.fields.scalar[0].value);
}

/// Each step of a series has the fields of its own file.
TEST_F(field_conversion_command, steps_of_a_series_carry_fields) {
    for (int n = 0; n < 2; ++n) {
        Volume density = small_volume(), heat = density;
        heat.name = "heat";
        for (Leaf& leaf : heat.leaves)
            for (float& value : leaf.value) value *= float(n + 2);
        write_vdb(dir_ / ("step_" + std::to_string(n) + ".vdb"), std::vector{density, heat});
    }
    must("convert 'step_*.vdb' -o steps/ --grid density --field heat --block 8 --no-hierarchy");
    const float most = static_cast<float>(own_field(small_volume()).upper);
    for (int n = 0; n < 2; ++n) {
        const Gaussians model = read_ply(dir_ / "steps" / ("step_" + std::to_string(n) + ".ply"));
        ASSERT_EQ(model.fields.names(), (std::vector<std::string>{"heat", "density"}));
        EXPECT_FLOAT_EQ(static_cast<float>(model.fields.scalar[0].upper), most * float(n + 2));
    }
}

/// Signed values are a field over the measure that counts voxels.
TEST_F(field_conversion_command, signed_values_convert_by_volume) {
    const auto grid = make_grid("hu", openvdb::GRID_UNKNOWN);
    fill(*grid, {}, {15, 15, 15}, [](Vec3i i) { return float(100 * i.x) - 1000; });
    set_voxel(*grid, {3, 2, 1}, std::numeric_limits<float>::quiet_NaN());
    write_grids(dir_ / "ct.vdb", {grid});
    must_fail(1, "convert ct.vdb -o ct.ply --skip-nonfinite", "vog convert --measure volume");
    const Result made = must(
        "convert ct.vdb -o ct.ply --measure volume --block 4 --set soft-steps=0 --no-hierarchy");
    EXPECT_NE(made.error.find("1 value not finite, left out, the first at index [3, 2, 1]"),
              std::string::npos)
        << made.error;
    const Gaussians model = read_ply(dir_ / "ct.ply");
    ASSERT_EQ(model.size(), 64u);
    EXPECT_NEAR(mass(model), 16 * 16 * 16 - 1, 1e-3);
    EXPECT_TRUE(model.options.starts_with("--measure volume ")) << model.options;
    ASSERT_EQ(model.fields.names(), std::vector<std::string>{"hu"});
    const ScalarField& hu = model.fields.scalar[0];
    EXPECT_EQ(hu.lower, -1000);
    EXPECT_EQ(hu.upper, 500);
    for (std::size_t i = 0; i < model.size(); ++i) {
        // Values are linear along x, and each voxel is a box: of the positions' variance in a cell, 16/12, the
        // boxes have 1/12, and the plane through constant boxes is 15/16 as steep. One cell lacks a voxel.
        EXPECT_NEAR(hu.value[i], 100 * world_mean(model, i).x - 1000, 0.2);
        // Planes of the outer cells are limited to the range of the data.
        const bool outer = std::abs(hu.value[i] + 250) > 500;
        const double slope = 100.0 * 15 / 16, residual = 100.0 / 16 * std::sqrt(15.0 / 12);
        if (outer) {
            EXPECT_LT(hu.gradient[i].x, 0.6 * slope);
            EXPECT_GT(hu.deviation[i], 10 * residual);
        } else {
            EXPECT_NEAR(hu.gradient[i].x, slope, 0.5);
            EXPECT_NEAR(hu.deviation[i], residual, 0.1);
        }
    }
    must("convert ct.vdb -o ct.ply --measure volume --block 4 --no-fields");
    EXPECT_TRUE(read_ply(dir_ / "ct.ply").fields.empty());
    for (const std::string option : {"--clip-negative", "--level-set-to-fog"})
        must_fail(2, "convert ct.vdb -o m.ply --measure volume " + option,
                  option + " has no effect with --measure volume");
    write("p.csv", "x,y,z\n1,2,3\n2,3,4\n");
    must_fail(2, "convert p.csv -o p.ply --measure volume",
              "--measure has no effect with particles");
}

/// Values of single particles, and the plane through those of a cell.
TEST_F(field_conversion_command, particles_carry_columns_and_velocity) {
    std::string text = "x,y,z,vx,vy,vz,mass,T,wind_x,wind_y,wind_z\n";
    for (int n = 0; n < 64; ++n) {
        const int x = n % 4, y = n / 4 % 4, z = n / 16;
        text += fmt::format("{},{},{},{},{},{},{},{},1,2,{}\n", x, y, z, x, 2 * y, -z, 1 + x,
                            300 + 10 * x + z, n);
    }
    write("p.csv", text);
    const std::string fields = " --value mass --field T --field velocity --field gust=wind";
    must("convert p.csv -o p.ply --no-hierarchy" + fields);
    const Gaussians each = read_ply(dir_ / "p.ply");
    ASSERT_EQ(each.size(), 64u);
    ASSERT_EQ(each.fields.names(), (std::vector<std::string>{"T", "velocity", "gust"}));
    for (std::size_t i = 0; i < each.size(); ++i) {
        const Vec3d at = world_mean(each, i);
        EXPECT_NEAR(each.fields.scalar[0].value[i], 300 + 10 * at.x + at.z, 1e-4);
        EXPECT_EQ(each.fields.scalar[0].deviation[i], 0);
        EXPECT_NEAR(each.fields.vector[0].value[i].y, 2 * at.y, 1e-5);
    }
    EXPECT_EQ(each.fields.vector[1].value[63].z, 63);
    must("convert p.csv -o p.ply --no-hierarchy --method paper" + fields);
    const Gaussians paper = read_ply(dir_ / "p.ply");
    for (std::size_t i = 0; i < paper.size(); ++i)
        EXPECT_NEAR(paper.fields.scalar[0].value[i],
                    300 + 10 * world_mean(paper, i).x + world_mean(paper, i).z, 1e-4);

    // One Gaussian of all: weighted by mass 1 + x, of which x has the mean 2 and the variance 1.
    for (const std::string cut : {" --block 128", " --budget 1"}) {
        must("convert p.csv -o p.ply --no-hierarchy --radius 0.001" + fields + cut);
        const Gaussians one = read_ply(dir_ / "p.ply");
        ASSERT_EQ(one.size(), 1u) << cut;
        const ScalarField& t = one.fields.scalar[0];
        EXPECT_NEAR(t.value[0], 300 + 20 + 1.5, 1e-3);
        // The plane of 10 x + z is limited: it reaches the largest value.
        EXPECT_NEAR(t.gradient[0].z / t.gradient[0].x, 0.1, 1e-4);
        const double variance = plane_variance(one, t, 0);
        EXPECT_NEAR(double{one.cutoff} * std::sqrt(variance), 333 - 321.5, 1e-2);
        EXPECT_NEAR(variance_within(one.cutoff) * variance + t.deviation[0] * t.deviation[0],
                    100 * 1 + 1.25, 0.1);
        EXPECT_EQ(t.lower, 300);
        EXPECT_EQ(t.upper, 333);
        EXPECT_NEAR(one.fields.vector[0].value[0].x, 2, 1e-5);
    }
    must_fail(1, "convert p.csv -o p.ply --field heat", "no value named 'heat' (it has: count");
    must_fail(2, "convert p.csv -o p.ply --field T --field T=mass", "a second field named 'T'");
    must_fail(2, "convert p.csv -o q.csv --field T", "--field has no effect with -o FILE.csv");
}

}  // namespace vog::test
