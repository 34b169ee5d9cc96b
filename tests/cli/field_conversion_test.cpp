// field_conversion_test.cpp: fields of vog convert: a volume's own values by default, --field, --no-fields.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/random_volume.h"
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
              "--field and --no-fields exclude each other");
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
    must("convert amr.vdb -o m.ply --grid 'density_L*' --mesh --block 4 --no-hierarchy");
    const Gaussians model = read_ply(dir_ / "m.ply");
    ASSERT_EQ(model.fields.names(), std::vector<std::string>{"density"});
    EXPECT_EQ(model.fields.scalar[0].upper, own_field(fine).upper);
    must(
        "convert amr.vdb -o T.ply --grid 'density_L*' --mesh --block 4 --no-hierarchy "
        "--field 'T=density_L*'");
    const Gaussians named = read_ply(dir_ / "T.ply");
    ASSERT_EQ(named.fields.names(), std::vector<std::string>{"T"});
    EXPECT_EQ(named.fields.scalar[0].value, model.fields.scalar[0].value);
}

}  // namespace vog::test
