// labels_test.cpp: vog convert --labels: models in which no Gaussian straddles two labels.
#include <gtest/gtest.h>

#include <cmath>

#include "support/command.h"
#include "support/level_volumes.h"
#include "vog/compare_maps.h"
#include "vog/convert_labels.h"
#include "vog/ply.h"
#include "vog/volume_io.h"
#include "vog/voxelize.h"

namespace vog::test {

namespace {

/// 32^3 voxels, density 1 + z / 32, and labels: 3 in a ball, else 1 left and 2 right of the middle.
Volume gas() {
    Volume volume = cube_of(32, 1, {});
    volume.name = "density";
    for (Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            leaf.set(n, 1 + static_cast<float>(leaf.origin.z + (n & 7)) / 32);
    return volume;
}
int label_at(Vec3i at) {
    const Vec3d from = Vec3d{at.x - 15.5, at.y - 15.5, at.z - 15.5};
    return length(from) < 9 ? 3 : at.x < 16 ? 1 : 2;
}
Volume labels_of(const Volume& volume, float shift = 0) {
    Volume labels = volume;
    labels.name = "segments";
    for (Leaf& leaf : labels.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            leaf.set(n, shift + static_cast<float>(
                                    label_at(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7})));
    return labels;
}

}  // namespace

class labels_command : public CommandLine {
  protected:
    void SetUp() override {
        CommandLine::SetUp();
        const Volume volume = gas();
        write_vdb(dir_ / "gas.vdb", volume);
        write_vdb(dir_ / "seg.vdb", labels_of(volume));
        write_vdb(dir_ / "half.vdb", labels_of(volume, 0.5f));
    }
};

TEST_F(labels_command, divide_the_model) {
    must("convert gas.vdb --labels seg.vdb --block 4 -o m.ply");
    const Gaussians model = read_ply(dir_ / "m.ply");
    const ScalarField* label = model.fields.find_scalar("label");
    ASSERT_NE(label, nullptr);
    double mass_of[4] = {};
    for (std::size_t i = 0; i < model.size(); ++i) {
        const float value = label->value[i];
        ASSERT_TRUE(value == 1 || value == 2 || value == 3) << value;
        EXPECT_NEAR(label->deviation[i], 0, 1e-3);
        mass_of[static_cast<int>(value)] += mass(model, i);
    }
    VoxelField labels;
    labels.name = "segments";
    for (const Leaf& leaf : labels_of(gas()).leaves)
        labels.component.resize(1), labels.component[0].leaf.push_back(leaf.value);
    double voxels[4] = {};
    for (const LabelledVolume& part : divide_by_labels(gas(), labels))
        voxels[part.label] = mass(part.volume);
    for (const int n : {1, 2, 3}) EXPECT_NEAR(mass_of[n] / voxels[n], 1, 1e-3) << n;
}

TEST_F(labels_command, edges_are_as_sharp_as_cells) {
    must("convert gas.vdb --labels seg.vdb --block 2 -o m.ply");
    const Gaussians model = read_ply(dir_ / "m.ply");
    const ScalarField& label = *model.fields.find_scalar("label");
    const Volume whole = gas();
    VoxelizeOptions options;
    options.extent = active_box(whole);
    std::vector<Volume> parts;
    for (const float value : {1.0f, 2.0f, 3.0f}) {
        std::vector<std::size_t> own;
        for (std::size_t i = 0; i < model.size(); ++i)
            if (label.value[i] == value) own.push_back(i);
        parts.push_back(voxelize(select(model, own), {}, options).volume);
    }
    std::vector<std::vector<float>> dense(3, std::vector<float>(32 * 32 * 32));
    for (std::size_t n = 0; n < 3; ++n) copy_dense(parts[n], {}, {32, 32, 32}, dense[n]);
    for (const int wanted : {1, 2, 3}) {
        double both = 0, either = 0;
        for (int x = 0; x < 32; ++x)
            for (int y = 0; y < 32; ++y)
                for (int z = 0; z < 32; ++z) {
                    const auto at = static_cast<std::size_t>((x * 32 + y) * 32 + z);
                    int found = 1;
                    for (const int n : {2, 3})
                        if (dense[static_cast<std::size_t>(n - 1)][at] >
                            dense[static_cast<std::size_t>(found - 1)][at])
                            found = n;
                    both += label_at({x, y, z}) == wanted && found == wanted;
                    either += (label_at({x, y, z}) == wanted) + (found == wanted);
                }
        EXPECT_GT(2 * both / either, 0.95) << wanted;  // Dice
    }
}

TEST_F(labels_command, slices_show_the_densest) {
    write("t.ctbl", "1 left 255 0 0 255\n2 right 0 255 0 255\n3 ball 0 0 255 255\n");
    must("convert gas.vdb --labels seg.vdb --block 2 -o m.ply");
    must(
        "render m.ply --show slice --plane z=16 --field label --tf t.ctbl -o s.png --size 64 "
        "--values-out s.npy");
    const auto map = read_map(dir_ / "s.npy");
    int wrong = 0, seen = 0;
    for (int row = 0; row < map.height; ++row)
        for (int column = 0; column < map.width; ++column) {
            const float value = map.value[static_cast<std::size_t>(row * map.width + column)];
            if (std::isnan(value)) continue;
            EXPECT_EQ(value, std::rint(value));
            const Vec3i at{column / 2, (map.height - 1 - row) / 2, 16};
            ++seen, wrong += value != static_cast<float>(label_at(at));
        }
    EXPECT_GT(seen, 3500);
    EXPECT_LT(wrong, 0.05 * seen);
    must_fail(2, "render m.ply --show maximum --field label --tf t.ctbl -o s.png",
              "--tf: t is a table of labels, and maxima of a model lie between them");
}

TEST_F(labels_command, are_0_beyond_their_grid) {
    Volume part = labels_of(gas());
    std::erase_if(part.leaves, [](const Leaf& leaf) { return leaf.origin.x >= 16; });
    write_vdb(dir_ / "part.vdb", part);
    for (const std::string method : {"--block 4", "--budget 300"}) {
        const std::string said =
            must("convert gas.vdb --labels part.vdb --field density " + method + " -o m.ply").error;
        EXPECT_NE(said.find("grid 'segments': inactive at 50 % of the mass"), said.npos) << said;
        EXPECT_NE(said.find("labels 0 (16,384 voxels), 1 ("), said.npos) << said;
        const Gaussians model = read_ply(dir_ / "m.ply");
        double mass_of_0 = 0;
        for (std::size_t i = 0; i < model.size(); ++i)
            mass_of_0 += model.fields.find_scalar("label")->value[i] == 0 ? mass(model, i) : 0;
        EXPECT_NEAR(mass_of_0 / mass(gas()), 0.5, 1e-3);
    }
}

TEST_F(labels_command, share_a_budget) {
    must("convert gas.vdb --labels seg.vdb --budget 300 -o m.ply");
    const std::size_t count = read_ply(dir_ / "m.ply").size();
    EXPECT_LE(count, 303u);
    EXPECT_GT(count, 150u);
}

TEST_F(labels_command, that_are_none_are_refused_in_one_line) {
    must_fail(1, "convert gas.vdb --labels half.vdb -o m.ply", "expected whole numbers");
    must_fail(1, "convert gas.vdb --labels density -o m.ply", "expected whole numbers");
    must("convert seg.vdb --labels segments --block 8 -o m.ply");
    must_fail(1, "convert gas.vdb --labels nothing -o m.ply", "nothing");
    for (const std::string missing : {"none.nii.gz", "none.vdb:segments"})
        must_fail(1, "convert gas.vdb --labels " + missing + " -o m.ply", "no such file");
    must_fail(2, "convert gas.vdb seg.vdb --combine sum --labels seg.vdb -o m.ply",
              "needs a single volume");
    must_fail(2, "convert gas.vdb --labels seg.vdb --for volume -o m.ply", "--labels");
}

}  // namespace vog::test
