// slices_test.cpp: vog render --show slice: numbers, views, records, and what is refused in one line.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/level_volumes.h"
#include "vog/compare_maps.h"
#include "vog/picture_record.h"
#include "vog/ply.h"
#include "vog/volume_io.h"

namespace vog::test {

class slices_command : public CommandLine {
  protected:
    void SetUp() override {
        CommandLine::SetUp();
        // 8^3 voxels from 0 to 4: the density is that of the voxel's z.
        Volume volume =
            cube_of(8, 1, {{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}, {0.25, 0.25, 0.25}});
        for (Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, static_cast<float>(1 + (n & 7)));
        volume.name = "density";
        write_vdb(dir_ / "cube.vdb", volume);
    }
    std::vector<float> values(const std::string& options) const {
        must("render cube.vdb -o s.png --show slice --values-out s.npy --size 16 " + options);
        return read_map(dir_ / "s.npy").value;
    }
};

TEST_F(slices_command, have_the_values_of_the_plane) {
    for (const float value : values("--plane z=0.7")) EXPECT_EQ(value, 2);
    for (const float value : values("--plane z=3.9")) EXPECT_EQ(value, 8);
    for (const float value : values("--plane z=2 --thickness 1")) EXPECT_NEAR(value, 4.5, 1e-5);
    for (const float value : values("--plane z=2 --field density --thickness 1"))
        EXPECT_NEAR(value, (16.0 + 25) / 9, 1e-5);
    // Along x the picture has z up, and covers the section.
    const std::vector<float> x = values("--plane x=1.2");
    for (int row = 0; row < 16; ++row)
        for (int column = 0; column < 16; ++column)
            EXPECT_EQ(x[static_cast<std::size_t>(16 * row + column)], 8 - row / 2);
    EXPECT_EQ(values("--plane 0,0,2,1.4"), values("--plane z=0.7"));
    // Wider than the data: nothing is around them.
    const std::vector<float> wide = values("--plane z=0.7 --width 8");
    EXPECT_TRUE(std::isnan(wide[0]));
    EXPECT_EQ(wide[8 * 16 + 8], 2);
}

TEST_F(slices_command, are_moved_along_their_plane) {
    const std::vector<float> corner = values("--plane z=0.7 --width 2 --look-at 4,4,9");
    EXPECT_EQ(std::ranges::count(corner, 2.0f), 64);
    EXPECT_EQ(corner[15 * 16], 2);
    EXPECT_TRUE(std::isnan(corner[15])) << "right of the data";
    EXPECT_TRUE(std::isnan(corner[0])) << "above them";
    EXPECT_EQ(values("--plane z=0.7 --look-at 2,2,2"), values("--plane z=0.7"));
}

TEST_F(slices_command, are_drawn_again_from_their_record) {
    const std::vector<float> first = values("--plane y --color-bar");
    const std::string image = read_text(dir_ / "s.png");
    const PictureRequest request = read_record(dir_ / "s.png").request;
    EXPECT_EQ(request.plane->axis, "y");
    EXPECT_EQ(request.plane->offset, 2);
    must("render --request s.png -o again.png");
    EXPECT_EQ(read_text(dir_ / "again.png"), image);
    // Another plane has a view of its own.
    must("render --request s.png -o z.png --plane z=0.7 --values-out z.npy");
    EXPECT_EQ(read_map(dir_ / "z.npy").value[0], 2);
}

TEST_F(slices_command, have_the_colours_of_a_files_values) {
    write("o.ctbl", "1 brain 100 100 100 255\n2 liver 255 0 0 255\n5 cyst 0 0 255 255\n");
    const std::string slice = "render cube.vdb -o s.png --size 16 --show slice --plane x --tf ";
    const auto rgb = [&](int value) {
        const Rgba pixel = read_image(dir_ / "s.png").at(8, 17 - 2 * value);
        return std::array{pixel.r, pixel.g, pixel.b};
    };
    using Rgb = std::array<float, 3>;
    const Rgb black{}, grey{100 / 255.0f, 100 / 255.0f, 100 / 255.0f}, red{1, 0, 0}, blue{0, 0, 1};
    const auto found = nlohmann::json::parse(must(slice + "o.ctbl --json").out);
    EXPECT_EQ(found["range"], (std::vector<double>{0.5, 5.5}));
    const Rgb colors[] = {grey, red, black, black, blue, black, black, black};
    for (int value = 1; value <= 8; ++value) EXPECT_EQ(rgb(value), colors[value - 1]) << value;
    must("render --request s.png -o again.png");
    EXPECT_EQ(read_text(dir_ / "again.png"), read_text(dir_ / "s.png"));
    must(slice + "o.ctbl:liver");
    for (int value = 1; value <= 8; ++value) EXPECT_EQ(rgb(value), value == 2 ? red : black);
    write("tf.json", R"({"domain": [-10, 20], "colors": [[-10, 0, 0, 0], [20, 1, 1, 1]]})");
    for (const char* show : {"slice --plane x", "maximum", "mean --field density"}) {
        const std::string render = std::string("render cube.vdb -o s.png --show ") + show;
        EXPECT_EQ(nlohmann::json::parse(must(render + " --tf tf.json --json").out)["range"],
                  (std::vector<double>{-10, 20}));
        must_fail(2, render + " --tf tf.json --range 0,9", "--range: tf states values of its own");
        must_fail(2, render + " --tf tf.json --scale log", "--scale: tf states values of its own");
    }
    for (const char* show : {"T", "column", "mean --field density", "deviation --field density"})
        must_fail(2, std::string("render cube.vdb -o s.png --tf o.ctbl --show ") + show,
                  "--tf: o is a table of labels");
    must_fail(2, slice + "o.ctbl --samples 4", "--samples: o is a table of labels, whose averages");
    must_fail(2, slice + "o.ctbl --thickness 1", "--thickness: o is a table of labels");
    must_fail(2, "render cube.vdb -o s.png --show volume --tf o.ctbl --interpolation linear",
              "--interpolation: o is a table of labels");
}

TEST_F(slices_command, of_values_below_0_show_them) {
    std::string file = "NRRD0004\ntype: int8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n";
    for (int n = 0; n < 512; ++n) file += static_cast<char>(n / 64 - 5);
    write("signed.nrrd", file);
    for (const char* field : {"", " --field value"}) {
        must("render signed.nrrd -o s.png --show slice --plane z=2 --values-out s.npy" +
             std::string(field));
        const ValueMap map = read_map(dir_ / "s.npy");
        EXPECT_EQ(map.value[map.value.size() / 2 + 256], -3) << field;
    }
}

TEST_F(slices_command, have_a_window_which_is_a_range_of_grey) {
    must("render cube.vdb -o w.png --show slice --plane x --window 4,6 --size 16");
    must("render cube.vdb -o r.png --show slice --plane x --tf gray --range 1,7 --size 16");
    expect_same_pixels("w.png", "r.png");
    must("render --request w.png -o again.png");
    expect_same_pixels("w.png", "again.png");
    must("render --request w.png --window 4,3 -o narrow.png");
    EXPECT_NE(read_image(dir_ / "narrow.png").pixel, read_image(dir_ / "w.png").pixel);
    must_fail(2, "render cube.vdb -o b.png --show slice --plane x --window 4,6 --tf gray", "--tf");
}

TEST_F(slices_command, are_turned_in_their_plane) {
    const auto camera = [&](const std::string& options) {
        must("render cube.vdb -o s.png --show slice --size 16 --plane y=2 " + options);
        return *read_record(dir_ / "s.png").request.camera;
    };
    const Camera own = camera(""), turned = camera("--up z"), wide = camera("--up z --width 8");
    EXPECT_EQ(turned.eye, own.eye);
    EXPECT_EQ(turned.up, (Vec3d{0, 0, 1}));
    EXPECT_NEAR(turned.orthographic_width, own.orthographic_width, 1e-9);
    EXPECT_EQ(wide.orthographic_width, 8);
    must("render --request s.png -o again.png --up x");
    const Camera again = *read_record(dir_ / "again.png").request.camera;
    EXPECT_EQ(again.eye, own.eye);
    EXPECT_EQ(again.up, own.up);
    const std::string slice = "render cube.vdb -o s.png --show slice --plane y=2 ";
    must_fail(2, slice + "--up y", "--up y: is along the view of the slice");
    must_fail(2, slice + "--frame data", "--frame has no effect with --show slice");
    EXPECT_NE(must(slice + "--view +x").error.find("the plane is seen edge-on"), std::string::npos);
}

TEST_F(slices_command, of_levels_have_the_name_of_other_pictures) {
    must("sample amr amr.vdb --size 64");
    for (const char* show : {"slice --plane z", "volume --unit-distance 1", "maximum"}) {
        const auto made = nlohmann::json::parse(
            must(std::string("render amr.vdb -o s.png --size 16 --json --show ") + show).out);
        EXPECT_EQ(made["quantity"].get<std::string>().find("_L"), std::string::npos) << made;
    }
}

TEST_F(slices_command, that_a_clip_leaves_nothing_of_say_so) {
    EXPECT_NE(must("render cube.vdb -o s.png --clip 9,9,9,10,10,10")
                  .error.find("pixels show anything: --clip cuts away"),
              std::string::npos);
}

TEST_F(slices_command, of_no_plane_beside_the_data_or_by_others_are_refused) {
    const std::string slice = "render cube.vdb -o s.png --show slice";
    must_fail(2, slice, "--show slice needs --plane");
    must_fail(2, "render cube.vdb -o s.png --plane z=1", "--plane has no effect with --show T");
    must_fail(2, "render cube.vdb -o s.png --thickness 1",
              "--thickness has no effect with --show T");
    must_fail(2, slice + " --plane z=4.5", "--plane z=4.5: lies outside of the data");
    must_fail(2, slice + " --plane 1,1,0,9", "--plane with offset 9: lies outside of the data");
    must_fail(2, slice + " --plane 0,0,0,1", "--plane 0,0,0,1: expected x, y, z, axial");
    must_fail(2, slice + " --plane w=1", "--plane w=1: expected x, y, z, axial");
    must_fail(2, slice + " --plane axial=1", "--plane axial: the data do not say where a patient");
    must_fail(2, slice + " --plane z=1 --thickness 0", "--thickness 0: expected a finite length");
    must_fail(2, slice + " --plane z=1 --interpolation linear", "--interpolation linear");
    must_fail(2, slice + " --plane z=1 --orthographic", "--orthographic has no effect");
    must_fail(2, slice + " --plane z=1 --renderer optix", "--renderer optix");
    must("convert cube.vdb -o cube.ply --block 4");
    must_fail(2, "render cube.ply -o s.png --show slice --plane z=1 --renderer trace",
              "--renderer splat");
    must_fail(2, "page cube.ply -o s.html --show slice", "--show");
}

}  // namespace vog::test
