// field_pictures_test.cpp: vog render --show mean and deviation: refusals.
#include <gtest/gtest.h>

#include <cmath>

#include "support/command.h"
#include "vog/compare_maps.h"
#include "vog/ply.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::test {

class field_pictures_command : public CommandLine {};

/// A clip leaves of the model's maps what it leaves of the voxels'.
TEST_F(field_pictures_command, clip_models_as_voxels) {
    write_vdb(dir_ / "cloud.vdb", sample_cloud({.size = 64}));
    must("convert cloud.vdb -o cloud.ply --block 2");
    const Box box = world_box(read_vdb(dir_ / "cloud.vdb"));
    const Vec3d c = box.center();
    const std::string clip =
        " --clip 0.3,1,-0.5," + std::to_string(0.3 * c.x + c.y - 0.5 * c.z) + " --size 48 ";
    for (const std::string view : {"", "--orthographic --view +y", "--view -x --renderer trace"}) {
        SCOPED_TRACE(view);
        const auto maps = [&](const std::string& input, const std::string& options) {
            must("render " + input + " -o map.png --show mean --field density --values-out m.exr " +
                 options);
            return read_field_maps(dir_ / "m.exr");
        };
        const std::string of_voxels = view.substr(0, view.find(" --renderer"));
        const FieldMaps whole = maps("cloud.ply", view + " --size 48 ");
        const FieldMaps model = maps("cloud.ply", view + clip);
        const FieldMaps voxels = maps("cloud.vdb", of_voxels + clip);
        double error = 0, norm = 0, column = 0, all = 0, weighted = 0, weighted_error = 0;
        for (std::size_t n = 0; n < model.column.size(); ++n) {
            const double a{model.column[n]}, b{voxels.column[n]};
            error += (a - b) * (a - b), norm += b * b;
            column += a, all += double{whole.column[n]};
            if (!(a > 0 && b > 0)) continue;
            weighted += b * double{voxels.mean[n]};
            weighted_error += b * std::abs(double{model.mean[n]} - double{voxels.mean[n]});
        }
        EXPECT_GT(column, 0.1 * all);
        EXPECT_LT(column, 0.9 * all);
        // The voxels' boxes at the plane are cut, Gaussians reach over it by their spread.
        EXPECT_LT(std::sqrt(error / norm), 0.1);
        EXPECT_LT(weighted_error, 0.1 * weighted);
    }
}

TEST_F(field_pictures_command, say_in_one_line_what_is_missing) {
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(1);
    write_ply(dir_ / "model.ply", model);
    const std::string render = "render model.ply -o map.png --size 16 ";
    must_fail(2, render + "--show mean",
              "--show mean needs --field NAME (vog info model.ply lists the names)");
    must_fail(2, render + "--field temperature", "--field has no effect with --show T");
    must_fail(2, render + "--show column --field temperature",
              "it works with --show mean, deviation, volume, maximum or slice");
    must_fail(2, render + "--show column --scale symmetric", "--scale symmetric has no effect");
    must_fail(2, render + "--show mean --field t --extinction 2", "--extinction");
    must_fail(2, render + "--show mean --field t --depth-out a.exr", "use --values-out FILE.exr");
    must_fail(2, render + "--show mean --field t --range 3,2", "--range 3,2");
    must_fail(1, render + "--show mean --field temperature",
              "model.ply: no field 'temperature': the model has none; vog convert VOLUME -o "
              "model.ply --field temperature");
    write_vdb(dir_ / "cloud.vdb", sample_cloud({.size = 64}));
    must_fail(1, "render cloud.vdb -o map.png --show mean --field temperature",
              "cloud.vdb: no grid named 'temperature' (it has: density)");
    must_fail(1, "render cloud.vdb -o map.png --show mean --field density --renderer splat",
              "cloud.vdb: is a volume; convert it first");
}

}  // namespace vog::test
