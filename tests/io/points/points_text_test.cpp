// points_text_test.cpp: columns, headers, comments and malformed lines of particle text files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/image_bytes.h"
#include "support/refused_files.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/text.h"

namespace vog::test {

namespace {

class points_text : public testing::Test {
  protected:
    Points read(const std::string& text, const std::string& name = "p.xyz",
                const PointReadOptions& options = {}) const {
        write_bytes(dir_ / name, text);
        return read_points(dir_ / name, options);
    }
    /// Error message without the folder: "p.xyz:3: got ...".
    std::string refused(const std::string& text, const std::string& name = "p.xyz",
                        const PointReadOptions& options = {}) const {
        const std::string message = error_of([&] { read(text, name, options); });
        const std::string folder = (dir_ / "").string();
        EXPECT_EQ(message.find(folder), 0u) << message;
        return message.substr(std::min(folder.size(), message.size()));
    }
    TempDir dir_;
};

std::vector<std::string> names(const Points& points) {
    std::vector<std::string> list;
    for (const PointAttribute& attribute : points.attributes) list.push_back(attribute.name);
    return list;
}
using Names = std::vector<std::string>;

/// The same two particles, in any notation.
void expect_two(const Points& points) {
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.position[0], (Vec3d{1, 2, 3}));
    EXPECT_EQ(points.position[1], (Vec3d{-4, 5.5, 6e3}));
    ASSERT_EQ(points.velocity.size(), 2u);
    EXPECT_EQ(points.velocity[0], (Vec3f{7, 8, 9}));
    EXPECT_EQ(points.velocity[1], (Vec3f{0.5f, -1, 0}));
}

}  // namespace

TEST_F(points_text, six_numbers_are_position_and_velocity) {
    const std::string lines = "1 2 3 7 8 9\n-4 5.5 6e3 .5 -1 0\n";
    expect_two(read(lines));
    expect_two(read(lines.substr(0, lines.size() - 1)));  // no end of the last line
    expect_two(read("  1\t2  3 7 8 9 \r\n\r\n -4.0 5.5 +6.0D+03 0.5 -1 0\r\n"));
    expect_two(read("# made by hand\n\n" + lines + "% the end\n"));
    expect_two(read("x y z vx vy vz\n" + lines));
    expect_two(read("# x y z vx vy vz\n" + lines));
}

TEST_F(points_text, separators_are_found) {
    expect_two(read("1,2,3,7,8,9\n-4, 5.5 ,6e3,0.5,-1,0\n", "p.csv"));
    expect_two(read("1;2;3;7;8;9\n-4;5.5;6e3;0.5;-1;0\n", "p.csv"));
    expect_two(read("1\t2\t3\t7\t8\t9\n-4\t5.5\t6e3\t0.5\t-1\t0\n", "p.TSV"));
    EXPECT_NE(refused("1 2 3\n", "p.json").find("unknown extension '.json'"), std::string::npos);
}

TEST_F(points_text, names_in_the_header_choose_the_columns) {
    expect_two(
        read("id,\"vx\",\"vy\",\"vz\",X,Y,Z\n0,7,8,9,1,2,3\n1,0.5,-1,0,-4,5.5,6e3\n", "p.csv"));
    const Points points = read(
        "halo,pos_x,pos_y,pos_z,mass,kind\nid,kpc,kpc,kpc,Msun,\n3,1,2,3,1e10,gas\n4,5,6,7,2e10,"
        "\"a, b\"\n",
        "p.csv");
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.position[1], (Vec3d{5, 6, 7}));
    EXPECT_TRUE(points.velocity.empty());
    EXPECT_EQ(names(points), (Names{"halo", "mass"}));  // text is left out
    EXPECT_EQ(points.attributes[1].value[1], 2e10f);
    EXPECT_EQ(refused("id,ra,dec\n1,2,3\n", "p.csv"),
              "p.csv: no columns x, y, z among id, ra, dec, expected them or three named by "
              "--columns");
}

TEST_F(points_text, every_column_has_the_unit_that_the_head_states) {
    const Points brackets = read(
        "x [kpc],y [kpc],z [kpc],vx [km/s],vy [m/s],vz [km/s],m [g]\n1,2,3,4,5000,6,7\n", "p.csv");
    EXPECT_EQ(brackets.velocity[0], (Vec3f{4, 5, 6}));
    EXPECT_EQ(point_value_unit(brackets, "speed"), "km/s");
    EXPECT_EQ(point_value_unit(brackets, "m [g]"), "g");
    const Points row = read("x,y,z,m,T\nkpc,kpc,kpc,[Msun],\n1,2,3,4,5\n", "p.csv");
    EXPECT_EQ(point_value_unit(row, "m"), "Msun");
    EXPECT_EQ(point_value_unit(row, "T"), "");
    EXPECT_EQ(point_value_unit(read("x,y,z,m\nfirst,second,third,last\n1,2,3,4\n", "p.csv"), "m"),
              "")
        << "words, not units";
    EXPECT_EQ(refused("x,y,z,vx [km/s],vy [m],vz [km/s]\n1,2,3,4,5,6\n", "p.csv"),
              "p.csv: columns of velocities in units 'km/s, m, km/s', expected one unit, or units "
              "of speed");
}

TEST_F(points_text, a_first_line_of_other_numbers_is_no_row_of_units) {
    for (const char* number :
         {"***", "1.5-120", "1'234.5", "$1", "1_000", "1km", "0x1", "\u22121.5"})
        EXPECT_EQ(refused(fmt::format("x;y;z\n{0};{0};{0}\n1;2;3\n", number), "p.csv"),
                  fmt::format("p.csv:2: got '{}' in column 1, expected a number", number));
    EXPECT_EQ(read("x,y,z\n[kpc],\u00b5m,mm\n1,2,3\n", "p.csv").size(), 1u);
}

TEST_F(points_text, columns_are_chosen_by_name_or_number) {
    const std::string text = "id,ra,dec,r\n1,2,3,4\n5,6,7,8\n";
    const Points points = read(text, "p.csv", {{"ra", "dec", "4"}, {}});
    EXPECT_EQ(points.position[1], (Vec3d{6, 7, 8}));
    EXPECT_EQ(names(points), Names{"id"});
    const Points numbered = read("9 1 2 3\n", "p.xyz", {{"2", "3", "4"}, {}});
    EXPECT_EQ(numbered.position[0], (Vec3d{1, 2, 3}));
    EXPECT_EQ(names(numbered), Names{"column1"});
    EXPECT_EQ(refused(text, "p.csv", {{"ra", "dec", "z"}, {}}),
              "p.csv: no column 'z', expected 1 to 4 or one of id, ra, dec, r");
    EXPECT_EQ(refused(text, "p.csv", {{"ra", "dec"}, {}}),
              "p.csv: 2 columns requested, expected 3 (position) or 6 (position and velocity)");
    EXPECT_EQ(refused(text, "p.csv", {{"ra", "dec", "2"}, {}}), "p.csv: column 2 requested twice");
    EXPECT_EQ(refused("1 2 3\n", "p.xyz", {{"1", "2", "4"}, {}}),
              "p.xyz: no column '4', expected 1 to 3");
}

TEST_F(points_text, chemists_files_have_a_count_a_title_and_elements) {
    const Points points = read("2\nwater 1 2 3\nO 0 0 0.1\nH 0.7 0 -0.5\n");
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.position[1], (Vec3d{0.7, 0, -0.5}));
}

TEST_F(points_text, three_columns_have_no_speed) {
    const Points points = read("1 2 3\n4 5 6\n");
    EXPECT_TRUE(points.velocity.empty());
    EXPECT_EQ(point_values(points, "count"), (BigVector<float>{1, 1}));
    EXPECT_NE(error_of([&] {
                  point_values(points, "speed");
              }).find("p.xyz: no value named 'speed' (it has: count)"),
              std::string::npos);
}

TEST_F(points_text, every_malformed_line_is_named) {
    const std::string good = "1 2 3 4 5 6\n";
    EXPECT_EQ(refused(good + "# one\n\n1 2 3 4 5\n" + good), "p.xyz:4: got 5 columns, expected 6");
    EXPECT_EQ(refused(good + "1 2 3 4 5 6 7\n"), "p.xyz:2: got 7 columns, expected 6");
    EXPECT_EQ(refused(good + "1 2 3.0.1 4 5 6\n"),
              "p.xyz:2: got '3.0.1' in column 3, expected a number");
    EXPECT_EQ(refused(good + "1 nan 3 4 5 6\n"),
              "p.xyz:2: got 'nan' in column 2, expected a finite number (--skip-nonfinite leaves "
              "such particles out)");
    EXPECT_EQ(refused(good + "1 2 3 4 5 1e39\n"),
              "p.xyz:2: got '1e39' in column 6, expected a finite number (--skip-nonfinite leaves "
              "such particles out)");
    EXPECT_EQ(refused(good + "1 2 1e999 4 5 6\n"),
              "p.xyz:2: got '1e999' in column 3, expected a finite number (--skip-nonfinite leaves "
              "such particles out)");
    EXPECT_EQ(refused("1,2,3\n1,,3\n", "p.csv"), "p.csv:2: got '' in column 2, expected a number");
    EXPECT_EQ(refused("1,2,3\n1,2,3,4\n", "p.csv"), "p.csv:2: got 4 columns, expected 3");
    EXPECT_EQ(refused(good + "a\n" + good + "b\n"),
              "p.xyz:2: got 1 columns, expected 6; also malformed: line 4");
    EXPECT_EQ(refused(good + "a\nb\nc\n"),
              "p.xyz:2: got 1 columns, expected 6; also malformed: 2 lines: 3, 4");
    EXPECT_EQ(refused("1 2 x 4 5 6\n"), "p.xyz:1: got 'x' in column 3, expected a number");
    EXPECT_EQ(refused("1 2\n"), "p.xyz: got 2 columns in line 1, expected x y z at least");
}

TEST_F(points_text, a_file_without_particles_is_refused) {
    for (const char* text : {"", "\n\n", "# x y z\n", "x y z\n", "0\nnothing\n"})
        EXPECT_EQ(refused(text), "p.xyz: no particles") << text;
    EXPECT_EQ(
        refused("\\fixlen = T\n| x   | y   | z   |\n| r   | r   | r   |\n| kpc | kpc | kpc |\n  1  "
                "   2     3\n"),
        "p.xyz: an IPAC table, expected columns between blanks or commas: astropy makes them by "
        "Table.read(FILE, format='ipac').write('particles.ecsv')");
    const std::string wide(
        "1\0,\0"
        "2\0,\0"
        "3\0\n\0",
        12);
    EXPECT_EQ(refused(wide, "p.csv"),
              "p.csv: no text, or text in UTF-16; expected UTF-8 or ASCII (packed text ends in "
              ".gz, a snapshot in .hdf5)");
    EXPECT_NE(error_of([&] { read_points(dir_ / "absent.xyz"); }).find("absent.xyz: no such file"),
              std::string::npos);
}

TEST_F(points_text, many_chunks_are_read_as_one) {
    // Lines of very different lengths and comments, so that chunks end within all kinds of lines.
    std::string text;
    BigVector<Vec3d> expected;
    std::mt19937 random(5);
    std::uint64_t lines = 0, last_line = 0;
    while (text.size() < 5u << 20) {
        if (random() % 7 == 0) text += std::string(random() % 3, '#') + "\n", ++lines;
        const Vec3d p{double(random()) / 7, double(random()) * 1e-9, -double(random() % 10)};
        expected.push_back(p);
        char line[128];
        std::snprintf(line, sizeof line, "%.17g%*s%.17g %.17g\n", p.x, int(random() % 60) + 1, " ",
                      p.y, p.z);
        text += line;
        last_line = ++lines;
    }
    const Points points = read(text);
    EXPECT_EQ(points.position, expected);
    {
        const ThreadLimit one(1);
        EXPECT_EQ(read(text).position, expected);
    }
    text.resize(text.rfind(' '));
    EXPECT_EQ(refused(text), "p.xyz:" + std::to_string(last_line) + ": got 2 columns, expected 3");
}

TEST_F(points_text, lines_longer_than_a_chunk_are_whole) {
    const std::string blanks(3u << 20, ' ');
    const Points points = read("1 2 3\n4 5" + blanks + "6\n" + blanks + "7 8 9" + blanks);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points.position[1], (Vec3d{4, 5, 6}));
    EXPECT_EQ(points.position[2], (Vec3d{7, 8, 9}));
}

TEST_F(points_text, what_is_written_reads_back_bit_for_bit) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> place(0, 50000);
    std::normal_distribution<float> number;
    Points points;
    points.attributes = {{"mass", {}}, {"temperature", {}}};
    for (int n = 0; n < 40000; ++n) {
        points.position.push_back({place(random), place(random) * 1e-12, -place(random) * 1e8});
        points.velocity.push_back({number(random), number(random) * 1e-30f, number(random)});
        for (PointAttribute& attribute : points.attributes)
            attribute.value.push_back(number(random) * 1e30f);
    }
    for (const char* name : {"p.xyz", "p.csv", "p.tsv"}) {
        write_points(dir_ / name, points);
        const Points back = read_points(dir_ / name);
        EXPECT_EQ(back.position, points.position) << name;
        EXPECT_EQ(back.velocity, points.velocity) << name;
        ASSERT_EQ(names(back), (Names{"mass", "temperature"})) << name;
        EXPECT_EQ(back.attributes[1].value, points.attributes[1].value) << name;
    }
    points.attributes[0].value[7] = std::numeric_limits<float>::infinity();
    EXPECT_EQ(error_of([&] { write_points(dir_ / "q.xyz", points); }),
              "points: 'mass' of particle 7 is not finite");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "q.xyz"));
}

TEST_F(points_text, units_are_written_and_read_back) {
    Points points;
    points.position = {{1, 2, 3}};
    points.velocity = {{4, 5, 6}};
    points.attributes = {{"mass", {7}, 1, "10^10 Msun"}, {"id", {8}}, {"u", {9}, 1, "km^2/s^2"}};
    points.length_unit = "1.5 kpc", points.velocity_unit = "km/s";
    for (const char* name : {"p.xyz", "p.csv", "p.tsv", "p.dat"}) {
        points.attributes[2].name = std::string(name) == "p.csv" ? "u, of gas" : "u,of";
        write_points(dir_ / name, points);
        const Points back = read_points(dir_ / name);
        EXPECT_EQ(back.position, points.position) << name;
        EXPECT_EQ(back.length_unit, "1.5 kpc") << name;
        EXPECT_EQ(back.velocity_unit, "km/s") << name;
        ASSERT_EQ(names(back), names(points)) << name;
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(back.attributes[k].unit_name, points.attributes[k].unit_name) << name;
    }
}

/// Found by fuzzing: such names changed the columns of the file that was read.
TEST_F(points_text, names_that_would_not_read_back_are_quoted_or_refused) {
    Points points;
    points.position = {{1, 2, 3}};
    points.attributes = {{"mass", {4}}, {"T, gas", {5}}};
    write_points(dir_ / "p.csv", points);
    EXPECT_EQ(names(read_points(dir_ / "p.csv")), (Names{"mass", "T, gas"}));
    const auto refusal = [&](const char* file, const char* name) {
        points.attributes[1].name = name;
        return error_of([&] { write_points(dir_ / file, points); });
    };
    for (const char* name : {"", "x", "mass", " a", "a\nb", "a b"})
        EXPECT_NE(refusal("p.xyz", name)
                      .find(fmt::format("p.xyz: cannot write: attribute name '{}', expected no "
                                        "name of another column and no blanks",
                                        printable(name))),
                  std::string::npos)
            << name;
    EXPECT_NE(refusal("p.csv", "\"a\"").find("and no quotes"), std::string::npos);
    for (const char* name : {"7", "nan"}) {
        points.attributes[1].name = name;
        write_points(dir_ / "n.xyz", points);
        EXPECT_EQ(names(read_points(dir_ / "n.xyz")), (Names{"mass", name}));
    }
    points.attributes[1].name = "a b";
    write_points(dir_ / "p.csv", points);
    EXPECT_EQ(names(read_points(dir_ / "p.csv")), (Names{"mass", "a b"}));
    // Three attributes that a reader takes for the velocity.
    points.attributes = {{"vx", {1}}, {"vy", {1}}, {"vz", {1}}};
    EXPECT_NE(error_of([&] { write_points(dir_ / "p.tsv", points); }).find("name 'vz'"),
              std::string::npos);
}

TEST_F(points_text, columns_without_a_name_are_named_by_their_number) {
    const Points points = read("x,y,z,mass,\n1,2,3,4,5\n", "p.csv");
    EXPECT_EQ(names(points), (Names{"mass", "column5"}));
}

TEST_F(points_text, values_go_by_name) {
    const Points points = read("x,y,z,vx,vy,vz,mass\n1,2,3,3,4,0,5\n", "p.csv");
    EXPECT_EQ(point_value_names(points), (Names{"count", "speed", "mass"}));
    EXPECT_EQ(point_values(points, "speed"), BigVector<float>{5});
    EXPECT_EQ(point_values(points, "mass"), BigVector<float>{5});
    const Points scalar = read("x,y,z,velocity\n1,2,3,7\n", "p.csv");
    EXPECT_EQ(point_values(scalar, "speed"), BigVector<float>{7});
}

}  // namespace vog::test
