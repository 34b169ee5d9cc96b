// least_column_test.cpp: vog render --set least-column: pixels of a faint column are background in pictures of fields.
#include <gtest/gtest.h>

#include "render/splat/fields/field_splat.h"
#include "support/command.h"
#include "vog/camera.h"
#include "vog/field_maps.h"
#include "vog/picture_record.h"
#include "vog/ply.h"

namespace vog::test {

class least_column_command : public CommandLine {};

/// One Gaussian: its picture is the disc where its column is at least the share of the largest; values are everywhere.
TEST_F(least_column_command, faint_pixels_are_background_but_have_values) {
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(1);
    model.cutoff = 3;
    model.fields.scalar.push_back(
        {"T", "K", 300, 301, false, {}, {300.5f}, {Vec3f{0.1f, 0, 0}}, {0.01f}, {0.0f}});
    write_ply(dir_ / "model.ply", model);
    constexpr int kSize = 64;
    const auto values = [&](const std::string& share) {
        must(
            "render model.ply -o map.png --size 64 --show mean --field T --frame data --background "
            "transparent "
            "--values-out map.npy" +
            share);
        return read_text(dir_ / "map.npy");
    };
    const std::string all = values(" --set least-column=0");
    const FieldMaps maps = render_field_splat(
        model, {"T"}, *read_record(dir_ / "map.png").request.camera, kSize, kSize);
    const float most = *std::ranges::max_element(maps.column);
    int with_column = 0;
    for (const float column : maps.column) with_column += column > 0;
    const auto expect_disc = [&](double share) {
        const Image image = read_image(dir_ / "map.png");
        int visible = 0;
        for (std::size_t n = 0; n < maps.column.size(); ++n) {
            const bool shown = maps.column[n] > 0 && double{maps.column[n]} >= share * double{most};
            visible += shown;
            EXPECT_EQ(image.pixel[n].a > 0.5f, shown) << share << " at " << n;
        }
        return visible;
    };
    EXPECT_EQ(expect_disc(0), with_column);
    EXPECT_EQ(values(" --set least-column=0.5"), all);
    const int half = expect_disc(0.5);
    EXPECT_LT(half, with_column / 3);
    EXPECT_GT(half, with_column / 10);
    EXPECT_EQ(values(""), all);
    expect_disc(1e-4);  // the default
    for (const std::string wrong : {"-0.1", "1.5", "nan"})
        must_fail(2, "render model.ply -o m.png --show mean --field T --set least-column=" + wrong,
                  "--set least-column");
    must_fail(2, "render model.ply -o m.png --set least-column=0.1", "--set least-column");
}

}  // namespace vog::test
