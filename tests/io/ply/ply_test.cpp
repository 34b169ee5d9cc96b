// ply_test.cpp: exact round trips of models, layouts of 3DGS and volprim, refused files.
#include "vog/ply.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "support/data.h"
#include "support/image_bytes.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog::test {

namespace {

std::string ply_error(const std::filesystem::path& file) {
    try {
        read_ply(file);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

Gaussians labelled(Gaussians model) {
    model.box = {{-1.1, -1, -1}, {1, 1, 1.0 / 3}};
    model.source = "smoke.vdb density";
    model.source_voxels = 1049275;
    model.method = "paper";
    model.options = "--set strategy=smart --set dense-block=2";
    model.summary = "mass ratio 1.00000";
    return model;
}

/// PLY with the given float32 properties and one row.
std::string one_row(const std::vector<std::pair<std::string, float>>& properties,
                    const std::string& comments = "") {
    std::string text = "ply\nformat binary_little_endian 1.0\n" + comments + "element vertex 1\n";
    for (const auto& [name, value] : properties) text += "property float " + name + "\n";
    text += "end_header\n";
    for (const auto& [name, value] : properties) {
        char bytes[4];
        std::memcpy(bytes, &value, 4);
        text.append(bytes, 4);
    }
    return text;
}

}  // namespace

TEST(ply, models_come_back_bit_for_bit) {
    const TempDir dir;
    Gaussians plain = random_gaussians(1000, 1e-6, 1, 1);
    plain.rotation.clear();
    Gaussians far = plain;
    far.origin = {5000000.1, -1e9, 1.0 / 3};
    for (const Gaussians& model : {labelled(random_gaussians(70000, 1e-6, 1, 2, 3.0349f)),
                                   labelled(plain), labelled(far), labelled(Gaussians{})}) {
        write_ply(dir / "m.ply", model);
        const Gaussians back = read_ply(dir / "m.ply");
        EXPECT_EQ(back.origin, model.origin);
        EXPECT_EQ(back.mean, model.mean);
        EXPECT_EQ(back.scale, model.scale);
        EXPECT_EQ(back.rotation, model.rotation);
        EXPECT_EQ(back.density, model.density);
        EXPECT_EQ(back.cutoff, model.cutoff);
        EXPECT_EQ(back.box, model.box);
        EXPECT_EQ(back.source, model.source);
        EXPECT_EQ(back.source_voxels, model.source_voxels);
        EXPECT_EQ(back.method, model.method);
        EXPECT_EQ(back.options, model.options);
        EXPECT_EQ(back.summary, model.summary);
        EXPECT_EQ(std::filesystem::file_size(dir / "m.ply"), ply_bytes(model));
    }
}

TEST(ply, hierarchies_come_back_bit_for_bit_and_may_be_left_unread) {
    const TempDir dir;
    Gaussians plain = random_gaussians(500, 0.01, 0.1, 6);
    plain.rotation.clear();
    plain.origin = {1e9, 0, 0.1};
    for (Gaussians model : {random_gaussians(3000, 0.01, 0.1, 7), plain}) {
        const Hierarchy tree = build_hierarchy(model);
        write_ply(dir / "m.ply", model, tree);
        EXPECT_EQ(std::filesystem::file_size(dir / "m.ply"), ply_bytes(model, tree));
        Hierarchy back;
        EXPECT_EQ(read_ply(dir / "m.ply", &back).mean, model.mean);
        EXPECT_EQ(back.nodes.origin, model.origin);
        EXPECT_EQ(back.nodes.mean, tree.nodes.mean);
        EXPECT_EQ(back.nodes.scale, tree.nodes.scale);
        EXPECT_EQ(back.nodes.rotation, tree.nodes.rotation);
        EXPECT_EQ(back.nodes.density, tree.nodes.density);
        EXPECT_EQ(back.nodes.cutoff, model.cutoff);
        EXPECT_EQ(back.first_node, tree.first_node);
        EXPECT_EQ(back.first_leaf, tree.first_leaf);
        EXPECT_EQ(back.node_count, tree.node_count);
        EXPECT_EQ(back.leaf_count, tree.leaf_count);
        EXPECT_EQ(back.radius, tree.radius);
        EXPECT_EQ(back.error, tree.error);
        EXPECT_EQ(read_ply(dir / "m.ply").density, model.density);
        Hierarchy twice = tree;
        append(twice, tree, model.size());
        Gaussians both = model;
        append(both, model);
        EXPECT_THROW(write_ply(dir / "both.ply", both, twice), Error);  // not in one order
        write_ply(dir / "m.ply", model);
        read_ply(dir / "m.ply", &back);
        EXPECT_TRUE(back.empty());
    }
}

TEST(ply, a_truncated_or_foreign_hierarchy_throws) {
    const TempDir dir;
    Gaussians model = random_gaussians(20, 0.1, 1, 8);
    const Hierarchy tree = build_hierarchy(model);
    write_ply(dir / "whole.ply", model, tree);
    const std::string bytes = read_bytes(dir / "whole.ply");
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        write_bytes(dir / "cut.ply", bytes.substr(0, length));
        ASSERT_NE(ply_error(dir / "cut.ply").find("cut.ply: "), std::string::npos) << length;
    }
    const auto error_with = [&](const std::string& from, const std::string& to) {
        std::string changed = bytes;
        changed.replace(changed.find(from), from.size(), to);
        write_bytes(dir / "changed.ply", changed);
        return ply_error(dir / "changed.ply");
    };
    const std::string element = "element node " + std::to_string(tree.size());
    EXPECT_NE(error_with(element, "element node 4611686018427387904").find("truncated"),
              std::string::npos);
    EXPECT_NE(error_with(element, "element node").find("count"), std::string::npos);
    EXPECT_NE(error_with(element, "element face 3").find("element 'face'"), std::string::npos);
    EXPECT_NE(error_with("property float radius", "property float width").find("element 'node'"),
              std::string::npos);
    EXPECT_NE(error_with("property uchar nodes", "property uint nodes").find("element 'node'"),
              std::string::npos);
}

TEST(ply, a_hierarchy_spoiled_anywhere_ends_in_one_line_or_is_one) {
    const TempDir dir;
    Gaussians model = random_gaussians(40, 0.1, 1, 9);
    const Hierarchy tree = build_hierarchy(model);
    write_ply(dir / "whole.ply", model, tree);
    const std::string bytes = read_bytes(dir / "whole.ply");
    const std::size_t begin = ply_bytes(model, tree) - tree.size() * 54;
    for (std::size_t at = begin; at < bytes.size(); ++at)
        for (const char with : {'\xff', '\x7f', '\0'}) {
            std::string spoiled = bytes;
            spoiled[at] = with;
            write_bytes(dir / "spoiled.ply", spoiled);
            try {
                Hierarchy read;
                const Gaussians back = read_ply(dir / "spoiled.ply", &read);
                validate(read, back, "read");
            } catch (const Error& error) {
                const std::string what = error.what();
                ASSERT_NE(what.find("spoiled.ply: "), std::string::npos) << what;
                ASSERT_EQ(what.find('\n'), std::string::npos) << what;
            }
        }
}

TEST(ply, parts_together_are_the_whole) {
    const TempDir dir;
    Gaussians model;
    for (int n = 0; n < 7; ++n) {
        const auto x = static_cast<float>(n);
        model.mean.push_back({x, 2 * x, 3 * x});
        model.scale.push_back({1 + x, 1, 2});
        model.density.push_back(x);
    }
    model = labelled(model);
    write_ply(dir / "m.ply", model);
    for (const int count : {1, 2, 3, 7, 9}) {
        Gaussians all;
        for (int index = 0; index < count; ++index) {
            const Gaussians part = read_ply(dir / "m.ply", {index, count});
            EXPECT_EQ(part.box, model.box);
            append(all, part);
        }
        EXPECT_EQ(all.mean, model.mean) << count;
        EXPECT_EQ(all.density, model.density) << count;
    }
    EXPECT_THROW((void)read_ply(dir / "m.ply", {2, 2}), Error);
}

TEST(ply, an_index_names_the_files_beside_it) {
    const TempDir dir;
    const std::vector<std::string> names = {"a.0.ply", "b/c.ply"};
    write_model_index(dir / "m.json", names);
    const auto files = read_model_index(dir / "m.json");
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0], dir / "a.0.ply");
    EXPECT_EQ(files[1], dir / "b/c.ply");
    for (const char* wrong : {"", "{}", "[]", "{\"vog_models\": []}", "{\"vog_models\": [1]}"}) {
        write_bytes(dir / "wrong.json", wrong);
        EXPECT_THROW((void)read_model_index(dir / "wrong.json"), Error) << wrong;
    }
    EXPECT_THROW((void)read_model_index(dir / "none.json"), Error);
}

TEST(ply, header_says_every_convention) {
    const TempDir dir;
    write_ply(dir / "m.ply", labelled(random_gaussians(3, 0.1, 1, 3)));
    const std::string text = read_bytes(dir / "m.ply");
    for (const char* line : {"comment kernel ", "comment cutoff 2.25\n", "comment units ",
                             "comment source smoke.vdb density\n", "comment method paper\n",
                             "comment options --set strategy=smart --set dense-block=2\n",
                             "comment reached mass ratio 1.00000\n", "property float rot_0\n",
                             "property float density\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line;
    EXPECT_EQ(text.find("comment origin"), std::string::npos);
    Gaussians far = random_gaussians(3, 0.1, 1, 3);
    far.origin = {5000000.1, -1e9, 0};
    EXPECT_NE(ply_header(far, 3, true).find("\ncomment origin 5000000.1 -1000000000 0\n"),
              std::string::npos);
}

TEST(ply, every_truncation_length_throws) {
    const TempDir dir;
    write_ply(dir / "whole.ply", labelled(random_gaussians(3, 0.1, 1, 4)));
    const std::string bytes = read_bytes(dir / "whole.ply");
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        write_bytes(dir / "cut.ply", bytes.substr(0, length));
        ASSERT_NE(ply_error(dir / "cut.ply").find("cut.ply: "), std::string::npos) << length;
    }
    write_bytes(dir / "cut.ply", bytes + "x");
    EXPECT_NE(ply_error(dir / "cut.ply").find("too long"), std::string::npos);
}

TEST(ply, a_count_beyond_the_file_is_refused_before_it_is_allocated) {
    const TempDir dir;
    std::string bytes = one_row({{"x", 0},
                                 {"y", 0},
                                 {"z", 0},
                                 {"scale_0", 1},
                                 {"scale_1", 1},
                                 {"scale_2", 1},
                                 {"density", 1}},
                                "comment cutoff 2.25\n");
    bytes.replace(bytes.find("vertex 1"), 8, "vertex 4611686018427387904");
    write_bytes(dir / "huge.ply", bytes);
    EXPECT_NE(ply_error(dir / "huge.ply").find("truncated"), std::string::npos);
}

TEST(ply, 3dgs_files_are_taken_by_name) {
    const TempDir dir;
    const float alpha = 0.75f, logit = std::log(alpha / (1 - alpha)), s = 0.2f;
    write_bytes(dir / "3dgs.ply", one_row({{"x", 1},
                                           {"y", 2},
                                           {"z", 3},
                                           {"nx", 0},
                                           {"ny", 0},
                                           {"nz", 0},
                                           {"f_dc_0", 9},
                                           {"f_dc_1", 9},
                                           {"f_dc_2", 9},
                                           {"f_rest_0", 9},
                                           {"opacity", logit},
                                           {"scale_0", std::log(s)},
                                           {"scale_1", std::log(s)},
                                           {"scale_2", std::log(s)},
                                           {"rot_0", 1},
                                           {"rot_1", 0},
                                           {"rot_2", 0},
                                           {"rot_3", 0}}));
    const Gaussians model = read_ply(dir / "3dgs.ply");
    ASSERT_EQ(model.size(), 1u);
    EXPECT_EQ(model.mean[0], (Vec3f{1, 2, 3}));
    EXPECT_NEAR(model.scale[0].x, s, 1e-6);
    EXPECT_EQ(model.cutoff, 3.0f);
    // A ray through the mean has the same alpha, up to the truncation of the kernel (0.3 % of T).
    const double tau = optical_depth(model, 0, {1, 2, -5}, {0, 0, 1});
    EXPECT_NEAR(1 - std::exp(-tau), alpha, 2e-3);
}

TEST(ply, volprim_files_are_taken_by_name) {
    const TempDir dir;
    write_bytes(dir / "v.ply", one_row({{"x", 1},
                                        {"y", 2},
                                        {"z", 3},
                                        {"nx", 0},
                                        {"ny", 0},
                                        {"nz", 0},
                                        {"sigmat", 5},
                                        {"albedo_0", 1},
                                        {"scale_0", std::log(0.2f)},
                                        {"scale_1", std::log(0.3f)},
                                        {"scale_2", std::log(0.4f)},
                                        {"rot_0", 1},
                                        {"rot_1", 0},
                                        {"rot_2", 0},
                                        {"rot_3", 0}}));
    const Gaussians model = read_ply(dir / "v.ply");
    // sigmat is the mass of a unit-mass pdf, reduced by the truncation at 3 standard deviations.
    EXPECT_NEAR(mass(model), 5 * mass_within(3), 1e-5);
}

/// Trainers and tools write more elements and properties, other types, ASCII: vertices are read by name.
TEST(ply, splats_are_read_by_name_from_every_ply) {
    const TempDir dir;
    const std::vector<std::pair<std::string, double>> vertex = {
        {"rot_0", 1},     {"label", 7},  {"x", 1},        {"y", 2},           {"z", 3},
        {"opacity", 1.5}, {"f_dc_0", 9}, {"scale_0", -1}, {"scale_1", -2},    {"scale_2", -3},
        {"rot_1", 0},     {"rot_2", 0},  {"rot_3", 0},    {"confidence", 0.5}};
    enum class Kind { little, big, ascii };
    const auto file = [&](Kind kind, const std::string& type, bool more, const std::string& end) {
        std::string head, body;
        const auto line = [&](const std::string& text) { head += text + end; };
        const auto put = [&]<class T>(T value) {
            if (kind == Kind::ascii) {
                body += fmt::format("{}{} ", value < 0 ? "" : " ", +value);
                return;
            }
            std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
            if (kind == Kind::big) std::reverse(bytes.begin(), bytes.end());
            body += bytes;
        };
        const auto end_row = [&] { body += kind == Kind::ascii ? end : ""; };
        const auto faces = [&] {
            line("element " + std::string(body.empty() ? "face" : "edge") + " 2");
            line("property list uchar int vertex_indices");
            line("property short flag");
            for (const int count : {3, 1}) {
                put(static_cast<std::uint8_t>(count));
                for (int k = 0; k < count; ++k) put(std::int32_t{k});
                put(std::int16_t{5});
                end_row();
            }
        };
        line("ply");
        line(kind == Kind::ascii ? "format ascii 1.0"
             : kind == Kind::big ? "format binary_big_endian 1.0"
                                 : "format binary_little_endian 1.0");
        line("comment made by a trainer");
        if (more) faces();
        line("element vertex 2");
        for (const auto& [name, value] : vertex)
            line("property " + (name == "label" ? "uchar" : type) + " " + name);
        for (int row = 0; row < 2; ++row) {
            for (const auto& [name, value] : vertex)
                if (name == "label")
                    put(static_cast<std::uint8_t>(value));
                else if (type == "double")
                    put(value + (name == "x" ? row : 0));
                else
                    put(static_cast<float>(value + (name == "x" ? row : 0)));
            end_row();
        }
        if (more) faces();
        line("end_header");
        return head + body;
    };
    for (const Kind kind : {Kind::little, Kind::big, Kind::ascii})
        for (const char* type : {"float", "float32", "double"})
            for (const bool more : {false, true})
                for (const char* end : {"\n", "\r\n", "\r"}) {
                    const std::string bytes = file(kind, type, more, end);
                    std::filesystem::remove(dir / "p.ply");
                    write_bytes(dir / "p.ply", bytes);
                    EXPECT_EQ(ply_error(dir / "p.ply"), "no error") << bytes.substr(0, 60);
                    const Gaussians model = read_ply(dir / "p.ply");
                    ASSERT_EQ(model.size(), 2u);
                    EXPECT_EQ(model.mean[1], (Vec3f{2, 2, 3}));
                    EXPECT_FLOAT_EQ(model.scale[1].y, std::exp(-2.0f));
                    EXPECT_EQ(read_ply(dir / "p.ply", ModelPart{1, 2}).mean[0], model.mean[1]);
                    // Half of the file, and half of the last row.
                    for (const std::size_t size : {bytes.size() / 2, bytes.size() - 9}) {
                        std::filesystem::remove(dir / "p.ply");
                        write_bytes(dir / "p.ply", bytes.substr(0, size));
                        if (!more) {
                            EXPECT_NE(ply_error(dir / "p.ply"), "no error") << size;
                        }
                    }
                }
    // As on a map: floats there are 0.5 apart.
    std::string far = file(Kind::ascii, "double", false, "\n");
    for (const auto& [from, to] : {std::pair{" 1  2  3", " 500000.25  5000000.125  3"},
                                   {" 2  2  3", " 500000.5  5000000.125  3"}})
        far.replace(far.find(from), std::strlen(from), to);
    write_bytes(dir / "far.ply", far);
    const Gaussians model = read_ply(dir / "far.ply");
    for (std::size_t n = 0; n < 2; ++n)
        EXPECT_EQ(model.origin + vec_cast<double>(model.mean[n]),
                  (Vec3d{500000.25 + 0.25 * double(n), 5000000.125, 3}));
    EXPECT_EQ(read_ply(dir / "far.ply", ModelPart{1, 2}).origin, model.origin);
    // Without scales it is no model.
    write_bytes(dir / "cloud.ply", one_row({{"x", 0}, {"y", 0}, {"z", 0}, {"red", 1}}));
    EXPECT_NE(ply_error(dir / "cloud.ply").find("points without scales"), std::string::npos);
    write_bytes(dir / "packed.ply", one_row({{"packed_position", 0}}));
    EXPECT_NE(ply_error(dir / "packed.ply").find("SuperSplat"), std::string::npos);
}

TEST(ply, what_it_does_not_understand_is_refused_by_name) {
    const TempDir dir;
    const std::vector<std::pair<std::string, float>> base = {
        {"x", 0}, {"y", 0}, {"z", 0}, {"scale_0", 1}, {"scale_1", 1}, {"scale_2", 1}};
    const auto with = [&](std::vector<std::pair<std::string, float>> more,
                          const std::string& comments = "comment cutoff 2.25\n") {
        auto all = base;
        all.insert(all.end(), more.begin(), more.end());
        write_bytes(dir / "p.ply", one_row(all, comments));
        return ply_error(dir / "p.ply");
    };
    EXPECT_EQ(with({{"density", 1}}), "no error");
    EXPECT_NE(with({{"density", 1}}, "").find("comment cutoff"), std::string::npos);
    for (const char* version : {"1", "1.0", "1.12"})
        EXPECT_EQ(
            with({{"density", 1}}, fmt::format("comment vog {}\ncomment cutoff 2\n", version)),
            "no error");
    for (const char* version : {"2", "2.0", "10", "0.9"})
        EXPECT_NE(with({{"density", 1}}, fmt::format("comment vog {}\ncomment cutoff 2\n", version))
                      .find(fmt::format("a model of version {}, expected 1", version)),
                  std::string::npos);
    EXPECT_NE(with({{"density", 1}}, "comment cutoff wide\n").find("not a number"),
              std::string::npos);
    EXPECT_NE(with({{"density", 1}}, "comment cutoff 2\ncomment origin 1 2\n").find("expected 3"),
              std::string::npos);
    EXPECT_NE(with({{"density", 1}}, "comment cutoff 2\ncomment origin 1 2 nan\n").find("origin"),
              std::string::npos);
    for (const char* count : {"-5", "1.5", "many", "18446744073709551616", ""})
        EXPECT_NE(with({{"density", 1}},
                       fmt::format("comment cutoff 2\ncomment source_voxels {}\n", count))
                      .find("expected a whole number >= 0"),
                  std::string::npos)
            << count;
    for (const char* box : {"0 0 nan 1 1 1", "0 0 0 1 1 inf", "0 2 0 1 1 1"})
        EXPECT_NE(with({{"density", 1}}, fmt::format("comment cutoff 2\ncomment box {}\n", box))
                      .find("comment 'box"),
                  std::string::npos)
            << box;
    EXPECT_NE(with({}).find("none of the layouts"), std::string::npos);
    EXPECT_NE(with({{"density", 1}, {"opacity", 1}}).find("none of the layouts"),
              std::string::npos);
    EXPECT_NE(with({{"density", 1}, {"colour", 1}}).find("unknown property 'colour'"),
              std::string::npos);
    EXPECT_NE(with({{"density", 1}, {"rot_0", 1}}).find("expected none or all"), std::string::npos);
    EXPECT_NE(with({{"density", NAN}}).find("density"), std::string::npos);
    EXPECT_NE(with({{"density", -1}}).find("density"), std::string::npos);
    std::string text = one_row({{"density", 1}}, "comment cutoff 2\n");
    for (const auto& [name, value] : base)
        text.insert(text.find("end_"), "property float " + name + "\n");
    text.replace(text.find("binary_little_endian"), 20, "ascii");
    write_bytes(dir / "p.ply", text);
    EXPECT_NE(ply_error(dir / "p.ply").find("format 'ascii'"), std::string::npos);
    write_bytes(dir / "p.ply", "PNG");
    EXPECT_NE(ply_error(dir / "p.ply").find("not a PLY file"), std::string::npos);
    EXPECT_NE(ply_error(dir / "absent.ply").find("no such file"), std::string::npos);
}

TEST(ply, a_failed_write_leaves_the_old_file) {
    const TempDir dir;
    const Gaussians model = random_gaussians(3, 0.1, 1, 5);
    write_ply(dir / "m.ply", model);
    const std::string before = read_bytes(dir / "m.ply");
    Gaussians spoiled = model;
    spoiled.density[1] = NAN;
    EXPECT_THROW(write_ply(dir / "m.ply", spoiled), Error);
    EXPECT_EQ(read_bytes(dir / "m.ply"), before);
    EXPECT_THROW(write_ply(dir / "no" / "m.ply", model), Error);
}

}  // namespace vog::test
