// vogz_tree_test.cpp: trees of compact files with levels: children of one chunk in chunks of their own, errors, files without a tree,
// refused trees.
#include <gtest/gtest.h>

#include "io/byte_source.h"
#include "io/vogz/file_table.h"
#include "support/data.h"
#include "support/field_models.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/vogz.h"

namespace vog::test {

namespace {

using namespace vogz;

FileTable table_of(const std::filesystem::path& file) {
    FileBytes bytes(file);
    return read_table(bytes, bytes.size());
}

/// Bytes of a file behind its header.
std::string body_of(const std::filesystem::path& file) {
    return read_bytes(file).substr(table_of(file).body_offset);
}

/// A run of Gaussians or nodes, and its place in the order of its kind.
struct FileRun {
    const Blob* blob;
    std::size_t begin;
};
std::vector<FileRun> runs_of(const FileTable& table) {
    std::vector<FileRun> runs;
    std::size_t nodes = 0, leaves = 0;
    for (const Blob& blob : table.blobs) {
        if (blob.kind != Kind::nodes && blob.kind != Kind::gaussians) continue;
        std::size_t& next = blob.kind == Kind::nodes ? nodes : leaves;
        runs.push_back({&blob, next});
        next += blob.count;
    }
    return runs;
}

}  // namespace

TEST(vogz_tree, each_chunk_holds_children_of_one) {
    const TempDir dir;
    for (const int count : {2, 9, 4000, 90000}) {
        Gaussians model = random_gaussians(count, 0.01, 0.03, 21);
        add_random_fields(model, 21);
        const Hierarchy hierarchy = build_hierarchy(model);
        write_vogz(dir / "m.vogz", model, hierarchy, {{}, true});
        const FileTable table = table_of(dir / "m.vogz");
        const std::vector<FileRun> runs = runs_of(table);
        ASSERT_EQ(table.tree.size(), runs.size());
        EXPECT_EQ(read_vogz_info(dir / "m.vogz").not_streamed, "");
        std::size_t children = 0;
        for (std::size_t n = 0; n < runs.size(); ++n) {
            const auto [blob, begin] = runs[n];
            const bool nodes = blob->kind == Kind::nodes;
            EXPECT_LE(blob->count, 8192u);
            for (std::size_t i = begin; nodes && i < begin + blob->count; ++i)
                EXPECT_GE(table.tree[n].error, hierarchy.error[i]);
            if (n == 0) {
                EXPECT_TRUE(nodes && !table.tree[n].parent);
                continue;
            }
            ASSERT_TRUE(table.tree[n].parent && *table.tree[n].parent < n);
            EXPECT_LE(table.tree[n].error, table.tree[*table.tree[n].parent].error);
            const auto [above, first] = runs[*table.tree[n].parent];
            const std::size_t last = first + above->count - 1;
            const auto& start = nodes ? hierarchy.first_node : hierarchy.first_leaf;
            const auto& counts = nodes ? hierarchy.node_count : hierarchy.leaf_count;
            EXPECT_GE(begin, start[first]);
            EXPECT_LE(begin + blob->count, std::size_t{start[last]} + counts[last]);
            children += blob->count;
        }
        EXPECT_EQ(children, model.size() + hierarchy.size() - 1);
    }
}

TEST(vogz_tree, parts_of_a_chunk_lie_side_by_side) {
    const TempDir dir;
    Gaussians model = random_gaussians(90000, 0.01, 0.03, 22);
    write_vogz(dir / "m.vogz", model, build_hierarchy(model), {{}, true});
    const FileTable table = table_of(dir / "m.vogz");
    for (std::size_t n = 2; n < table.tree.size(); ++n)
        EXPECT_GE(*table.tree[n].parent, *table.tree[n - 1].parent);
}

TEST(vogz_tree, files_without_a_tree_are_read) {
    const TempDir dir;
    Gaussians model = random_gaussians(30000, 0.01, 0.03, 23);
    write_vogz(dir / "m.vogz", model, build_hierarchy(model), {{}, true});
    FileTable table = table_of(dir / "m.vogz");
    table.tree.clear();
    const std::string header = header_bytes(table);
    EXPECT_EQ(header[8], 1);
    EXPECT_EQ(header[10], 0);  // 1.0: as earlier writers
    write_bytes(dir / "old.vogz", header + body_of(dir / "m.vogz"));
    Hierarchy now, old;
    EXPECT_EQ(read_vogz(dir / "m.vogz", &now).mean, read_vogz(dir / "old.vogz", &old).mean);
    EXPECT_EQ(now.node_count, old.node_count);
    EXPECT_NE(read_vogz_info(dir / "old.vogz").not_streamed.find("without the tree"),
              std::string::npos);
    write_vogz(dir / "zstd.vogz", model, build_hierarchy(model));
    EXPECT_NE(read_vogz_info(dir / "zstd.vogz").not_streamed.find("zstd"), std::string::npos);
    write_vogz(dir / "flat.vogz", model, {}, {{}, true});
    EXPECT_TRUE(table_of(dir / "flat.vogz").tree.empty());
    EXPECT_NE(read_vogz_info(dir / "flat.vogz").not_streamed.find("--hierarchy --deflate"),
              std::string::npos);
}

TEST(vogz_tree, trees_of_other_files_are_refused) {
    const TempDir dir;
    Gaussians model = random_gaussians(30000, 0.01, 0.03, 24);
    write_vogz(dir / "m.vogz", model, build_hierarchy(model), {{}, true});
    const FileTable whole = table_of(dir / "m.vogz");
    const std::string body = body_of(dir / "m.vogz");
    const auto last = static_cast<std::uint32_t>(whole.tree.size() - 1);
    const auto refused = [&](const auto& change) {
        FileTable table = whole;
        change(table.tree);
        write_bytes(dir / "changed.vogz", header_bytes(table) + body);
        return refusal([&] { read_vogz(dir / "changed.vogz"); });
    };
    EXPECT_EQ(refused([](auto&) {}), "no error");
    const std::string belongs = "does not belong to chunk";
    EXPECT_NE(refused([&](auto& tree) { tree[last].parent = 0; }).find(belongs), std::string::npos);
    EXPECT_NE(refused([&](auto& tree) { tree[last].parent = last; }).find("has the parent"),
              std::string::npos);
    EXPECT_NE(refused([&](auto& tree) { tree[1].error = 2 * tree[0].error + 1; }).find(belongs),
              std::string::npos);
    for (const double error : {-1.0, 1.0})
        EXPECT_NE(refused([&](auto& tree) { tree[last].error = error; }).find("has the error"),
                  std::string::npos);
    EXPECT_NE(refused([&](auto& tree) { tree[last].parent.reset(); }).find("lacks a parent"),
              std::string::npos);
    EXPECT_NE(refused([&](auto& tree) { tree.pop_back(); }).find("chunks, expected"),
              std::string::npos);
}

}  // namespace vog::test
