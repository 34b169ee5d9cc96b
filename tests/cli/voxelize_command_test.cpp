// voxelize_command_test.cpp: vog voxelize: files, lattices, fields, round trips and refusals.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/random_volume.h"
#include "vog/ply.h"
#include "vog/volume_io.h"
#include "vog/voxel_field.h"
#include "vog/voxelize.h"

namespace vog::test {

namespace {

using Json = nlohmann::json;

/// Two rotated Gaussians with a scalar and a vector field.
Gaussians model_with_fields() {
    Gaussians model;
    add(model, {0.2f, 0.1f, -0.3f}, {1.1f, 0.6f, 0.8f}, 1.5f, {0.8f, 0.3f, -0.4f, 0.3f});
    add(model, {4, 2, 1}, {0.5f, 0.9f, 0.4f}, 0.5f, {0.8f, -0.3f, 0.1f, 0.3f});
    ScalarField temperature;
    temperature.name = "temperature", temperature.unit = "K";
    temperature.value = {-300, 20}, temperature.gradient = {{40, -20, 10}, {-3, 8, 100}};
    temperature.deviation = {1, 2}, temperature.skewness = {0, 0};
    VectorField velocity;
    velocity.name = "velocity", velocity.unit = "m/s";
    velocity.value = {{1, 2, 3}, {-4, 5, -6}};
    for (auto& gradient : velocity.gradient) gradient.resize(2);
    velocity.covariance.resize(2);
    model.fields.scalar = {temperature};
    model.fields.vector = {velocity};
    return model;
}

class voxelize_command : public CommandLine {
  protected:
    void SetUp() override { write_ply(dir_ / "model.ply", model_with_fields()); }
    /// Smooth skewed volume.
    void write_skewed(const std::string& file) const {
        Volume volume = random_volume(5);
        volume.tiles.clear();
        volume.world_from_index = grid_maps()[5].second;
        write_vdb(dir_ / file, volume);
    }
};

}  // namespace

TEST_F(voxelize_command, writes_mass_and_fields_as_grids) {
    for (const std::string file : {"v.vdb", "v.nvdb"}) {
        SCOPED_TRACE(file);
        const auto report =
            Json::parse(must("voxelize model.ply --voxel-size 0.5 --fields --json -o " + file).out);
        EXPECT_EQ(report["grids"], (Json{"density", "temperature", "velocity"}));
        EXPECT_EQ(report["gaussians"], 2);
        EXPECT_EQ(report["bytes"], std::filesystem::file_size(dir_ / file));
        EXPECT_EQ(grid_names(dir_ / file),
                  (std::vector<std::string>{"density", "temperature", "velocity"}));
        const Gaussians model = model_with_fields();
        VoxelizeOptions options;
        options.fields = true;
        const Voxelized expected = voxelize(model, voxel_lattice(model, 0.5), options);
        Volume volume = read_volume(dir_ / file, {.grid = "density"});
        EXPECT_NEAR(mass(volume) / mass(model), 1, 1e-5);
        EXPECT_EQ(active_voxels(volume), report["voxels"]);
        ASSERT_EQ(volume.leaves.size(), expected.volume.leaves.size());
        EXPECT_EQ(volume.world_from_index, expected.volume.world_from_index);
        for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
            EXPECT_EQ(volume.leaves[n].origin, expected.volume.leaves[n].origin);
            EXPECT_EQ(volume.leaves[n].mask, expected.volume.leaves[n].mask);
            EXPECT_EQ(volume.leaves[n].value, expected.volume.leaves[n].value);
        }
        for (std::size_t f = 0; f < 2; ++f) {
            const VoxelField& written = expected.fields[f];
            const VoxelField read = read_field({dir_ / file, written.name, {}, {}}, volume);
            EXPECT_EQ(read.unit,
                      file == "v.vdb" ? written.unit : "");  // NanoVDB has no place for it
            ASSERT_EQ(read.component.size(), written.component.size());
            for (std::size_t c = 0; c < read.component.size(); ++c)
                for (std::size_t n = 0; n < volume.leaves.size(); ++n)
                    EXPECT_EQ(read.component[c].leaf[n], written.component[c].leaf[n])
                        << written.name << " " << n;
        }
        // A negative field has its sign: it is no density, and reads as a field.
        EXPECT_LT(expected.fields[0].lower, -250);
    }
}

TEST_F(voxelize_command, takes_the_lattice_of_a_volume) {
    write_skewed("skewed.vdb");
    const auto report =
        Json::parse(must("voxelize model.ply --like skewed.vdb -o like.vdb --json").out);
    const Volume like = read_volume(dir_ / "like.vdb"), skewed = read_volume(dir_ / "skewed.vdb");
    EXPECT_EQ(like.world_from_index, skewed.world_from_index);
    EXPECT_NEAR(mass(like) / mass(model_with_fields()), 1, 1e-5);
    const auto within =
        Json::parse(must("voxelize model.ply --like skewed.vdb --within -o in.vdb --json").out);
    EXPECT_LE(within["voxel_mass"], report["voxel_mass"]);
    EXPECT_LE(within["voxels"], report["voxels"]);
    const IndexBox box = active_box(skewed), got = active_box(read_volume(dir_ / "in.vdb"));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(got.lower[axis], box.lower[axis]);
        EXPECT_LE(got.upper[axis], box.upper[axis]);
    }
}

TEST_F(voxelize_command, bytes_are_the_same_for_any_threads_and_memory) {
    must("voxelize model.ply --voxel-size 0.2 --fields -o one.vdb --threads 1");
    must("voxelize model.ply --voxel-size 0.2 --fields -o two.vdb --threads 2");
    must("voxelize model.ply --voxel-size 0.2 --fields -o small.vdb --memory 64M --set scratch=.");
    EXPECT_EQ(read_text(dir_ / "one.vdb"), read_text(dir_ / "two.vdb"));
    EXPECT_EQ(read_text(dir_ / "one.vdb"), read_text(dir_ / "small.vdb"));
}

TEST_F(voxelize_command, a_conversion_and_back_is_near_the_volume) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply --block 2");
    must("voxelize cloud.ply --like cloud.vdb -o back.vdb");
    const Volume cloud = read_volume(dir_ / "cloud.vdb");
    const VoxelError error = voxel_error(cloud, read_volume(dir_ / "back.vdb"));
    EXPECT_LT(error.relative_l2, 0.2);
    EXPECT_GT(error.psnr_db, 25);
    must("convert back.vdb -o again.ply --block 4");
    EXPECT_NEAR(mass(read_ply(dir_ / "again.ply")) / mass(cloud), 1,
                2e-3);  // --set mass-threshold=1e-4, twice
    // Hierarchies have their finest level voxelised: that of the model without one.
    must("convert cloud.vdb -o flat.ply --block 2 --no-hierarchy");
    must("voxelize flat.ply --like cloud.vdb -o flat.vdb");
    EXPECT_NEAR(
        voxel_error(read_volume(dir_ / "flat.vdb"), read_volume(dir_ / "back.vdb")).relative_l2, 0,
        1e-6);
}

TEST_F(voxelize_command, models_add_up) {
    Gaussians one = model_with_fields();
    one.fields = {};
    write_ply(dir_ / "one.ply", one);
    must("voxelize one.ply one.ply --voxel-size 0.5 -o two.vdb");
    EXPECT_NEAR(mass(read_volume(dir_ / "two.vdb")) / mass(one), 2, 2e-5);
}

TEST_F(voxelize_command, refuses_in_one_line) {
    write_skewed("skewed.vdb");
    Gaussians plain = model_with_fields();
    plain.fields = {};
    write_ply(dir_ / "plain.ply", plain);
    write("points.csv", "x,y,z\n1,2,3\n");
    for (const char* size : {"0", "-2", "nan", "inf"})
        must_fail(1, std::string("voxelize model.ply -o v.vdb --voxel-size ") + size,
                  "expected a finite number > 0");
    must_fail(2, "voxelize model.ply -o v.vdb", "choose the voxels: --voxel-size X or --like FILE");
    must_fail(2, "voxelize model.ply -o v.vdb --voxel-size 1 --like skewed.vdb",
              "--voxel-size and --like exclude each other");
    must_fail(2, "voxelize model.ply -o v.vdb --voxel-size 1 --grid density",
              "--grid needs --like");
    must_fail(2, "voxelize model.ply -o v.vdb --voxel-size 1 --within", "--within needs --like");
    must_fail(2, "voxelize model.ply -o v.vdb --voxel-size 1 --name ''", "--name is empty");
    must_fail(2, "voxelize model.ply -o v.nvdb --voxel-size 1 --memory 64M",
              "--memory has no effect with -o FILE.nvdb");
    must_fail(1, "voxelize model.ply -o v.vdb --like skewed.vdb --grid nope",
              "no grid named 'nope'");
    must_fail(1, "voxelize model.ply -o v.vdb --like absent.vdb", "absent.vdb");
    must_fail(1, "voxelize model.ply -o v.vdb --like plain.ply", "not a volume");
    must_fail(1, "voxelize model.ply -o v.png --voxel-size 1",
              "this command writes .vdb, .nvdb; use vog render model.ply -o v.png");
    must_fail(1, "voxelize model.ply -o skewed.vdb --like skewed.vdb", "is also an input");
    must_fail(1, "voxelize skewed.vdb -o v.vdb --voxel-size 1", "not a model");
    must_fail(1, "voxelize points.csv -o v.vdb --voxel-size 1", "not a model");
    must_fail(1, "voxelize plain.ply -o v.vdb --voxel-size 1 --fields", "no field");
    must_fail(1, "voxelize model.ply -o v.vdb --voxel-size 1 --fields --name temperature",
              "has the name of the volume");
    must_fail(1, "voxelize model.ply -o v.vdb --voxel-size 1e-5", "larger voxels");
    must_fail(1, "voxelize model.ply -o v.vdb --voxel-size 1e-12", "a larger voxel size");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "v.vdb"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "v.nvdb"));
}

}  // namespace vog::test
