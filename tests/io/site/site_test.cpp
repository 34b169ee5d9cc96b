// site_test.cpp: sites: trees of chunks, whole models, cuts by view, interrupted and repeated exports, refused files.
#include "vog/site.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <set>

#include "io/site/chunk_name.h"
#include "io/site/manifest.h"
#include "io/site/tree/chunk_tree.h"
#include "render/splat/splat.h"
#include "support/data.h"
#include "support/field_models.h"
#include "support/model_psnr.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/model_io.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

namespace fs = std::filesystem;

/// A cloud of some ten thousand Gaussians with its density as a field: chunks of two depths and more.
Gaussians cloud() {
    static const Gaussians model = [] {
        MomentOptions options;
        options.block_voxels = 2;
        options.soft_steps = 0;
        options.own_field = "density";
        return convert_moments(sample_cloud({.size = 144}), options);
    }();
    return model;
}

SiteReport write(const fs::path& folder, Gaussians model, const VogzPrecision& precision = {}) {
    SiteWriter site(folder, precision);
    const Hierarchy hierarchy = build_hierarchy(model);
    site.add("cloud", model, hierarchy);
    return site.finish();
}

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void write_text(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}
void replace(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = text_of(file);
    const std::size_t at = text.rfind(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text(file, text.replace(at, from.size(), to));
}

/// Views from afar, beside and inside, and one along parallel rays.
std::vector<Camera> views(const Box& box) {
    std::vector<Camera> all{paper_view(box)};
    Orbit near;
    near.distance_radii = 0.7;
    all.push_back(orbit_view(box, near));
    near.distance_radii = 0.1;
    all.push_back(orbit_view(box, near));
    Orbit parallel;
    parallel.orthographic = true;
    all.push_back(orbit_view(box, parallel));
    return all;
}

}  // namespace

TEST(site, every_gaussian_is_a_leaf_of_one_chunk) {
    Gaussians model = random_gaussians(5000, 0.02, 0.05, 3);
    const Hierarchy tree = build_hierarchy(model);
    constexpr std::size_t kRoot = 64, kMost = 128;
    const std::vector<site::Chunk> chunks = site::chunk_tree(tree, model.size(), kRoot, kMost);
    std::vector<int> leaves(model.size()), nodes(tree.size());
    EXPECT_LE(chunks.front().size(), kRoot);
    std::size_t parts = 1;
    for (const site::Chunk& chunk : chunks) {
        EXPECT_LE(chunk.size(), kMost);
        EXPECT_GT(chunk.size(), 0u);
        EXPECT_EQ(chunk.parts.size() > 0, chunk.nodes.size() > 0);
        for (std::uint32_t n = chunk.nodes.first; n < chunk.nodes.last; ++n) ++nodes[n];
        for (const site::Run& run : chunk.leaves)
            for (std::uint32_t i = run.first; i < run.last; ++i) ++leaves[i];
        for (std::uint32_t part = chunk.parts.first; part < chunk.parts.last; ++part)
            EXPECT_EQ(chunks[part].depth, chunk.depth + 1);
        parts += chunk.parts.size();
    }
    EXPECT_EQ(parts, chunks.size());
    EXPECT_TRUE(std::ranges::all_of(leaves, [](int count) { return count == 1; }));
    EXPECT_TRUE(std::ranges::all_of(nodes, [](int count) { return count <= 1; }));
}

TEST(site, a_whole_model_has_its_mass_and_every_gaussian) {
    for (const bool rotated : {true, false}) {
        Gaussians model = random_gaussians(20000, 0.01, 0.03, 5);
        if (!rotated) model.rotation.clear();
        add_random_fields(model, 5);
        model.source = "random numbers";
        const TempDir dir;
        const SiteReport report = write(dir / "site", model);
        EXPECT_EQ(report.gaussians, model.size());
        const Gaussians back = read_model(dir / "site");
        ASSERT_EQ(back.size(), model.size());
        EXPECT_EQ(back.source, model.source);
        EXPECT_EQ(back.fields.names(), model.fields.names());
        EXPECT_NEAR(mass(back) / mass(model), 1, 1e-6);
        // As a compact file of the same steps, whose lattices lie elsewhere.
        const Camera camera = paper_view(view_box(model));
        EXPECT_GT(psnr(model, back, camera, 96), psnr(model, rounded(model, {}), camera, 96) - 2);
    }
}

TEST(site, models_without_density_are_refused) {
    const TempDir dir;
    Gaussians model = random_gaussians(300, 0.1, 0.2, 6);
    model.density[7] = 0;
    EXPECT_NE(refusal([&] { write(dir / "site", model); }).find("has no density"),
              std::string::npos);
    EXPECT_NE(refusal([&] { write(dir / "site", {}); }).find("no Gaussians"), std::string::npos);
}

TEST(site, one_gaussian_and_small_models_are_one_chunk) {
    for (const int count : {1, 2, 100}) {
        const TempDir dir;
        const SiteReport report = write(dir / "site", random_gaussians(count, 0.1, 0.2, 7));
        EXPECT_EQ(report.chunks, 1u);
        EXPECT_EQ(read_site(dir / "site").size(), static_cast<std::size_t>(count));
    }
}

TEST(site, cuts_are_the_whole_models_pictures_at_a_pixel_of_error) {
    const TempDir dir;
    const Gaussians model = cloud();
    const SiteReport report = write(dir / "site", model);
    ASSERT_GE(read_site_info(dir / "site").models.front().levels.size(), 2u);
    SiteCut cut(dir / "site");
    for (const int size : {24, 96})
        for (const Camera& camera : views(model.box)) {
            const Gaussians& chosen = cut.choose(frame_of(camera, size, size));
            EXPECT_GT(psnr(model, chosen, camera, size), 45) << size;
        }
    // A small picture from afar needs the root alone.
    const Gaussians& coarse = cut.choose(frame_of(paper_view(model.box), 16, 16));
    EXPECT_EQ(cut.report().chunks, 1u);
    EXPECT_NEAR(mass(coarse) / mass(model), 1, 1e-5);
    EXPECT_LT(report.root_bytes, 200'000u);
    // With no error allowed, all of the model and no node.
    (void)cut.choose(frame_of(paper_view(model.box), 16, 16), {0, false});
    EXPECT_EQ(cut.report().gaussians, model.size());
}

TEST(site, a_cut_does_not_depend_on_earlier_views_or_on_memory) {
    const TempDir dir;
    const Gaussians model = cloud();
    write(dir / "site", model);
    SiteCut roomy(dir / "site"), narrow(dir / "site", 0, 1);
    for (const Camera& camera : views(model.box))
        for (int turn = 0; turn < 2; ++turn) {
            // A view that needs little lets others' chunks go.
            const int size = turn == 0 ? 200 : 16;
            const CameraFrame frame = frame_of(camera, size, size);
            const Gaussians& a = roomy.choose(frame);
            const Gaussians& b = narrow.choose(frame);
            EXPECT_EQ(a.mean, b.mean);
            EXPECT_EQ(a.density, b.density);
            EXPECT_LE(narrow.report().held_bytes, roomy.report().held_bytes);
        }
    EXPECT_GT(narrow.report().bytes_read, roomy.report().bytes_read);
}

TEST(site, views_that_do_not_wait_refine_to_the_same_cut) {
    const TempDir dir;
    const Gaussians model = cloud();
    write(dir / "site", model);
    const CameraFrame frame = frame_of(paper_view(model.box), 400, 400);
    SiteCut cut(dir / "site"), waiting(dir / "site");
    const Gaussians expected = waiting.choose(frame);
    std::mutex mutex;
    std::condition_variable changed;
    int arrived = 0;
    const auto tell = [&] {
        const std::lock_guard lock(mutex);
        ++arrived;
        changed.notify_all();
    };
    const Gaussians* chosen = &cut.choose_available(frame, {}, tell);
    EXPECT_GT(cut.report().missing, 0u);
    EXPECT_NEAR(mass(*chosen) / mass(model), 1, 1e-5);  // coarser Gaussians stand in
    for (int seen = 0; cut.report().missing > 0;) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return arrived > seen; });
        seen = arrived;
        lock.unlock();
        chosen = &cut.choose_available(frame, {}, tell);
    }
    EXPECT_EQ(chosen->mean, expected.mean);
    EXPECT_EQ(chosen->density, expected.density);
}

TEST(site, a_damaged_chunk_is_refused_or_its_parent_stays) {
    const TempDir dir;
    const Gaussians model = cloud();
    write(dir / "site", model);
    const site::Manifest manifest = site::read_manifest(dir / "site");
    const site::Row& part = manifest.models.front().root.parts.front();
    const fs::path file = site::shapes_path(dir / "site", part.name);
    const std::string whole = text_of(file);
    const CameraFrame frame = frame_of(paper_view(model.box), 400, 400);
    std::string changed = whole;
    changed[whole.size() / 2] = static_cast<char>(changed[whole.size() / 2] ^ 1);
    for (const std::string& text :
         {changed, whole.substr(0, whole.size() / 2), whole + "x", std::string()}) {
        write_text(file, text);
        const std::string message = refusal([&] { SiteCut(dir / "site").choose(frame); });
        EXPECT_EQ(message.find(file.string()), 0u) << message;
        EXPECT_NE(message.find("damaged"), std::string::npos) << message;
        EXPECT_EQ(refusal([&] { (void)read_site(dir / "site"); }), message);
    }
    fs::remove(file);
    EXPECT_NE(refusal([&] { SiteCut(dir / "site").choose(frame); }).find("no such file"),
              std::string::npos);
    SiteCut cut(dir / "site");
    std::mutex mutex;
    std::condition_variable changed_state;
    bool arrived = false;
    const auto tell = [&] {
        const std::lock_guard lock(mutex);
        arrived = true;
        changed_state.notify_all();
    };
    double last = 0;
    for (int turn = 0; turn < 200 && cut.fault().empty(); ++turn) {
        arrived = false;
        last = mass(cut.choose_available(frame, {}, tell));
        std::unique_lock lock(mutex);
        if (cut.fault().empty()) changed_state.wait(lock, [&] { return arrived; });
    }
    EXPECT_NE(cut.fault().find(file.string()), std::string::npos) << cut.fault();
    EXPECT_NEAR(last / mass(model), 1, 1e-5);
}

TEST(site, an_export_is_completed_and_old_chunks_go) {
    const TempDir dir;
    const Gaussians model = cloud();
    const SiteReport first = write(dir / "site", model);
    EXPECT_EQ(first.kept, 0u);
    const std::string manifest = text_of(dir / "site/manifest.json");
    // As after an interruption: no manifest, a part of the chunks.
    fs::remove(dir / "site/manifest.json");
    const std::vector<fs::path> files = files_in(dir / "site/chunks");
    for (std::size_t n = 0; n < files.size(); n += 3) fs::remove(files[n]);
    write_text(dir / "site/chunks/notes.txt", "mine");
    const SiteReport again = write(dir / "site", model);
    EXPECT_GT(again.kept, 0u);
    EXPECT_LT(again.kept, first.chunks);
    EXPECT_EQ(text_of(dir / "site/manifest.json"), manifest);
    EXPECT_EQ(again.removed, 0u);
    const SiteReport other = write(dir / "site", random_gaussians(50, 0.1, 0.2, 9));
    EXPECT_EQ(other.removed, files.size());
    EXPECT_TRUE(fs::exists(dir / "site/chunks/notes.txt"));
}

TEST(site, models_are_steps_and_shared_chunks_are_written_once) {
    const TempDir dir;
    SiteWriter site(dir / "site");
    Gaussians model = random_gaussians(300, 0.1, 0.2, 11),
              other = random_gaussians(200, 0.1, 0.2, 12);
    for (Gaussians* step : {&model, &other, &model}) {
        const Hierarchy hierarchy = build_hierarchy(*step);
        site.add("step", *step, hierarchy);
    }
    site.finish(true);
    const SiteInfo info = read_site_info(dir / "site");
    EXPECT_TRUE(info.steps);
    ASSERT_EQ(info.models.size(), 3u);
    EXPECT_EQ(files_in(dir / "site/chunks").size(), 2u);
    EXPECT_EQ(read_site(dir / "site", 1).size(), 200u);
    EXPECT_EQ(read_site(dir / "site", 2).size(), 300u);
    EXPECT_NE(refusal([&] { (void)read_site(dir / "site", 3); }).find("model 3, expected below 3"),
              std::string::npos);
}

TEST(site, one_export_at_a_time_writes_into_a_folder) {
    const TempDir dir;
    Gaussians model = random_gaussians(200, 0.1, 0.2, 11);
    {
        SiteWriter site(dir / "site");
        EXPECT_NE(refusal([&] {
                      SiteWriter other(dir / "site");
                  }).find("another export writes into this folder"),
                  std::string::npos);
        SiteWriter elsewhere(dir / "elsewhere");
        site.add("a", model, build_hierarchy(model));
        site.finish();
    }
    SiteWriter again(dir / "site");
    again.add("a", model, build_hierarchy(model));
    EXPECT_EQ(again.finish().kept, 1u);
}

TEST(site, files_of_others_stay_where_no_site_was) {
    const TempDir dir;
    std::filesystem::create_directories(dir / "site/chunks");
    const auto foreign = dir / "site/chunks/0123456789abcdef0123456789abcdef.vogz";
    std::ofstream(foreign) << "mine";
    Gaussians model = random_gaussians(200, 0.1, 0.2, 11);
    for (const bool stays : {true, false}) {
        SiteWriter site(dir / "site");
        site.add("a", model, build_hierarchy(model));
        EXPECT_EQ(site.finish().removed, stays ? 0u : 1u);
        EXPECT_EQ(std::filesystem::exists(foreign), stays);
    }
}

TEST(site, models_have_paths) {
    const TempDir dir;
    const auto write_site = [&](const std::vector<std::string>& names) {
        SiteWriter site(dir / "site");
        for (std::size_t n = 0; n < names.size(); ++n) {
            Gaussians model = random_gaussians(100 + static_cast<int>(n), 0.1, 0.2, 11);
            site.add(names[n], model, build_hierarchy(model));
        }
        site.finish();
    };
    const auto names_of = [&] {
        std::vector<std::string> names;
        for (const auto& path : models_of_site(dir / "site"))
            names.push_back(path.filename().string());
        return names;
    };
    // A file of that name, no plain name, a name twice: by the place.
    write_site({"step_1", "chunks", "a/b", "twice", "twice", "", "."});
    EXPECT_EQ(names_of(), (std::vector<std::string>{"step_1", "#2", "#3", "#4", "#5", "#6", "#7"}));
    std::size_t n = 0;
    for (const auto& path : models_of_site(dir / "site")) {
        ASSERT_TRUE(find_site(path)) << path;
        EXPECT_EQ(find_site(path)->model, n);
        EXPECT_EQ(read_model(path).size(), 100 + n++);
    }
    EXPECT_EQ(find_site(dir / "site/")->model, 0u);
    for (const char* other : {"site/#0", "site/#8", "site/#1x", "site/none", "site/chunks",
                              "site/manifest.json", "elsewhere/#1"})
        EXPECT_FALSE(find_site(dir / other)) << other;
    write_site({"other"});
    EXPECT_EQ(names_of(), std::vector<std::string>{"other"});
    EXPECT_EQ(models_of_site(dir / "site/"), models_of_site(dir / "site"));
}

TEST(site, bytes_stay_near_those_of_one_compact_file) {
    const TempDir dir;
    Gaussians model = cloud();
    const SiteReport report = write(dir / "site", model);
    const Hierarchy hierarchy = build_hierarchy(model);
    const VogzReport file = write_vogz(dir / "model.vogz", model, hierarchy, {{}, true});
    // Issue: within 15 % of the single file. This model's few chunks have as many headers for a sixth of the bytes.
    EXPECT_LT(static_cast<double>(report.bytes), 1.15 * static_cast<double>(file.bytes));
}

TEST(site, folders_of_others_are_left_alone) {
    const TempDir dir;
    fs::create_directories(dir / "site");
    write_text(dir / "site/index.html", "mine");
    EXPECT_NE(refusal([&] { SiteWriter site(dir / "site"); }).find("no manifest of a site"),
              std::string::npos);
    EXPECT_EQ(text_of(dir / "site/index.html"), "mine");
    write_text(dir / "site/manifest.json", "{\"name\": \"an app\"}");
    EXPECT_NE(refusal([&] { SiteWriter site(dir / "site"); }).find("no manifest of a site"),
              std::string::npos);
    write_text(dir / "file", "");
    EXPECT_NE(refusal([&] { SiteWriter site(dir / "file"); }).find("cannot be made"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  SiteWriter site(dir / "new", {2, 0.1});
              }).find("step 2"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(dir / "new"));
    EXPECT_NE(refusal([&] { SiteWriter(dir / "other").finish(); }).find("no model"),
              std::string::npos);
}

TEST(site, forged_manifests_are_refused) {
    const TempDir dir;
    write(dir / "site", cloud());
    const fs::path file = dir / "site/manifest.json";
    const std::string summed = text_of(file);
    const std::string root = site::read_manifest(dir / "site").models.front().root.name;
    // Any changed byte is noticed, but for those of the checksum's key; a text without one is checked number by number.
    const std::size_t end = summed.rfind(",\"crc\":");
    ASSERT_LT(end, summed.size());
    const std::string whole = summed.substr(0, end) + "}\n";
    write_text(file, whole);
    EXPECT_NO_THROW((void)read_site(dir / "site"));
    for (std::size_t at = 0; at < summed.size(); at += at < end ? 7 : 1) {
        if (at >= end && at < end + 7) continue;
        std::string changed = summed;
        changed[at] = static_cast<char>(changed[at] ^ 1);
        write_text(file, changed);
        EXPECT_THROW((void)site::read_manifest(dir / "site"), Error) << at;
    }
    const auto refused = [&](const std::string& from, const std::string& to,
                             const std::string& words) {
        write_text(file, whole);
        replace(file, from, to);
        const std::string message = refusal([&] { (void)read_site(dir / "site"); });
        EXPECT_EQ(message.find((dir / "site").string()), 0u) << message;
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    };
    refused(root, "../../../../etc/passwd0000000000", "no name of a chunk");
    refused(root, root.substr(1) + "G", "no name of a chunk");
    refused("\"version\":1", "\"version\":2", "version 2, expected 1");
    refused("\"gaussians\":", "\"gaussians\":1", "");
    refused("\"nodes\":", "\"nodes\":-", "nodes");
    refused("\"error\":", "\"error\":-1", "an error of");
    refused("\"parts\":[", "\"parts\":[], \"table\":[", "another type");
    for (const std::size_t size : {whole.size() / 2, whole.size() - 3, std::size_t{0}}) {
        write_text(file, whole.substr(0, size));
        EXPECT_NE(refusal([&] { (void)read_site(dir / "site"); }).find("not JSON from byte"),
                  std::string::npos);
    }
    // Rows nested without end.
    std::string deep = whole;
    const std::size_t at = deep.find("\"parts\":[") + 9;
    std::string nested;
    for (int n = 0; n < 200; ++n)
        nested +=
            "{\"name\":\"" + root +
            R"(","nodes":1,"gaussians":1,"error":1,"box":[0,0,0,1,1,1],"bytes":[1,1],"parts":[)";
    write_text(file, deep.insert(at, nested));
    EXPECT_NE(refusal([&] { (void)read_site(dir / "site"); }), "no error");
}

TEST(site, names_are_hexadecimal_digits_of_the_content) {
    const std::vector<std::string> one{"ab", "c"}, other{"a", "bc"}, third{"abd"};
    EXPECT_EQ(site::content_name(one), site::content_name(other));
    EXPECT_NE(site::content_name(one), site::content_name(third));
    EXPECT_TRUE(site::is_content_name(site::content_name(one)));
    for (const char* text :
         {"", "..", "0123456789abcdef0123456789abcdeF", "0123456789abcdef0123456789abcde/"})
        EXPECT_FALSE(site::is_content_name(text)) << text;
}

}  // namespace vog::test
