// request_command_test.cpp: vog render --request: pictures drawn again from themselves.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "vog/image.h"
#include "vog/picture_record.h"

namespace vog::test {

class request_command : public CommandLine {
  protected:
    void SetUp() override {
        must("sample cloud cloud.vdb --size 64");
        must("convert cloud.vdb -o cloud.ply --block 4");
        write("p.csv", "x,y,z,mass\n0,0,0,1\n1,0,0,2\n0,1,1,3\n");
    }
    std::string bytes(const std::string& file) const { return read_text(dir_ / file); }
};

TEST_F(request_command, draws_the_same_file_again) {
    for (const char* options :
         {"cloud.ply", "cloud.vdb --show column --scale log --color-bar --title 'a b'",
          "cloud.vdb --show volume --light head --view +x --tf viridis",
          "cloud.ply --show mean --field density --orthographic --clip 1,0,0,0",
          "cloud.ply --show maximum --slabs 9 --renderer splat --background white",
          "cloud.vdb --show volume --band 0.1,0.5,red,0.5 --iso 0.6,blue",
          "cloud.ply --renderer trace --set anyhit=collect --set hits-per-slab=4 --extinction 3 "
          "--set stop-transmittance=0.1",
          "cloud.vdb --interpolation linear --set step=0.5 --samples 2",
          "p.csv --value mass --radius 0.4 --show column"}) {
        must(std::string("render ") + options + " --size 40x30 -o first.png");
        must("render --request first.png -o again.png");
        EXPECT_EQ(bytes("again.png"), bytes("first.png")) << options;
        must(std::string("render ") + options + " --size 40x30 -o first.exr");
        must("render --request first.exr -o again.exr");
        EXPECT_EQ(bytes("again.exr"), bytes("first.exr")) << options;
    }
}

TEST_F(request_command, options_beside_it_take_the_place_of_its_own) {
    must("render cloud.vdb --show column --tf viridis --view +z --size 40 -o first.png");
    must("render --request first.png --tf gray --size 30 -o other.png");
    must("render cloud.vdb --show column --tf gray --view +z --size 30 -o same.png");
    const PictureRecord record = read_record(dir_ / "other.png");
    EXPECT_EQ(record.request.transfer.points.points.name, "gray");
    EXPECT_EQ(record.request.width, 30);
    // The range is that of the first picture.
    EXPECT_EQ(record.request.transfer.range,
              read_record(dir_ / "first.png").request.transfer.range);
    must("render --request first.png --view -y -o view.png");
    EXPECT_NE(read_record(dir_ / "view.png").request.camera->eye,
              read_record(dir_ / "first.png").request.camera->eye);
    must("render --request first.png --camera first.png -o kept.png");
    EXPECT_EQ(read_record(dir_ / "kept.png").request.camera->eye,
              read_record(dir_ / "first.png").request.camera->eye);
    // What an option needs stands in the picture.
    for (const char* light : {"--shadows", "--light studio"}) {
        must(std::string("render cloud.vdb --show volume --size 30 -o lit.png ") + light);
        must("render --request lit.png --set asymmetry=0.4 -o forward.png");
        EXPECT_EQ(read_record(dir_ / "forward.png").request.look.asymmetry, 0.4) << light;
    }
    must("render cloud.vdb --show volume --size 30 --view 120,40 -o side.png --shadows");
    const PictureRequest side = read_record(dir_ / "side.png").request;
    EXPECT_LT(length(side.look.lights.front().towards - studio_light(*side.camera)), 1e-6);
    must_fail(1, "render --request first.png --show volume --set asymmetry=0.4", "asymmetry");
    // Another quantity has other values.
    must("render --request first.png --show T -o t.png");
    EXPECT_FALSE(read_record(dir_ / "t.png").request.transfer.range);
    // Other data in the same view and range.
    must("render --request first.png cloud.ply -o model.png");
    const PictureRecord model = read_record(dir_ / "model.png");
    EXPECT_EQ(model.inputs, std::vector<std::string>{"cloud.ply"});
    EXPECT_EQ(model.request.renderer, Renderer::splat);
    EXPECT_EQ(model.request.transfer.range, record.request.transfer.range);
}

TEST_F(request_command, pictures_of_turns_and_of_fields_in_other_files_are_drawn_again) {
    must("render cloud.ply -o turn/ --turntable 3 --size 20 --show column");
    must("render --request turn/0003.png -o again.png");
    EXPECT_EQ(read_text(dir_ / "again.png"), read_text(dir_ / "turn/0003.png"));
    must("sample cloud other.vdb --size 64 --set seed=9");
    for (const std::string show : {"mean", "volume"}) {
        must("render cloud.vdb --field other.vdb:density -o first.png --size 20 --show " + show);
        must("render --request first.png -o again.png");
        EXPECT_EQ(read_text(dir_ / "again.png"), read_text(dir_ / "first.png")) << show;
    }
    must("page cloud.ply -o site/");
    must("render site/ --pixel-error 6 --size 20 -o first.png");
    must("render --request first.png -o again.png");
    EXPECT_EQ(read_text(dir_ / "again.png"), read_text(dir_ / "first.png"));
    EXPECT_EQ(read_record(dir_ / "first.png").request.options.pixel_error, 6);
    // The same data by name are read and drawn in the same way.
    must("render p.csv --value mass --radius 0.4 --size 20 --show column -o first.png");
    must("render --request first.png p.csv -o again.png");
    expect_same_pixels("again.png", "first.png");
}

TEST_F(request_command, the_camera_is_turned_and_placed_by_options) {
    must("render cloud.ply --eye 0,2,0 --look-at 1,0,0 --fov 90 --size 16 -o first.png");
    const Camera first = *read_record(dir_ / "first.png").request.camera;
    must("render --request first.png --set roll=10 -o rolled.png");
    const Camera rolled = *read_record(dir_ / "rolled.png").request.camera;
    EXPECT_EQ(rolled.eye, first.eye);
    EXPECT_EQ(rolled.fov_degrees, 90);
    EXPECT_NE(rolled.up, first.up);
    must("render --request first.png --orthographic --width 3 -o flat.png");
    EXPECT_EQ(read_record(dir_ / "flat.png").request.camera->orthographic_width, 3);
    must_fail(2, "render --request first.png --width 3 -o flat.png", "holds a pinhole camera");
}

TEST_F(request_command, of_several_inputs_needs_all_of_them) {
    must("render cloud.vdb --show volume --layer tf=gray --layer cloud.ply --size 16 -o two.png");
    must("render --request two.png cloud.vdb cloud.ply -o again.png");
    must_fail(2, "render --request two.png cloud.vdb -o again.png",
              "the picture has 2 inputs, but 1 is given");
}

TEST_F(request_command, draws_the_picture_of_a_pages_link) {
    const std::string words =
        "model=2&level=3&logaxis&error=2&planes_off=%5B%5B1,0,0,0%5D%5D&show=volume&field=density&"
        "tf=viridis&range=0.1,0.9&scale=log&unit_distance=2e%2B1&light=head&light_weights=0.3,0.6,"
        "0.3,"
        "20&clip=-9,-9,-9,9,9,9&clip_planes=%5B%5B1,0,0,-3%5D%5D&background=1,1,1,1&camera.eye=0,0,"
        "90&camera.look_at=0,0,0&camera.up=0,1,0&camera.fov_degrees=40&size=40,30";
    must("render cloud.ply -o first.png --request 'file:///a%20b/page.html#" + words + "'");
    must(
        "render cloud.ply -o same.png --show volume --field density --tf viridis --range 0.1,0.9 "
        "--scale log --unit-distance 20 --light head --set light-weights=.3,.6,.3,20 "
        "--clip=-9,-9,-9,9,9,9 --clip 1,0,0,-3 --background 1,1,1 --eye 0,0,90 "
        "--look-at 0,0,0 --fov 40 --size 40x30");
    expect_same_pixels("first.png", "same.png");
    write("link.txt", "https://example.org/#" + words + "\n");
    must("render cloud.ply -o again.png --request link.txt");
    EXPECT_EQ(bytes("again.png"), bytes("first.png"));
    // A flag, a member's default, a name with a space.
    const PictureRecord record = record_of_link("#blend&field=gas+temp%C3%A9&clip=&title=1");
    EXPECT_TRUE(record.request.shading.blend);
    EXPECT_EQ(record.request.field, "gas temp\u00e9");
    EXPECT_EQ(record.request.marks.title, "1");
    EXPECT_FALSE(record.request.options.clip.box);
    must_fail(1, "render cloud.ply -o x.png --request '#map=viridis'", "map: no member");
    must_fail(1, "render cloud.ply -o x.png --request '#show=<b>&tf=x'", "show <b>: expected");
    must_fail(1, "render cloud.ply -o x.png --request 'page.html#'", "no link of a page");
    must_fail(1, "render cloud.ply -o x.png --request '#show=T&exposure=2'",
              "extinction=NUMBER works");
    must("render cloud.ply -o x.png --size 16 --request '#embed&still&exposure=1'");
    must_fail(1, "render cloud.ply -o x.png --request '#camera.eye=1,2,3'", "look_at");
    must_fail(1, "render cloud.ply -o x.png --request '#camera=3&camera.eye=1,2,3'", "no link");
    must_fail(1, "render cloud.ply -o x.png --request '#title=%ff%fe'", "no link of a page");
    must_fail(1, "render -o x.png --request '#show=column'", "names no inputs");
    for (std::size_t length = 0; length < words.size(); ++length) {  // no crash
        try {
            (void)record_of_link("#" + words.substr(0, length));
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
}

TEST_F(request_command, reports_the_request_and_reads_the_report) {
    const auto report = nlohmann::json::parse(
        must("render cloud.vdb --show column --size 40 --values-out v.npy --json").out);
    write("r.json", report["request"].dump());
    must("render --request r.json --values-out w.npy");
    EXPECT_EQ(bytes("v.npy"), bytes("w.npy"));
}

TEST_F(request_command, refuses_in_one_line) {
    must("render cloud.vdb --size 20 -o first.png");
    const auto refused = [&](const std::string& arguments, const std::string& text) {
        must_fail(1, arguments, text);
    };
    refused("render --request cloud.vdb -o x.png", "no record");
    refused("render --request none.png -o x.png", "no such file");
    refused("render --request first.png -o first.png", "first.png");
    must_fail(2, "render -o x.png", "inputs is required");
    const auto request = [&](const char* text) { write("r.json", text); };
    request(R"({"picture": {"show": "column"}, "inputs": []})");
    refused("render --request r.json -o x.png", "names no inputs");
    request(R"({"picture": {}, "inputs": ["cloud.vdb"], "reading": {"--output": ["y.png"]}})");
    refused("render --request r.json -o x.png", "not an option for reading");
    request(R"({"picture": {}, "inputs": ["gone.vdb"]})");
    refused("render --request r.json -o x.png", "gone.vdb is not in");
    request(R"({"picture": {"show": "mean", "field": "heat"}, "inputs": ["cloud.vdb"]})");
    refused("render --request r.json -o x.png", "heat");
    request(R"({"picture": {"light": "head"}, "inputs": ["cloud.vdb"]})");
    refused("render --request r.json -o x.png", "no effect");
    request(R"({"picture": {}, "inputs": ["cloud.vdb"], "reading": {"--combine": []}})");
    refused("render --request r.json -o x.png", "'--combine' in 'reading' has no value");
    request(
        R"({"picture": {"show": "mean", "field": "cloud.vdb:density"}, "inputs": ["cloud.vdb"]})");
    refused("render --request r.json -o x.png", "'field' names a file");
    refused("render --request '' -o x.png", "no such file");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x.png"));
    // Nor does a folder cost the picture that is drawn again.
    must("render cloud.ply -o turn/ --turntable 2 --size 8");
    const std::string second = read_text(dir_ / "turn/0002.png");
    refused("render --request turn/0002.png -o turn/ --turntable 2", "is the picture of --request");
    EXPECT_EQ(read_text(dir_ / "turn/0002.png"), second);
}

}  // namespace vog::test
