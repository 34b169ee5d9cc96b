// field_options_test.cpp: files, grids and names in the texts of fields.
#include "options/field_options.h"

#include <gtest/gtest.h>

#include "support/data.h"
#include "support/image_bytes.h"
#include "terminal/usage_error.h"

namespace vog::test {

namespace {

using vog::cli::parse_field, vog::cli::parse_fields;

class field_options : public testing::Test {
  protected:
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    void expect(const std::string& text, const std::string& file, const std::string& grid,
                const std::string& name) const {
        const FieldSource source = parse_field(text);
        EXPECT_EQ(source.file, file) << text;
        EXPECT_EQ(source.grid, grid) << text;
        EXPECT_EQ(source.name, name) << text;
    }
    static std::string refusal(const std::vector<std::string>& texts) {
        try {
            parse_fields(texts);
        } catch (const vog::cli::UsageError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return {};
    }
    TempDir dir_;
};

}  // namespace

TEST_F(field_options, a_text_names_a_grid_of_the_input_or_of_a_file) {
    expect("temperature", "", "temperature", "temperature");
    expect("other.vdb:T", "other.vdb", "T", "T");
    expect("other.NVDB:T", "other.NVDB", "T", "T");
    expect("heat=temperature", "", "temperature", "heat");
    expect("heat=folder/other.vdb:T_2", "folder/other.vdb", "T_2", "heat");
    expect("T=temperature_L*", "", "temperature_L*", "T");
    // Grid names with other characters need a name.
    expect("heat=gas:T", "", "gas:T", "heat");
    expect("heat=gas T=2", "", "gas T=2", "heat");
}

TEST_F(field_options, an_existing_file_wins_over_colons_and_equals_signs) {
    for (const char* name : {"a:b.vdb", "c=d.vdb", "plain"}) write_bytes(dir_ / name, "x");
    expect(at("a:b.vdb") + ":T", at("a:b.vdb"), "T", "T");
    expect(at("a:b.vdb"), at("a:b.vdb"), "", "");
    expect(at("c=d.vdb") + ":T", at("c=d.vdb"), "T", "T");
    expect("heat=" + at("a:b.vdb") + ":T", at("a:b.vdb"), "T", "heat");
    expect("heat=" + at("plain") + ":gas:T", at("plain"), "gas:T", "heat");
}

TEST_F(field_options, reserved_and_repeated_names_are_refused) {
    EXPECT_EQ(refusal({"temperature", "flame"}), "");
    EXPECT_NE(refusal({"T", "other.vdb:T"}).find("a second field named 'T', expected a name of"),
              std::string::npos);
    EXPECT_EQ(refusal({"T", "T2=other.vdb:T"}), "");
    for (const char* name : {"x", "scale_0", "rot_3", "opacity"})
        EXPECT_NE(refusal({name}).find("is reserved"), std::string::npos) << name;
    for (const char* text : {"", "heat=", "T_L*", "a.vdb:", "=T", "gas T", "velocity.x", "T\n"})
        EXPECT_NE(refusal({text}), "") << text;
}

}  // namespace vog::test
