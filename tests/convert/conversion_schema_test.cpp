// The table of options of conversions: values, effects, and what they make of options of the methods.
#include "vog/conversion_schema.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "support/refusal.h"

namespace vog {
namespace {

using test::refusal;

std::vector<std::string> words(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

TEST(conversion_schema, rules_are_of_options_of_the_table_and_of_its_conversions) {
    const std::vector<std::string> conversions{"moments",         "paper", "particles",
                                               "paper-particles", "cells", "models"};
    std::vector<std::string> keys;
    for (const ConversionOption& one : conversion_schema()) {
        EXPECT_EQ(std::ranges::count(keys, one.key), 0) << one.key;
        keys.push_back(one.key);
        for (const std::string& of : words(one.of))
            EXPECT_TRUE(std::ranges::count(conversions, of)) << one.key << of;
        EXPECT_TRUE(default_text(one).empty() || values_of(one).fit(default_text(one))) << one.key;
    }
    for (const OptionRule& rule : conversion_rules()) {
        for (const std::string& key : words(rule.members + " " + rule.beside))
            EXPECT_TRUE(std::ranges::count(keys, key)) << key;
        for (const std::string& of : words(rule.of))
            EXPECT_TRUE(std::ranges::count(conversions, of)) << of;
    }
}

TEST(conversion_schema, values_fit_intervals_and_words) {
    const auto one = [](const std::string& key) {
        return *std::ranges::find(conversion_schema(), key, &ConversionOption::key);
    };
    const auto option = [&](const std::string& key) { return values_of(one(key)); };
    for (const char* good : {"1e-300", "0.5", "0.999999999"})
        EXPECT_TRUE(option("error").fit(good)) << good;
    for (const char* bad : {"0", "1", "-1", "nan", "inf", "1e999", "", "0.5x", "big"})
        EXPECT_FALSE(option("error").fit(bad)) << bad;
    for (const char* good : {"0.5", "2"}) EXPECT_TRUE(option("spread").fit(good)) << good;
    for (const char* bad : {"0.49", "2.01"}) EXPECT_FALSE(option("spread").fit(bad)) << bad;
    for (const char* bad : {"0", "inf", "1e999"}) EXPECT_FALSE(option("radius").fit(bad)) << bad;
    for (const char* bad : {"1.5", "1e3", "1001", "-1"})
        EXPECT_FALSE(option("soft_steps").fit(bad)) << bad;
    EXPECT_EQ(option("soft_steps").expected(), "a whole number, in [0, 1000]");
    EXPECT_EQ(option("opacity_threshold").expected(), "at least 0");
    EXPECT_TRUE(option("dense_block").fit("4"));
    EXPECT_FALSE(option("dense_block").fit("3"));
    EXPECT_EQ(option("amplitude").expected(), "mean or mass");
    EXPECT_EQ(option("kappa").expected(), "in [1.3e-14, 1)");
    EXPECT_EQ(default_text(one("kappa")), "0.01");
    EXPECT_EQ(default_text(one("soft_steps")), "") << "the text states those of each cut";
}

TEST(conversion_schema, values_out_of_range_are_refused_by_key_value_and_range) {
    ConversionOptions options;
    EXPECT_EQ(refusal([&] { check_values(options); }), "no error");
    options.moments.block_voxels = 3;
    EXPECT_EQ(refusal([&] { check_values(options); }),
              "convert: block 3, expected 1, 2, 4, 8, 16, 32, 64 or 128");
    options.moments.block_voxels = 0;
    options.mass_threshold = 1;
    EXPECT_EQ(refusal([&] { check_values(options); }),
              "convert: mass_threshold 1, expected in [0, 1)");
    const std::vector<std::string> stated{"budget"};
    EXPECT_EQ(refusal([&] { check_values({}, stated); }),
              "convert: budget 0, expected a whole number, at least 1");
}

TEST(conversion_schema, options_without_effect_are_refused) {
    const auto refused = [](const std::string& conversion, std::vector<std::string> stated,
                            ConversionOptions options = {}) {
        return refusal([&] { require_effects(options, conversion, stated); });
    };
    EXPECT_EQ(refused("moments", {"budget", "soft_steps"}), "no error");
    EXPECT_EQ(refused("moments", {"budget", "block"}),
              "convert: budget has no effect beside `block`");
    EXPECT_EQ(refused("moments", {"error", "measure"}),
              "convert: measure has no effect without `block`, `budget` or `lod`");
    EXPECT_EQ(refused("particles", {"axis_aligned"}),
              "convert: axis_aligned has no effect without `block`, `budget`, `error` or `lod`");
    EXPECT_EQ(refused("moments", {"axis_aligned"}), "no error");
    EXPECT_EQ(refused("paper", {"dense_block"}), "no error");
    EXPECT_EQ(refused("paper", {"tree_depth"}), "convert: tree_depth needs strategy 'tree'");
    ConversionOptions tree;
    tree.strategy = "tree";
    EXPECT_EQ(refused("paper", {"strategy", "tree_depth"}, tree), "no error");
    EXPECT_EQ(refused("paper", {"strategy", "dense_block"}, tree),
              "convert: dense_block needs strategy 'smart', 'strict' or 'single'");
}

TEST(conversion_schema, options_of_methods_have_the_level_of_detail_and_their_own_defaults) {
    ConversionOptions options;
    EXPECT_EQ(moment_options(options).mass_threshold, MomentOptions{}.mass_threshold);
    EXPECT_EQ(point_options(options).mass_threshold, PointOptions{}.mass_threshold);
    options.lod = 3;
    options.mass_threshold = 0.1;
    EXPECT_EQ(moment_options(options).block_voxels, moment_lod(3).block_voxels);
    EXPECT_EQ(point_options(options).block_voxels, moment_lod(3).block_voxels);
    EXPECT_EQ(point_options(options).mass_threshold, 0.1);
    EXPECT_EQ(paper_options(options).dense_block, paper_lod(3).dense_block);
    options.lod = 0;
    options.strategy = "tree", options.amplitude = "mass", options.paper.tree_depth = 2;
    EXPECT_EQ(paper_options(options).strategy, Strategy::tree_mirror);
    EXPECT_EQ(paper_options(options).amplitude, Amplitude::mass);
    EXPECT_EQ(paper_options(options).tree_depth, 2);
}

}  // namespace
}  // namespace vog
