// ply_fields_test.cpp: exact round trips of fields, of parts and nodes; refused headers.
#include <gtest/gtest.h>

#include <fstream>

#include "support/data.h"
#include "support/field_models.h"
#include "support/image_bytes.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/lod.h"
#include "vog/ply.h"

namespace vog::test {

namespace {

/// Error of reading a file in which `from` is replaced by `to`.
std::string error_of_changed(const std::filesystem::path& file, const std::string& from,
                             const std::string& to) {
    std::string bytes = read_bytes(file);
    const std::size_t at = bytes.find(from);
    if (at == std::string::npos) return "nothing to replace";
    bytes.replace(at, from.size(), to);
    const std::filesystem::path changed = file.parent_path() / "changed.ply";
    std::ofstream(changed, std::ios::binary) << bytes;
    try {
        read_ply(changed);
    } catch (const Error& error) {
        const std::string text = error.what();
        return text.substr(text.find("changed.ply: ") + 13);
    }
    return "no error";
}

Gaussians model_with_fields(int count, std::uint64_t seed) {
    Gaussians model = random_gaussians(count, 0.1, 0.2, seed);
    add_random_fields(model, seed);
    return model;
}

}  // namespace

TEST(ply_fields, come_back_bit_for_bit_under_their_names) {
    const TempDir dir;
    Gaussians plain = model_with_fields(40, 1);
    plain.rotation.clear();
    Gaussians measured = model_with_fields(5, 4);
    measured.fields.scalar.back().is_measure = true;
    measured.fields.scalar.back().background = -1000.1;
    // More than a block of rows; no rows.
    for (const Gaussians& model :
         {model_with_fields(70000, 2), measured, plain, select(plain, {})}) {
        write_ply(dir / "m.ply", model);
        expect_same_fields(read_ply(dir / "m.ply").fields, model.fields);
        EXPECT_EQ(read_ply(dir / "m.ply").density, model.density);
        EXPECT_EQ(std::filesystem::file_size(dir / "m.ply"), ply_bytes(model));
    }
    const std::string bytes = read_bytes(dir / "m.ply");
    for (const char* line :
         {"comment field scalar temperature -0.3333333333333333 1500.1 K\n",
          "comment field scalar density 0 1e+300\n",
          "comment field vector gas%20velocity 0 0.1 10%25%20of%20%C2%B5m%20s-1\n",
          "property float density\nproperty float temperature\nproperty float temperature_gx\n",
          "property float temperature_skew\nproperty float density_value\n",
          "property float gas%20velocity_z_gz\nproperty float gas%20velocity_xx\n"})
        EXPECT_NE(bytes.find(line), std::string::npos) << line;
}

TEST(ply_fields, are_read_in_any_order_of_properties_and_by_parts) {
    const TempDir dir;
    const Gaussians model = model_with_fields(1000, 3);
    write_ply(dir / "m.ply", model);
    Gaussians joined;
    for (int part = 0; part < 3; ++part)
        append(joined, read_ply(dir / "m.ply", ModelPart{part, 3}));
    expect_same_fields(joined.fields, model.fields);

    // Values follow their names: two properties change places.
    std::string bytes = read_bytes(dir / "m.ply");
    const std::string gx = "property float temperature_gx\n",
                      gy = "property float temperature_gy\n";
    bytes.replace(bytes.find(gx + gy), gx.size() + gy.size(), gy + gx);
    std::ofstream(dir / "turned.ply", std::ios::binary) << bytes;
    const Gaussians turned = read_ply(dir / "turned.ply");
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3f g = model.fields.scalar[0].gradient[i];
        ASSERT_EQ(turned.fields.scalar[0].gradient[i], (Vec3f{g.y, g.x, g.z}));
    }
}

TEST(ply_fields, of_nodes_come_back_bit_for_bit) {
    const TempDir dir;
    Gaussians plain = model_with_fields(500, 4);
    plain.rotation.clear();
    // One Gaussian has no nodes.
    for (Gaussians model : {model_with_fields(3000, 5), plain, model_with_fields(1, 9)}) {
        const Hierarchy tree = build_hierarchy(model);
        write_ply(dir / "m.ply", model, tree);
        EXPECT_EQ(std::filesystem::file_size(dir / "m.ply"), ply_bytes(model, tree));
        Hierarchy back;
        expect_same_fields(read_ply(dir / "m.ply", &back).fields, model.fields);
        expect_same_fields(back.nodes.fields, tree.nodes.fields);
        EXPECT_EQ(back.error, tree.error);
        EXPECT_EQ(back.leaf_count, tree.leaf_count);
        if (tree.empty()) continue;
        Hierarchy without = tree;
        without.nodes.fields = {};
        EXPECT_THROW(write_ply(dir / "n.ply", model, without), Error);
    }
}

TEST(ply_fields, names_that_tell_layouts_apart_are_names_of_fields_too) {
    const TempDir dir;
    Gaussians model = model_with_fields(5, 6);
    for (const char* name : {"opacity", "sigmat", "x", "scale_0", "error", "nx", "f_dc_0"}) {
        model.fields.scalar[1].name = name;
        const Hierarchy tree = build_hierarchy(model);
        write_ply(dir / "m.ply", model, tree);
        Hierarchy back;
        expect_same_fields(read_ply(dir / "m.ply", &back).fields, model.fields);
        expect_same_fields(back.nodes.fields, tree.nodes.fields);
    }
}

TEST(ply_fields, what_does_not_fit_is_refused_by_name) {
    const TempDir dir;
    Gaussians model = model_with_fields(20, 7);
    const Hierarchy tree = build_hierarchy(model);
    write_ply(dir / "m.ply", model, tree);
    const auto refused = [&](const std::string& from, const std::string& to) {
        return error_of_changed(dir / "m.ply", from, to);
    };
    EXPECT_EQ(refused("property float temperature\n", "property float heat\n"),
              "unknown property 'heat'");
    EXPECT_EQ(refused("comment field scalar temperature -0.3333333333333333 1500.1 K\n", ""),
              "unknown property 'temperature'");
    EXPECT_EQ(refused("property float temperature_gx\n", ""),
              "no property 'temperature_gx', expected those of field 'temperature': 6 in all");
    EXPECT_EQ(
        refused("comment field vector", "comment field scalar heat 0 1\ncomment field vector"),
        "no property 'heat', expected those of field 'heat': 6 in all");
    EXPECT_EQ(refused("temperature -0.3", "density -0.3"),
              "two fields 'density', expected one of each name");
    EXPECT_EQ(refused("1500.1 K", "-1500.1 K"),
              "field 'temperature': range -0.3333333333333333 to -1500.1, expected finite and in "
              "this order");
    const std::string form =
        ": expected 'field', 'scalar', 'measure' or 'vector', a name, its range as two numbers, "
        "and its unit "
        "or "
        "nothing";
    EXPECT_EQ(refused("1500.1 K", "1500.1K K"),
              "comment 'field scalar temperature -0.3333333333333333 1500.1K K'" + form);
    EXPECT_EQ(refused("1500.1 K", "1500.1 K C"),
              "comment 'field scalar temperature -0.3333333333333333 1500.1 K C'" + form);
    EXPECT_EQ(refused("field scalar density 0 1e+300", "field scalar density 0"),
              "comment 'field scalar density 0'" + form);
    EXPECT_EQ(refused("field scalar density", "field tensor density"),
              "comment 'field tensor density 0 1e+300'" + form);
    EXPECT_EQ(refused("1500.1 K", "1500.1 %4"),
              "comment 'field scalar temperature -0.3333333333333333 1500.1 %4'" + form);
    EXPECT_EQ(refused("1500.1 K", "1500.1 %4B"),
              "comment 'field scalar temperature -0.3333333333333333 1500.1 %4B'" + form);
    EXPECT_EQ(refused("comment field vector", "comment background heat 1\ncomment field vector"),
              "comment 'background heat 1'" + form);
    EXPECT_EQ(refused("comment field vector", "comment background density x\ncomment field vector"),
              "comment 'background density x'" + form);
    EXPECT_EQ(
        refused("comment field vector", "comment background density inf\ncomment field vector"),
        "field 'density': background inf, expected a finite number");
    // The nodes' properties are those of the vertices.
    std::string bytes = read_bytes(dir / "m.ply");
    const std::string line = "property float temperature_sd\n";
    const std::size_t second = bytes.find(line, bytes.find(line) + 1);
    ASSERT_NE(second, std::string::npos);
    std::ofstream(dir / "short.ply", std::ios::binary) << bytes.erase(second, line.size());
    EXPECT_THROW(read_ply(dir / "short.ply"), Error);
}

TEST(ply_fields, more_than_a_header_holds_are_refused_before_writing) {
    const TempDir dir;
    Gaussians model = random_gaussians(1, 0.1, 0.2, 8);
    add_random_fields(model, 8);
    for (int n = 0; n < 600; ++n) {
        model.fields.scalar.push_back(model.fields.scalar[0]);
        model.fields.scalar.back().name = "t" + std::to_string(n);
    }
    EXPECT_THROW(write_ply(dir / "m.ply", model), Error);
    model.fields.scalar.resize(500);
    write_ply(dir / "m.ply", model);
    expect_same_fields(read_ply(dir / "m.ply").fields, model.fields);
}

}  // namespace vog::test
