// subtree_test.cpp: trees of chunks of parts of a model: as messages, as one chunk, under nodes of their own.
#include "io/site/tree/subtree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "io/site/chunk_file.h"
#include "io/site/tree/subtree_message.h"
#include "support/data.h"
#include "support/field_models.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog::test {

using namespace site;

namespace {

namespace fs = std::filesystem;

/// A site's folder whose chunks are written.
struct Chunks {
    explicit Chunks(const fs::path& at) : folder(at) { fs::create_directories(at / kChunksName); }
    ChunkFolder folder;
};

Coding coding_of(const Gaussians& model) {
    return {{}, !model.axis_aligned(), field_roundings(model.fields, VogzPrecision{}.field_step)};
}
Hierarchy built(Gaussians& model) { return build_hierarchy(model); }

/// Runs of a model's Gaussians, along x.
std::vector<Gaussians> parts_of(const Gaussians& model, std::size_t count) {
    std::vector<std::size_t> order(model.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::ranges::sort(order, {}, [&](std::size_t n) { return model.mean[n].x; });
    std::vector<Gaussians> parts;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t begin = k * order.size() / count, end = (k + 1) * order.size() / count;
        parts.push_back(select(model, std::span(order).subspan(begin, end - begin)));
    }
    return parts;
}

std::vector<Subtree> trees_of(ChunkFolder& folder, const Gaussians& model, std::size_t count) {
    std::vector<Subtree> trees;
    for (Gaussians& part : parts_of(model, count)) {
        const Hierarchy hierarchy = build_hierarchy(part);
        trees.push_back(write_tree(folder, coding_of(model), part, hierarchy, true));
    }
    return trees;
}

/// Writes the manifest of a tree as a site.
void finish(ChunkFolder& folder, const Gaussians& model, Subtree tree) {
    write_root(folder, coding_of(model), tree);
    Manifest manifest;
    ManifestModel about{"parts",      select(model, {}),      !model.axis_aligned(),
                        model.size(), std::move(tree.levels), std::move(tree.row)};
    manifest.models.push_back(std::move(about));
    std::ofstream(folder.site() / kManifestName) << manifest_text(manifest);
}

}  // namespace

TEST(subtree, parts_that_fit_are_one_chunk) {
    const TempDir temporary;
    const Gaussians model = random_gaussians(3000, 0.02, 0.05, 3);
    Chunks chunks(temporary / "site");
    const Subtree tree =
        joined(chunks.folder, coding_of(model), trees_of(chunks.folder, model, 3), 8192, built);
    EXPECT_EQ(tree.row.gaussians, 3000u);
    EXPECT_EQ(tree.row.nodes, 0u);
    EXPECT_EQ(tree.levels.size(), 1u);
    EXPECT_TRUE(chunks.folder.files().empty());
    EXPECT_NEAR(mass(tree.chunk), mass(model), 1e-6 * mass(model));
    finish(chunks.folder, model, tree);
    EXPECT_EQ(read_site(temporary / "site").size(), model.size());
}

TEST(subtree, nodes_stand_for_parts_that_do_not_fit) {
    const TempDir temporary;
    const Gaussians model = random_gaussians(40000, 0.01, 0.02, 3);
    Chunks chunks(temporary / "site");
    constexpr std::size_t kMost = 1000;
    const Subtree tree =
        joined(chunks.folder, coding_of(model), trees_of(chunks.folder, model, 2), kMost, built);
    EXPECT_LE(tree.row.gaussians, kMost);
    EXPECT_EQ(tree.row.nodes, tree.row.gaussians);
    ASSERT_EQ(tree.row.parts.size(), 2u);
    EXPECT_NEAR(mass(tree.chunk), mass(model), 1e-5 * mass(model));
    for (const Row& part : tree.row.parts) {
        EXPECT_LE(part.error, tree.row.error);
        EXPECT_FALSE(part.table.empty());
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_GE(part.box[k], tree.row.box[k]);
            EXPECT_LE(part.box[k + 3], tree.row.box[k + 3]);
        }
    }
    EXPECT_EQ(tree.levels[0].chunks, 1u);
    EXPECT_EQ(tree.levels[1].chunks, 2u);
    finish(chunks.folder, model, tree);
    const Gaussians whole = read_site(temporary / "site");
    EXPECT_EQ(whole.size(), model.size());
    EXPECT_NEAR(mass(whole), mass(model), 1e-3 * mass(model));
}

TEST(subtree, none_of_no_parts) {
    const TempDir temporary;
    Chunks chunks(temporary / "site");
    EXPECT_EQ(joined(chunks.folder, {}, std::vector<Subtree>(3), 10, built).row.gaussians, 0u);
    EXPECT_TRUE(message_of(Subtree{}).empty());
    EXPECT_EQ(subtree_of("", {}).row.gaussians, 0u);
}

TEST(subtree, messages_have_all_of_it_and_are_refused_where_cut_short) {
    const TempDir temporary;
    Chunks chunks(temporary / "site");
    Gaussians model = random_gaussians(20000, 0.01, 0.02, 3);
    add_random_fields(model, 3);
    const Subtree tree = trees_of(chunks.folder, model, 1).front();
    ASSERT_FALSE(tree.row.parts.empty());
    const std::string message = message_of(tree);
    const Subtree read = subtree_of(message, model);
    EXPECT_EQ(message_of(read), message);
    EXPECT_EQ(read.row.parts.back().name, tree.row.parts.back().name);
    EXPECT_EQ(read.chunk.mean.size(), tree.chunk.mean.size());
    EXPECT_EQ(read.levels.size(), tree.levels.size());
    for (std::size_t size = 1; size < message.size(); size += 1 + size / 8)
        EXPECT_THROW(subtree_of(message.substr(0, size), model), Error) << size;
}

}  // namespace vog::test
