// names_test.cpp: names and bytes of files in messages and lists; patterns; inputs that are no files.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/level_volumes.h"
#include "vog/text.h"
#include "vog/volume_io.h"

namespace vog::test {

class names : public CommandLine {
  protected:
    /// A file of grids with these names.
    void write_named(const std::string& file, const std::vector<std::string>& grids) const {
        std::vector<Volume> volumes;
        for (const std::string& name : grids) {
            volumes.push_back(cube_of(4, 0.5f, {}));
            volumes.back().name = name;
        }
        write_vdb(dir_ / file, volumes);
    }
    /// Expects printable lines.
    static void expect_printable(const std::string& text) {
        std::istringstream in(text);
        for (std::string line; std::getline(in, line);) EXPECT_EQ(printable(line), line);
    }
};

TEST_F(names, in_files_reach_no_terminal_raw) {
    using namespace std::string_literals;
    write("escape.ply", "ply\nformat binary_little_endian 1.0\n\x1b[31;1mred\a\nend_header\n");
    write("property.ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float \xff\x1b[2J\n"
          "end_header\n");
    write("escape.xyz", "1 2 \x1b[2J\0\n"s);
    write("nul.xyz", "1 2 3\n\0004 5 6\n"s);
    write("columns.csv", "x,y,z,\x1b]0;title\a,\xff\n1,2,3,4,5\n2,3,4,5,6\n");
    write_named("grids.vdb", {"a\x1b[31m", "b\xff", "c\nd"});
    for (const char* file : {"escape.ply", "property.ply", "escape.xyz", "nul.xyz"}) {
        const Result result = run(std::string("info ") + file);
        EXPECT_EQ(result.exit_code, 1) << file;
        EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << result.error;
        expect_printable(result.error);
    }
    must_fail(1, "info escape.ply", "'\\x1b[31;1mred\\x07' is not PLY");
    must_fail(1, "info nul.xyz", "got '\\x004' in column 1");
    for (const std::string command : {"info columns.csv", "info grids.vdb"})
        expect_printable(must(command).out);
    EXPECT_NE(must("info grids.vdb").out.find("grid 'a\\x1b[31m'"), std::string::npos);
    must_fail(1, "evaluate grids.vdb -o e", "a\\x1b[31m, b\\xff, c\\x0ad");
    const auto json = nlohmann::json::parse(must("info --json grids.vdb columns.csv").out);
    EXPECT_EQ(json["files"][0]["grids"][1]["name"], "b\\xff");
    must_fail(1, "info $(printf 'no\\033such.vdb')", "no\\x1bsuch.vdb: no such file");
    must_fail(2, "render a.ply -o a.png --size $(printf '3\\033x')", "--size 3\\x1bx");
}

TEST_F(names, of_grids_select_them_as_shown_and_as_stored) {
    write_named("grids.vdb", {"a\x1b[31m", "b", std::string(150, 'n')});
    must("convert grids.vdb -o a.ply --grid 'a\\x1b[31m'");
    must("convert grids.vdb -o a.ply --grid \"$(printf 'a\\033[31m')\"");
    must("convert grids.vdb -o a.ply --grid " + std::string(100, 'n') + "...");
    must("convert grids.vdb -o a.ply --grid " + std::string(150, 'n'));
}

TEST_F(names, match_patterns_without_exponential_time) {
    write_named("long.vdb", {std::string(95, 'a'), "b"});
    std::string pattern;
    for (int n = 0; n < 30; ++n) pattern += "*a";
    const std::string limit = "timeout 60";  // trying all splits would take years
    must_fail(1, "convert long.vdb -o a.ply --grid '" + pattern + "*c'", "no grid matches", limit);
    must("convert long.vdb -o a.ply --grid '" + pattern + "*'", limit);
    // The text that the first * stands for takes the place of the mask's.
    must_fail(1, "convert long.vdb -o a.ply --grid '" + pattern + "' --mask '*mask'",
              "no grid named 'mask'", limit);
}

TEST_F(names, of_the_first_column_have_no_byte_order_mark) {
    write("plain.csv", "x,y,z,mass\n1,2,3,4\n2,3,4,5\n");
    for (const std::string text : {"x,y,z,mass\n1,2,3,4\n2,3,4,5\n", "1,2,3,4\n2,3,4,5\n"}) {
        write("plain.csv", text);
        write("bom.csv", "\xef\xbb\xbf" + text);
        const auto points_of = [&](const char* file) {
            auto points = nlohmann::json::parse(
                must(std::string("info --json ") + file).out)["files"][0]["points"];
            points.erase("notes");  // begin with the file's name
            return points;
        };
        EXPECT_EQ(points_of("bom.csv"), points_of("plain.csv"));
    }
    write("wide.csv", std::string("\xff\xfex\0,\0", 6));
    must_fail(1, "info wide.csv", "wide.csv: text in UTF-16, expected UTF-8 or ASCII");
}

TEST_F(names, of_pipes_are_refused_as_inputs) {
    for (const char* extension : {"vdb", "nvdb", "ply", "xyz", "csv", "json"}) {
        const std::string pipe = std::string("pipe.") + extension;
        ASSERT_EQ(::mkfifo((dir_ / pipe).c_str(), 0600), 0);
        must_fail(1, "info " + pipe, pipe + ": is a pipe, a socket or a device, expected a file",
                  "timeout 20");
    }
    must("sample cloud c.vdb --size 64");
    ASSERT_EQ(::mkfifo((dir_ / "pipe.png").c_str(), 0600), 0);
    must_fail(1, "compare pipe.png pipe.png", "is a pipe", "timeout 20");
    must_fail(1, "render c.vdb -o a.png --tf pipe.json", "is a pipe", "timeout 20");
    must_fail(1, "render c.vdb -o a.png --camera pipe.json", "is a pipe", "timeout 20");
}

TEST_F(names, too_long_for_the_system_are_one_clear_line) {
    const std::string longest(300, 'n');
    must_fail(1, "info " + longest + ".vdb", "File name too long");
    must_fail(1, "convert " + longest + ".vdb -o a.ply", "File name too long");
    must_fail(1, "convert '" + longest + "*.vdb' -o a.ply", "no such files");
    must_fail(1, "sample cloud " + longest + ".vdb", "File name too long");
}

}  // namespace vog::test
