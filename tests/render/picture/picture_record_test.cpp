// picture_record_test.cpp: requests through JSON and files of pictures.
#include "vog/picture_record.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/data.h"
#include "support/field_models.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/request_schema.h"

namespace vog::test {

namespace {

std::shared_ptr<const Gaussians> recorded_model() {
    auto model = std::make_shared<Gaussians>(random_gaussians(20, 0.3, 0.6, 5));
    add_random_fields(*model, 11);
    return model;
}

/// A request with every member off its default, of one quantity.
PictureRequest full_request() {
    return request_of_json(R"({"show": "volume", "field": "temperature",
        "tf": {"name": "mine", "colors": [[0, 1, 0.25, 0], [1, 0, 0.5, 1]], "opacity": [[0, 0.1], [1, 0.7]]},
        "range": [0.1, 7.25], "scale": "log", "threshold": 0.30000000000000004, "unit_distance": 0.1,
        "light": [1, 2, 3], "light_weights": [0.1, 0.2, 0.3, 4], "background": [0.1, 0.2, 0.3],
        "clip": [[-1, -1, -1], [1, 1, 1.5]], "clip_planes": [[1, 0, 0, -0.1], [0, 1, 1, -2]],
        "camera": {"eye": [4, 1.5, 2], "look_at": [0, 0, 0.1], "up": [0, 0, 1], "orthographic_width": 3.3},
        "size": [40, 30], "renderer": "splat", "slabs": 12, "title": "A \"title\" µ", "color_bar": true})");
}

}  // namespace

TEST(picture_record, keeps_every_member_through_json) {
    const PictureRequest request = full_request();
    const std::string json = request_json(request);
    EXPECT_EQ(request_json(request_of_json(json)), json);
    EXPECT_EQ(request.transfer.threshold, 0.30000000000000004);
    EXPECT_EQ(request.camera->orthographic_width, 3.3);
    EXPECT_EQ(request.options.clip.planes.size(), 2U);
    EXPECT_EQ(request.transfer.points.points.opacity.back().opacity, 0.7);
    EXPECT_EQ(request_json({}), "{}");
    // A base keeps what the object does not state; null is the default.
    const PictureRequest other = request_of_json(R"({"range": null, "slabs": null})", request);
    EXPECT_FALSE(other.transfer.range);
    EXPECT_FALSE(other.slabs);
    EXPECT_EQ(other.field, "temperature");
}

TEST(picture_record, every_key_can_be_null) {
    std::vector<std::string> keys{"camera"};
    for (const RequestMember& member : request_schema()) keys.push_back(member.key);
    for (const std::string& key : keys)
        EXPECT_EQ(request_json(request_of_json("{\"" + key + "\": null}", full_request()))
                      .find("\"" + key + "\""),
                  std::string::npos)
            << key;
}

TEST(picture_record, draws_the_same_picture_again) {
    const vog::Scene scene = scene_of(recorded_model());
    for (
        const char* json :
        {R"({"size": [40, 30]})",
         R"({"show": "column", "scale": "log", "size": [40, 30], "color_bar": true})",
         R"({"show": "mean", "field": "temperature", "size": [40, 30]})",
         R"({"show": "deviation", "field": "temperature", "scale": "symmetric", "size": [40, 30]})",
         R"({"show": "maximum", "field": "temperature", "size": [40, 30], "clip_planes": [[1, 0, 0, 0]]})",
         R"({"show": "volume", "field": "temperature", "size": [40, 30], "light": "head"})"}) {
        const Picture first = render(scene, request_of_json(json));
        const std::string made = request_json(first.made.request);
        const Picture again = render(scene, request_of_json(made));
        EXPECT_EQ(again.image.pixel, first.image.pixel) << json;
        EXPECT_EQ(request_json(again.made.request), made) << json;
        // What a request states has an effect.
        EXPECT_NO_THROW(require_effects(again.made.request)) << made;
    }
}

TEST(picture_record, lies_in_files_of_pictures) {
    const TempDir folder;
    const Picture picture =
        render(scene_of(recorded_model()), request_of_json(R"({"size": [40, 30]})"));
    const PictureRecord record{
        picture.made.request, {"däta.ply", "b.ply"}, {{"--grid", {"density"}}}, "9.8"};
    for (const char* name : {"a.png", "a.exr"}) {
        write_image(folder / name, picture.image, record_json(record));
        EXPECT_EQ(record_json(read_record(folder / name)), record_json(record)) << name;
        EXPECT_EQ(read_image(folder / name).width, 40);
    }
    write_numbers(folder / "t.exr", picture, record_json(record));
    EXPECT_EQ(read_record(folder / "t.exr").inputs, record.inputs);
    EXPECT_EQ(read_depth(folder / "t.exr").extinction, picture.extinction);
    std::ofstream(folder / "a.json") << record_json(record);
    EXPECT_EQ(read_record(folder / "a.json").version, "9.8");
}

TEST(picture_record, refuses_what_is_none_in_one_line) {
    const TempDir folder;
    const Picture picture = render(scene_of(recorded_model()), request_of_json(R"({"size": 8})"));
    write_png(folder / "plain.png", picture.image);
    EXPECT_NE(refusal([&] { read_record(folder / "plain.png"); }).find("without a record"),
              std::string::npos);
    EXPECT_NE(refusal([&] { read_record(folder / "none.png"); }).find("no such file"),
              std::string::npos);
    const auto expect = [](const char* json, const char* text) {
        const std::string message = refusal([&] { request_of_json(json); });
        EXPECT_NE(message.find(text), std::string::npos) << json << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    };
    expect("[1]", "expected a JSON object");
    expect("{", "not JSON");
    expect(R"({"shows": "T"})", "no member of a request, expected show, field");
    expect(R"({"show": "mass"})", "show mass: expected 'T'");
    expect(R"({"size": [0, 4]})", "size 0,4: expected pixels");
    expect(R"({"light": "studio", "shadows": false})", "shadows false: `light` studio has it");
    expect(R"({"size": [100000, 100000]})", "at most 2^28");
    expect(R"({"size": [1e300, 1]})", "expected pixels");
    expect(R"({"tf": "/etc/passwd"})", "/etc/passwd");
    expect(R"({"tf": {"colors": "nothing"}})", "colors");
    expect(R"({"range": [2, 1]})", "the first below the second");
    expect(R"({"window": [1, 0]})", "width above 0");
    expect(R"({"extinction": 0})", "above 0");
    expect(R"({"clip": [[1, 1, 1], [0, 0, 0]]})", "clip");
    expect(R"({"clip_planes": [[0, 0, 0, 1]]})", "clip");
    expect(R"({"camera": {"eye": [0, 0, 1], "look_at": [0, 0, 1]}})", "camera");
    expect(R"({"camera": {"eye": [0, 0, 1]}})", "look_at");
    expect(R"({"bands": [[0, 1, [1, 0, 0], 1], [0.5, 2, [1, 0, 0], 1]]})", "overlaps");
    expect(R"({"background": [2, 0, 0]})", "background");
    expect(R"({"samples": 1.5})", "1 to 64");
    expect(R"({"renderer": "gl"})", "gl");
    EXPECT_NE(refusal([] {
                  record_of_json(R"({"vog": "7.0", "picture": {"glow": 1}})");
              }).find("written by vog 7.0"),
              std::string::npos);
    EXPECT_NE(refusal([] { record_of_json(R"({"picture": {}, "inputs": 3})"); }).find("no record"),
              std::string::npos);
}

TEST(picture_record, reads_a_request_without_a_record_around_it) {
    const char* json = R"({"show": "column", "tf": "viridis", "clip": null})";
    const PictureRecord record = record_of_json(json);
    EXPECT_EQ(request_json(record.request), request_json(request_of_json(json)));
    EXPECT_TRUE(record.inputs.empty());
    EXPECT_NE(refusal([] { record_of_json("[1]"); }).find("expected an object"), std::string::npos);
}

TEST(picture_record, refuses_members_without_effect) {
    for (const char* json :
         {R"({"field": "temperature"})", R"({"range": [0, 1]})",
          R"({"show": "column", "extinction": 2})", R"({"show": "column", "light": "head"})",
          R"({"show": "mean", "field": "temperature", "slabs": 3})",
          R"({"show": "volume", "light_weights": [1, 0, 0, 1]})"})
        EXPECT_NE(refusal([&] { require_effects(request_of_json(json)); }).find("no effect"),
                  std::string::npos)
            << json;
}

}  // namespace vog::test
