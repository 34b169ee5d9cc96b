// export_html_test.cpp: exported pages: self-contained, small, with user texts escaped.
#include "vog/export_html.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "render/splat/splat.h"
#include "support/command.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/exposure.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/model_io.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++count;
    return count;
}

nlohmann::json page_of(const std::string& html) {
    const std::string open = "<script type=\"application/json\" id=\"page\">";
    const std::size_t begin = html.find(open) + open.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::string error_of(std::span<const HtmlModel> models, const HtmlOptions& options = {}) {
    const TempDir dir;
    try {
        write_html(dir / "page.html", models, options);
    } catch (const Error& error) {
        EXPECT_FALSE(std::filesystem::exists(dir / "page.html"));
        return error.what();
    }
    return "no error";
}

}  // namespace

/// Largest case for compression: unrelated full covariances.
TEST(export_html, a_hundred_thousand_random_gaussians_with_levels_stay_below_3_mb) {
    const TempDir dir;
    const HtmlModel model{"random", detail_levels(random_gaussians(100000, 0.003, 0.02, 1))};
    const HtmlReport report = write_html(dir / "page.html", std::span(&model, 1));
    EXPECT_EQ(report.bytes, std::filesystem::file_size(dir / "page.html"));
    EXPECT_EQ(report.gaussians, 100000u);
    EXPECT_LT(report.bytes - report.viewer_bytes, 2'950'000u);
    EXPECT_LT(report.viewer_bytes, 236'000u);
}

TEST(export_html, words_never_become_markup) {
    const TempDir dir;
    const std::string nasty =
        "</title></script><script>alert('1')</script><!-- \"{{script}}\" &amp;";
    HtmlModel model{nasty, {random_gaussians(5, 0.1, 0.2, 1)}};
    HtmlOptions options;
    options.title = options.description = nasty;
    options.tf.name = nasty;
    write_html(dir / "plain.html", std::span(&model, 1), {.title = "a", .description = "b"});
    write_html(dir / "nasty.html", std::span(&model, 1), options);
    const std::string plain = read_text(dir / "plain.html"), html = read_text(dir / "nasty.html");
    for (const char* tag : {"<script", "</script", "<title", "</title", "<!--", "<style"})
        EXPECT_EQ(count_of(html, tag), count_of(plain, tag)) << tag;
    EXPECT_NE(html.find("<h1>&lt;/title&gt;"), std::string::npos);
    EXPECT_EQ(page_of(html)["title"], nasty);
    EXPECT_EQ(page_of(html)["models"][0]["name"], nasty);
}

TEST(export_html, text_that_is_no_utf8_is_written_all_the_same) {
    const TempDir dir;
    HtmlModel model{"caf\xe9", {random_gaussians(5, 0.1, 0.2, 1)}};
    EXPECT_NO_THROW(write_html(dir / "page.html", std::span(&model, 1), {.title = "\xff\xfe"}));
}

TEST(export_html, asks_for_nothing_outside_itself) {
    const TempDir dir;
    const HtmlModel model{"m", {random_gaussians(5, 0.1, 0.2, 1)}};
    write_html(dir / "page.html", std::span(&model, 1));
    const std::string html = read_text(dir / "page.html");
    for (const char* word : {"http://", "https://", "src=", "@import", "url("})
        EXPECT_EQ(count_of(html, word), 0u) << word;
    // Every place is filled.
    EXPECT_FALSE(std::regex_search(html, std::regex("\\{\\{[a-z]+\\}\\}")));
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(count_of(html, "\nimport "), 0u);
    EXPECT_EQ(count_of(html, "\nexport "), 0u);
}

TEST(export_html, tells_models_levels_view_and_colours) {
    const TempDir dir;
    const Gaussians model = random_gaussians(5000, 0.02, 0.1, 3);
    const std::vector<HtmlModel> models{{"fine", detail_levels(model)},
                                        {"one", {coarsen(model, 1)}}};
    HtmlOptions options;
    options.camera = Camera{{1, 2, 9}, {0, 0, 0}, {0, 1, 0}, 50};
    options.tf = {"mine", {{0, 1, 0, 0}, {1, 0, 0, 1}}, {{0, 0}, {1, 1}}};
    options.shading = {{1, 1, 1, 1}, true};
    write_html(dir / "page.html", models, options);
    const auto page = page_of(read_text(dir / "page.html"));
    EXPECT_EQ(page["models"][0]["levels"].size(), 2u);
    EXPECT_EQ(page["models"][0]["levels"][0]["count"], 5000);
    EXPECT_EQ(page["models"][1]["levels"][0]["count"], 1);
    EXPECT_EQ(page["picture"]["camera"]["eye"], nlohmann::json({1.0, 2.0, 9.0}));
    EXPECT_EQ(page["map"], "mine");
    EXPECT_EQ(page["maps"][0]["colors"][1][3], 1.0);
    EXPECT_EQ(page["maps"].size(), 1 + transfer_function_names().size());
    EXPECT_EQ(page["picture"]["blend"], true);
    // Automatic extinction of this view, as in vog render.
    const DepthImage depth = render_splat(model, *options.camera, 256, 256);
    EXPECT_DOUBLE_EQ(page["models"][0]["extinction"].get<double>(), picture_extinction(depth));
}

TEST(export_html, refuses_what_cannot_be_shown) {
    const HtmlModel good{"m", {random_gaussians(5, 0.1, 0.2, 1)}};
    EXPECT_NE(error_of({}).find("no model"), std::string::npos);
    const HtmlModel hollow{"hollow", {}};
    EXPECT_NE(error_of(std::span(&hollow, 1)).find("'hollow' has no levels"), std::string::npos);
    HtmlModel bad = good;
    bad.levels[0].scale[2].x = -1;
    EXPECT_NE(error_of(std::span(&bad, 1)).find("Gaussian 2"), std::string::npos);
    EXPECT_NE(error_of(std::span(&good, 1), {.extinction = -1.0}).find("extinction"),
              std::string::npos);
    HtmlOptions flat;
    flat.camera = Camera{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, 40};
    EXPECT_NE(error_of(std::span(&good, 1), flat), "no error");
    EXPECT_NO_THROW(error_of(std::span(&good, 1)));
}

TEST(export_html, empty_and_single_models_make_pages) {
    const TempDir dir;
    Gaussians one;
    add(one, {1, 2, 3}, {1, 1, 1}, 1);
    const std::vector<HtmlModel> models{{"none", {Gaussians{}}}, {"one", {one}}};
    EXPECT_NO_THROW(write_html(dir / "page.html", models));
}

TEST(export_html, the_same_bytes_each_time) {
    const TempDir dir;
    const HtmlModel model{"m", detail_levels(random_gaussians(5000, 0.02, 0.1, 3))};
    write_html(dir / "a.html", std::span(&model, 1));
    write_html(dir / "b.html", std::span(&model, 1));
    EXPECT_EQ(read_text(dir / "a.html"), read_text(dir / "b.html"));
}

class cli_export : public CommandLine {};

TEST_F(cli_export, pages_of_models_volumes_and_particles) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o fine.ply --block 2");
    must("convert c.vdb -o coarse.ply --block 8");
    const auto report = nlohmann::json::parse(must("page fine.ply coarse.ply -o two.html --name "
                                                   "A --name B --title T --set levels=2 --json")
                                                  .out);
    EXPECT_EQ(report["models"][0]["name"], "A");
    EXPECT_EQ(report["models"][0]["levels"].size(), 2u);
    EXPECT_EQ(report["bytes"], std::filesystem::file_size(dir_ / "two.html"));
    const Result page = must("page c.vdb -o volume.html");
    EXPECT_NE(page.out.find("volume.html: "), std::string::npos);
    EXPECT_NE(page.error.find("converted with the default options of vog convert"),
              std::string::npos);
    EXPECT_EQ(page_of(read_text(dir_ / "volume.html"))["title"], "c");
    must("sample particles p.xyz --size 10");
    must("page p.xyz -o particles.html --value speed --background system --blend");
}

TEST_F(cli_export, a_folder_gets_a_page_of_each_under_one_camera_and_extinction) {
    must("sample cloud step_2.vdb --size 64");
    must("sample explosion step_10.vdb --size 64");
    must("convert 'step_*.vdb' -o models/ --block 8");
    for (const std::string inputs : {"'models/*.ply'", "'step_*.vdb'"}) {
        const auto report =
            nlohmann::json::parse(must("page " + inputs + " -o pages/ --json --set levels=1").out);
        ASSERT_EQ(report["pages"].size(), 2u);
        EXPECT_EQ(report["pages"][0]["output"], "pages/step_2.html");
        EXPECT_EQ(report["pages"][1]["output"], "pages/step_10.html");
        const auto first = page_of(read_text(dir_ / "pages/step_2.html"));
        const auto last = page_of(read_text(dir_ / "pages/step_10.html"));
        EXPECT_EQ(first["title"], "step_2");
        EXPECT_EQ(first["picture"]["camera"], last["picture"]["camera"]);
        EXPECT_EQ(first["models"].size(), 1u);
        EXPECT_EQ(first["models"][0]["extinction"], last["models"][0]["extinction"]);
        EXPECT_NE(first["models"][0]["box"], last["models"][0]["box"]);
    }
    // A page of one model has another camera and extinction; a page may also have all models.
    must("page models/step_10.ply -o alone.html");
    const auto alone = page_of(read_text(dir_ / "alone.html"));
    const auto last = page_of(read_text(dir_ / "pages/step_10.html"));
    EXPECT_NE(alone["models"][0]["extinction"], last["models"][0]["extinction"]);
    must("page 'models/*.ply' -o all.html");
    EXPECT_EQ(page_of(read_text(dir_ / "all.html"))["models"].size(), 2u);
    must_fail(2, "page 'models/*.ply' -o pages/ --name a", "--name");
}

TEST_F(cli_export, models_join_and_shrink_as_ply) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o fine.ply --block 2");
    must("convert c.vdb -o coarse.ply --block 8");
    must("convert fine.ply coarse.ply -o both.ply");
    const Gaussians fine = read_ply(dir_ / "fine.ply"), coarse = read_ply(dir_ / "coarse.ply");
    EXPECT_EQ(read_ply(dir_ / "both.ply").size(), fine.size() + coarse.size());
    must("convert fine.ply -o few.ply --budget 100");
    must_fail(2, "convert fine.ply -o few.ply --block 8", "--block has no effect with models");
    must("convert fine.ply -o bare.vogz --no-fields");
    EXPECT_TRUE(read_model(dir_ / "bare.vogz").fields.empty());
    // The same bytes as the model, if nothing changes.
    must("convert fine.ply -o same.ply");
    EXPECT_TRUE(read_text(dir_ / "same.ply") == read_text(dir_ / "fine.ply"));
    const Gaussians few = read_ply(dir_ / "few.ply");
    EXPECT_LE(few.size(), 100u);
    EXPECT_NEAR(mass(few), mass(fine), 1e-5 * mass(fine));
}

TEST_F(cli_export, errors_are_one_clear_line) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o m.ply --block 8");
    must_fail(1, "page m.ply -o page.pdf", "page.pdf: this command writes .html");
    must_fail(1, "page absent.ply -o page.html", "absent.ply: no such file");
    must_fail(1, "convert m.ply -o m.ply", "is also an input");
    must_fail(1, "page m.ply c.vdb -o page.html", "different kinds");
    must_fail(1, "page m.ply -o page.html --tf nope", "nope");
    must_fail(2, "page m.ply -o page.html --name a --name b", "2 names for 1 models");
    must_fail(2, "convert m.ply -o few.ply --title T",
              "--title here, only in vog render, vog page");
    must_fail(2, "page m.ply -o page.html --radius 3", "--radius has no effect with models");
    must_fail(2, "page m.ply -o page.html --set levels=0", "--set levels");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "page.html"));
}

}  // namespace vog::test
