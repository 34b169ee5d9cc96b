// field_pictures_test.cpp: vog render --show mean and deviation: refusals.
#include <gtest/gtest.h>

#include "support/command.h"
#include "vog/ply.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::test {

class field_pictures_command : public CommandLine {};

TEST_F(field_pictures_command, say_in_one_line_what_is_missing) {
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(1);
    write_ply(dir_ / "model.ply", model);
    const std::string render = "render model.ply -o map.png --size 16 ";
    must_fail(2, render + "--show mean", "--show mean: expected --field NAME");
    must_fail(2, render + "--field temperature",
              "--field: is of --show mean, deviation, volume or maximum");
    must_fail(2, render + "--show column --field temperature",
              "--field: is of --show mean, deviation, volume or maximum");
    must_fail(2, render + "--show column --scale symmetric", "symmetric is of --show mean");
    must_fail(2, render + "--show mean --field t --extinction 2", "--extinction");
    must_fail(2, render + "--show mean --field t --log --scale linear", "--log: is --scale log");
    must_fail(2, render + "--show mean --field t --depth-out a.exr", "--depth-out: is of T");
    must_fail(2, render + "--show mean --field t --range 3,2", "--range 3,2");
    must_fail(1, render + "--show mean --field temperature",
              "model.ply: no field 'temperature': the model has none; vog convert IN -o "
              "model.ply --field temperature");
    write_vdb(dir_ / "cloud.vdb", sample_cloud({.size = 64}));
    must_fail(1, "render cloud.vdb -o map.png --show mean --field temperature",
              "cloud.vdb: no grid named 'temperature' (it has: density)");
    must_fail(1, "render cloud.vdb -o map.png --show mean --field density --renderer splat",
              "cloud.vdb: is a volume; convert it first");
}

}  // namespace vog::test
