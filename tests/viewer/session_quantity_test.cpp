// session_quantity_test.cpp: quantities and layers of vog view against those of vog render.
#include <nlohmann/json.hpp>

#include "quantity/look.h"
#include "quantity/probe.h"
#include "viewer/view_command.h"
#include "vog/compare.h"
#include "vog/gaussians.h"
#include "vog/picture_record.h"
#include "vog/ply.h"

namespace vog::test {

TEST_F(view_command, quantities_are_the_command_lines) {
    make_cloud();
    for (const char* renderer : {"gl", "splat"}) {
        SCOPED_TRACE(renderer);
        play("cloud.ply",
             "size 200 160\npanels off\noverlay off\ncolorbar off\naxes off\n"
             "renderer " +
                 std::string(renderer) +
                 "\n"
                 "orbit 25 10\nsave-camera camera.json\nwait\n"
                 "show column\nvalues 0.1 30 log\nwait\npicture column.png\n"
                 "show mean density\nvalues 0.1 0.9\ntf viridis\nwait\npicture mean.png\n"
                 "depth mean.exr\n"
                 "show deviation\nvalues 0 0.3\nwait\npicture deviation.png\n"
                 "show maximum\nvalues 0.1 1\nwait\npicture maximum.png\ndepth maximum.exr\n"
                 "show volume\nwait\n"
                 "points 0.1:0 0.5:0.2 0.9:0.7\nundo\nredo\nunit-distance 5\ntf hot\n"
                 "save-tf look.json\nlight on\nshadows on\nocclusion on\nclip -20 -20 -20 8 20 "
                 "20\nwait\n"
                 "picture volume.png\n"
                 "show T\ntf inferno\nexposure 0.05\nwait\npicture clipped.png\n");
        const auto render = [&](const std::string& options, const std::string& file) {
            SCOPED_TRACE(file);
            must("render cloud.ply --camera camera.json --size 200x160 " + options + " -o r_" +
                 file);
            expect_same_picture("r_" + file, file);
        };
        render("--show column --range 0.1,30 --scale log", "column.png");
        render("--show mean --field density --range 0.1,0.9 --tf viridis", "mean.png");
        render("--show deviation --field density --range 0,0.3 --tf viridis", "deviation.png");
        render("--show maximum --range 0.1,1 --tf viridis", "maximum.png");
        render(
            "--show volume --tf look.json --light head --shadows --ambient-occlusion "
            "--clip=-20,-20,-20,8,20,20",
            "volume.png");
        render("--extinction 0.05 --tf inferno --clip=-20,-20,-20,8,20,20", "clipped.png");
    }
}

TEST_F(view_command, root_mean_squares_of_vectors_are_the_command_lines) {
    make_cloud();
    Gaussians model = read_ply(dir_ / "cloud.ply");
    VectorField flow;
    flow.name = "flow";
    flow.unit = "m/s";
    flow.upper = 3;
    for (const Vec3f& at : model.mean) {
        flow.value.push_back({std::sin(0.1f * at.y), std::cos(0.1f * at.x), 0.1f * at.z});
        flow.covariance.push_back({0.04f, 0.01f, 0, 0.09f, -0.01f, 0.02f});
    }
    for (auto& gradient : flow.gradient) gradient.assign(model.size(), Vec3f{0.02f, -0.03f, 0.01f});
    model.fields.vector.push_back(std::move(flow));
    write_ply(dir_ / "cloud.ply", model);
    for (const char* renderer : {"gl", "splat", "trace"}) {
        SCOPED_TRACE(renderer);
        // The first quantity by options, and the others' fields after it.
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\naxes off\nrenderer " +
                 std::string(renderer) +
                 "\nsave-camera camera.json\nwait\npicture rms.png\ndepth rms.exr\n"
                 "show deviation flow.x\nwait\nshow mean flow.magnitude\nvalues 0.5 2\nwait\n"
                 "picture again.png\n",
             "--show mean --field flow.magnitude --range 0.5,2");
        must(
            "render cloud.ply --camera camera.json --size 120x100 --show mean --field "
            "flow.magnitude --range 0.5,2 -o r.png");
        expect_same_picture("r.png", "rms.png");
        expect_same_picture("r.png", "again.png");
    }
    refuses("show deviation flow.magnitude\n", "deviation on rays cannot show rms of flow");
    refuses("show maximum flow\n", "maximum on rays cannot show flow along the view");
    must_fail(2, "view cloud.ply --headless --script play.vog --show maximum --light head",
              "it works with --show volume");
}

TEST_F(view_command, voxels_show_quantities_and_options_choose_the_first) {
    must("sample cloud cloud.vdb --size 64");
    play("cloud.vdb",
         "size 120 100\npanels off\noverlay off\ncolorbar off\naxes off\nrenderer reference\n"
         "save-camera camera.json\nwait\npicture mean.png\n"
         "show volume\nwait\npoints 0.2:0 0.9:0.5\nunit-distance 4\nsave-tf look.json\nwait\n"
         "picture volume.png\ndepth volume.exr\n"
         "show maximum\nvalues 0.1 1\ntf viridis\nwait\npicture maximum.png\n"
         "against gl\nsplit 0.5\nwait\nsplit off\ndifference 0.1\nwait\npicture difference.png\n",
         "--show mean --range 0.1,0.8 --tf viridis");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show maximum --range 0.1,1 --tf "
        "viridis -o r_maximum.png");
    expect_same_picture("r_maximum.png", "maximum.png");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show mean --field density --range "
        "0.1,0.8 --tf "
        "viridis -o r_mean.png");
    expect_same_picture("r_mean.png", "mean.png");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show volume --tf look.json -o "
        "r_volume.png");
    expect_same_picture("r_volume.png", "volume.png");
    must_fail(1, "view cloud.vdb --headless --script play.vog --show mean --field nothing",
              "nothing");
}

TEST_F(view_command, clip_planes_are_the_command_lines) {
    make_cloud();
    const std::string planes = " --clip=1,0.5,0,2 --clip=0,0,-1,-3";
    for (const char* renderer : {"gl", "splat"}) {
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\nrenderer " +
                 std::string(renderer) +
                 "\nsave-camera camera.json\nvalues 0.1 0.9\nwait\npicture mean.png\n",
             "--show mean --field density" + planes);
        must(
            "render cloud.ply --camera camera.json --size 120x100 --show mean --field density "
            "--range 0.1,0.9 -o r.png" +
            planes);
        expect_same_picture("r.png", "mean.png");
    }
    must_fail(2, "view cloud.ply --headless --script play.vog --clip=1,0,0", "a plane NX,NY,NZ,D");
}

TEST_F(view_command, pictures_keep_their_request) {
    make_cloud();
    for (const char* show :
         {"T", "column", "mean --field density", "volume --light head", "maximum"}) {
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\nrenderer splat\nwait\npicture "
             "shown.png\n",
             std::string("--clip=1,0.5,0,2 --view +x --show ") + show);
        must("render --request shown.png -o again.png");
        expect_same_picture("again.png", "shown.png");
    }
    // As the shell has it from the clipboard.
    const std::string record = record_json(read_record(dir_ / "shown.png"));
    must("render --request '" + record + "' -o pasted.png");
    EXPECT_EQ(read_text(dir_ / "pasted.png"), read_text(dir_ / "again.png"));
}

TEST_F(view_command, files_of_values_keep_their_scale_however_they_are_opened) {
    make_cloud();
    write("look.json", R"({"domain": [-10, 20], "colors": [[-10, 0, 0, 0], [20, 1, 1, 1]]})");
    play("cloud.ply",
         "size 700 1400\noverlay off\ncolorbar off\nsave-camera camera.json\nshow mean\nwait\n"
         "press load look\nwait\npicture loaded.png\n");
    must("render --request loaded.png -o again.png");
    expect_same_picture("again.png", "loaded.png");
    const PictureRequest request = read_record(dir_ / "loaded.png").request;
    ASSERT_TRUE(request.transfer.range.has_value());
    EXPECT_EQ(*request.transfer.range, std::pair(-10.0, 20.0));
}

TEST_F(view_command, layers_are_the_command_lines) {
    make_cloud();
    must("sample explosion other.vdb --size 64");
    must("export other.vdb --iso 0.5 -o other.stl");
    const std::string layers =
        " --show volume --layer tf=hot --layer other.vdb,tf=viridis --layer other.stl,color=white";
    play("cloud.ply",
         "size 500 700\noverlay off\ncolorbar off\nwait\npicture all.png\npress layer 2\nwait\n"
         "picture two.png\npress layer 2\npress layer 3\npress layer 1\nwait\npicture one.png\n",
         layers);
    must("render --request all.png -o again.png");
    expect_same_picture("again.png", "all.png");
    const PictureRecord record = read_record(dir_ / "all.png");
    ASSERT_EQ(record.request.layers.size(), 3u);
    EXPECT_EQ(record.inputs, (std::vector<std::string>{"cloud.ply", "other.vdb", "other.stl"}));
    // Hidden ones are empty.
    for (const char* picture : {"two.png", "one.png"}) {
        must(std::string("render --request ") + picture + " -o again.png");
        expect_same_picture("again.png", picture);
        EXPECT_LT(compare(read_image(dir_ / picture), read_image(dir_ / "all.png")).psnr_db, 40);
    }
    must_fail(2,
              "view cloud.vdb other.vdb --headless --script play.vog --show volume --layer tf=hot",
              "no layer uses other.vdb");
    must_fail(1, "view cloud.ply --headless --script play.vog --show volume --layer field=none",
              "none");
}

TEST_F(view_command, scales_and_slices_of_layers_are_moved) {
    make_cloud();
    play("cloud.ply",
         "size 900 700\noverlay off\ncolorbar off\nwait\npicture before.png\n"
         "drag left 62% 38% 62% 30%\nwait\npicture dragged.png\n"
         "press layer-1-log\nwait\npicture log.png\n",
         " --show volume --layer tf=hot,range=0.1,2,scale=linear --layer band=0.5,1,red,0.5 "
         "--layer plane=z,tf=gray,opacity=0.5");
    std::vector<PictureRequest> requests;
    for (const char* picture : {"before.png", "dragged.png", "log.png"}) {
        must(std::string("render --request ") + picture + " -o again.png");
        expect_same_picture("again.png", picture);
        requests.push_back(read_record(dir_ / picture).request);
        ASSERT_EQ(requests.back().layers.size(), 3u);
        EXPECT_EQ(requests.back().camera->eye, requests.front().camera->eye) << picture;
    }
    const auto offset = [&](std::size_t n) { return *requests[n].layers[2].plane->offset; };
    EXPECT_LT(offset(1), offset(0));
    EXPECT_EQ(offset(2), offset(1));
    EXPECT_EQ(requests[1].layers[0].fit, ScaleFit::linear);
    EXPECT_EQ(requests[2].layers[0].fit, ScaleFit::log);
}

TEST_F(view_command, mouse_and_keys_reach_quantities) {
    make_cloud();
    const auto values = [&](const std::string& file) {
        return nlohmann::json::parse(read_text(dir_ / file)).at("opacity");
    };
    play("cloud.ply",
         "size 900 700\nrenderer splat\nwait\nkey g\nkey g\nkey g\nkey g\nwait\nsave-tf "
         "before.json\n"
         "drag right 40% 50% 60% 40%\nsave-tf window.json\nkey ctrl+z\nsave-tf undone.json\n"
         "press step\nsave-tf step.json\nkey k\nwait\ndrag left 50% 50% 52% 50%\nkey u\n"
         "move 50% 50%\nscreenshot window.png\n");
    const auto before = values("before.json"), window = values("window.json");
    EXPECT_EQ(values("undone.json"), before);
    // To the right wider, up higher.
    EXPECT_GT(window.back()[0].get<double>() - window.front()[0].get<double>(),
              before.back()[0].get<double>() - before.front()[0].get<double>());
    EXPECT_GT(window.front()[0].get<double>() + window.back()[0].get<double>(),
              before.front()[0].get<double>() + before.back()[0].get<double>());
    EXPECT_EQ(values("step.json").size(), 4u);
}

}  // namespace vog::test
