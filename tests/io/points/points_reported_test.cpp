// points_reported_test.cpp: text files that people report against other readers: headers, counts, line ends, separators, units.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "io/scan/scan_files.h"
#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "vog/points.h"

namespace vog::test {

namespace {

const BigVector<Vec3d> kTwo{{1, 2, 3}, {4, 5, 6}};
const BigVector<Vec3d> kThree{{1, 2, 3}, {4, 5, 6}, {7, 8, 9.5}};

/// A file and its positions, or words of its refusal.
struct Case {
    std::string name, text;
    BigVector<Vec3d> position{};
    std::string refusal{};
    std::vector<std::string> attributes{};  ///< names; empty: not checked
};

const std::vector<Case> kCases{
    // Headers with a name that repeats, is a number, or is missing.
    {"dup.csv", "x,y,z,m,m\n1,2,3,10,11\n4,5,6,20,21\n", kTwo, "", {"m", "column5"}},
    {"dup_first.csv", "m,x,y,z,m\n10,1,2,3,11\n20,4,5,6,21\n", kTwo, "", {"m", "column5"}},
    {"dup_x.csv", "x,y,z,x\n1,2,3,4\n", {}, "two columns called 'x'"},
    {"number.csv", "m,x,y,z,100\n9,1,2,3,7\n9,4,5,6,7\n", kTwo, "", {"m", "100"}},
    {"number.txt", "# m x y z 2\n9 1 2 3 7\n9 4 5 6 7\n", kTwo, "", {"m", "2"}},
    {"index.csv", ",x,y,z\n0,1,2,3\n1,4,5,6\n", kTwo, "", {"column1"}},
    {"counted_index.csv", ",0,1,2,3\n0,1,2,3,9\n1,4,5,6,9\n", kTwo, "", {"column1", "column5"}},
    {"counted.csv", "0,1,2\n1.0,2.0,3.0\n4.0,5.0,6.0\n", kTwo},
    {"counted_whole.csv", "0,1,2\n3,4,5\n", {{0, 1, 2}, {3, 4, 5}}},
    {"not_counted.csv", "0,1,3\n0.5,1,2\n", {{0, 1, 3}, {0.5, 1, 2}}},
    {"short.txt", "mass x y z\n9 1 2 3 8\n", {}, "a header of 4 names above lines of 5 columns"},
    {"short.xyz", "# mass x y z\n9 1 2 3 8\n", {}, "a header of 4 names above lines of 5 columns"},
    {"units.csv", "m,X [kpc],Y [kpc],Z (kpc)\n9,1,2,3\n9,4,5,6\n", kTwo},
    {"mixed_units.csv", "X [mm],Y [mm],Z [cm]\n1,2,0.3\n4,5,0.6\n", kTwo},
    {"no_length.csv", "x [kpc],y [kpc],z [s]\n1,2,3\n", {}, "in units 'kpc, kpc, s'"},
    {"words.csv", "x (east),y (north),z (up)\n1,2,3\n4,5,6\n", kTwo},
    // Headers with another separator than the particles.
    {"savetxt.txt", "# m, x, y, z\n9 1 2 3\n9 4 5 6\n", kTwo, "", {"m"}},
    {"commas_above.txt", "m,x,y,z\n9 1 2 3\n9 4 5 6\n", kTwo, "", {"m"}},
    {"blanks_above.csv", "# m x y z\n9,1,2,3\n9,4,5,6\n", kTwo, "", {"m"}},
    {"semicolons_above.csv", "m;x;y;z\n9,1,2,3\n9,4,5,6\n", kTwo, "", {"m"}},
    {"word_above.txt", "# columns: z, y, x\n3 2 1\n6 5 4\n", kTwo},
    {"quoted.txt", "\"m\" \"x\" \"y\" \"z\"\n9 1 2 3\n9 4 5 6\n", kTwo, "", {"m"}},
    {"first_values.txt", "0 1 2\n4 5 6\n", {{0, 1, 2}, {4, 5, 6}}},
    {"prose.xyz", "# columns: x y z\n1 2 3\n4 5 6\n", kTwo},
    // Chemistry: atomic numbers, titles, columns of extended XYZ.
    {"atomnum.xyz", "3\n\n 6 1.0 2.0 3.0\n 7 4.0 5.0 6.0\n 8 7.0 8.0 9.5\n", kThree},
    {"atomnum_title.xyz", "3\nwater\n6 1 2 3 .1 .1 .1\n7 4 5 6 .1 .1 .1\n8 7 8 9.5 0 0 0\n",
     kThree},
    {"whole.xyz", "2\n\n6 1 2 3\n7 4 5 6\n", {}, "column 1 may be atomic numbers or x"},
    {"mass.xyz", "2\ntitle\n1 2 3 0.5\n4 5 6 1.5\n", {{2, 3, 0.5}, {5, 6, 1.5}}},
    {"title_names.xyz", "2\nmass x y z\n9 1 2 3\n9 4 5 6\n", kTwo, "", {"mass"}},
    {"title_like.xyz", "2\nwater 9 9 9\nO 1 2 3\nH 4 5 6\n", kTwo},
    {"title_numbers.xyz", "2\n1 2 3\nO 1 2 3\nH 4 5 6\n", kTwo},
    {"title_number.xyz", "2\n3\nO 1 2 3\nH 4 5 6\n", kTwo},
    {"title_energy.xyz", "2\nE = -76.4 1 2\nO 1 2 3\nH 4 5 6\n", kTwo},
    {"title_particle.xyz", "2\n7 8 9.5\n1 2 3\n4 5 6\n", {}, "a count of 2, but 3 particles"},
    {"no_title.xyz", "2\nO 1 2 3\nH 4 5 6\n", kTwo},
    {"extended.xyz",
     "2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:forces:R:3:pos:R:3 pbc=\"T T T\"\n"
     "C 9 9 9 1 2 3\nN 8 8 8 4 5 6\n",
     kTwo,
     "",
     {"forces_x", "forces_y", "forces_z"}},
    {"extended_first.xyz", "2\nproperties=pos:R:3:Z:I:1\n1 2 3 6\n4 5 6 8\n", kTwo, "", {"Z"}},
    {"extended_short.xyz",
     "1\nProperties=species:S:1:pos:R:3\nC 1 2 3 4\n",
     {},
     "Properties names 4"},
    {"extended_none.xyz",
     "1\nProperties=species:S:1:force:R:3\nC 1 2 3\n",
     {},
     "no columns x, y, z"},
    {"frames.xyz", "1\nt\nO 1 2 3\n1\nt\nO 1 2 4\n", {}, ":4: a second count"},
    // Counts.
    {"pts_count.xyz", "3\n1 2 3 10\n4 5 6 20\n7 8 9.5 30\n", kThree, "", {"column4"}},
    {"count_one.xyz", "1\n1 2 3\n", {{1, 2, 3}}},
    {"count_few.xyz", "4\n1 2 3\n4 5 6\n7 8 9.5\n", {}, ":1: a count of 4, but 3 particles follow"},
    {"count_many.xyz", "2\n1 2 3 10\n4 5 6 20\n7 8 9.5 30\n", {}, "a count of 2, but 3 particles"},
    {"count_title.xyz", "3\nwater\nO 1 2 3\nH 4 5 6\n", {}, "a count of 3, but 2 particles follow"},
    {"count.txt", "X;Y;Z\n2\n1;2;3\n4;5;6\n", kTwo},
    // Scans and extended XYZ by their extensions; columns without names.
    {"scan.pts",
     "2\n1 2 3 -9 255 0 0\n4 5 6 -8 1 1 1\n",
     kTwo,
     "",
     {"column4", "column5", "column6", "column7"}},
    {"scan.asc", "1 2 3 255 0 0\n4 5 6 1 1 1\n", kTwo, "", {"column4", "column5", "column6"}},
    {"names.asc", "//X Y Z R\n1 2 3 7\n4 5 6 7\n", kTwo, "", {"R"}},
    {"two_scans.pts", "1\n1 2 3\n1\n4 5 6\n", {}, ":3: a second count"},
    {"raster.asc", "ncols 2\nnrows 1\n1 2\n", {}, "expected x y z at least"},
    {"atoms.extxyz",
     "2\nProperties=species:S:1:forces:R:3:pos:R:3\nC 9 9 9 1 2 3\nN 8 8 8 4 5 6\n",
     kTwo,
     "",
     {"forces_x", "forces_y", "forces_z"}},
    {"seven.xyz",
     "1 2 3 .1 .1 .1 9\n4 5 6 .1 .1 .1 9\n",
     kTwo,
     "",
     {"column4", "column5", "column6", "column7"}},
    // Ends of lines.
    {"cr.xyz", "1 2 3 10\r4 5 6 20\r7 8 9.5 30\r", kThree},
    {"cr.csv", "m,x,y,z\r9,1,2,3\r9,4,5,6", kTwo, "", {"m"}},
    {"cr_once.csv", "x,y,z,m\n1,2,3,9\r4,5,6,9\n", kTwo, "", {"m"}},
    {"cr_lf.csv", "\r\nx,y,z,m\r\n\r\n1,2,3,9\r\n4,5,6,9", kTwo, "", {"m"}},
    {"last.txt", "x y z\n1 2 3\n4 5 6", kTwo},
    // Separators, at the ends of lines too.
    {"commas.txt", "x,y,z,m\n1,2,3,10\n4,5,6,20\n7,8,9.5,30\n", kThree, "", {"m"}},
    {"commas.xyz", "1, 2, 3,\n4, 5, 6,\n", kTwo},
    {"semicolons.dat", "1;2;3;\n4;5;6;\n", kTwo},
    {"blanks.csv", "x y z\n1 2 3\n4 5 6\n", kTwo},
    {"tabs.txt", "x\ty\tz\tmy mass\n1\t2\t3\t4\n4\t5\t6\t\n", kTwo, "", {"my mass"}},
    {"trailcomma.csv", "x,y,z,m\n1,2,3,10,\n4,5,6,20,\n7,8,9.5,30,\n", kThree, "", {"m"}},
    {"trail_header.csv", "x,y,z,,,\n1,2,3,,,\n4,5,6,,,\n,,,,,\n", kTwo},
    {"text.csv", "id,x,y,z,name\n1,1,2,3,a;b\n2,4,5,6,\"c, d\"\n", kTwo, "", {"id"}},
    {"cc.txt", "//X;Y;Z;Rf\n3\n1;2;3;1\n4;5;6;1\n7;8;9.5;1\n", kThree, "", {"Rf"}},
    {"cc_blanks.txt", "//X Y Z R G B\n2\n1 2 3 255 0 0\n4 5 6 1 1 1\n", kTwo, "", {"R", "G", "B"}},
    // Decimal commas.
    {"comma.txt", "1,5;2,5;3,5\n", {}, "'1,5', a decimal comma; expected decimal points"},
    {"comma.xyz", "1,5 2,5 3,5\n", {}, "a decimal comma"},
    {"comma_header.csv", "x;y;z\n1,5;2,5;3,5\n", {}, "a decimal comma"},
    {"comma_one.csv", "x;y;z;m\n1;2;3;1,5\n", {}, ":2: got '1,5' in column 4, a decimal comma"},
    {"comma_and_points.csv", "x;y;z\n1.234,5;2,5;3,5\n", {}, "'1.234,5', a decimal comma"},
    {"comma_quoted.csv", "\"1,5\",\"2,5\",\"3,5\"\n", {}, "a decimal comma"},
    // Missing values.
    {"miss_attr.csv", "x,y,z,m\n1,2,3,10\n4,5,6,\n", kTwo, "", {"m"}},
    {"miss_first.csv", "x,y,z,m\n1,2,3,\n4,5,6,7\n", kTwo, "", {"m"}},
    {"miss_x.csv", "x,y,z,m\n1,2,3,10\n,5,6,7\n", {}, ":3: got '' in column 1, expected a number"},
    {"miss_all.csv", "x,y,z,m\nNA,NA,NA,NA\n1,2,3,1\n", {}, ":2: got 'NA' in column 1"},
    {"miss_named.csv", "# x,y,z\nNA,NA,NA\n1,2,3\n", {}, ":2: got 'NA' in column 1"},
    {"inch.csv", "x,y,z,size (\")\n1,2,3,1\n4,5,6,1\n", kTwo},
    {"miss_units.csv", "x,y,z,m\nkpc,kpc,kpc,NA\n1,2,3,1\n4,5,6,1\n", kTwo},
    {"error_value.csv", "x,y,z\n1,2,3\n#N/A,5,6\n", {}, ":3: got '#N/A' in column 1"},
    {"error_first.csv", "x,y,z\n#DIV/0!,5,6\n1,2,3\n", {}, ":2: got '#DIV/0!' in column 1"},
    {"word_first.csv", "x,y,z,m\nc,,,\n1,2,3,1\n", {}, ":2: got 'c' in column 1"},
    {"one_unit.csv", "x,y,z,m\n,,,kg\n1,2,3,1\n4,5,6,1\n", kTwo},
    // Files behind each other.
    {"joined.txt", "# x y z\n1 2 3\n# x y z\n4 5 6\n", {}, ":3: a second line of names"},
    {"joined.csv", "x,y,z\n1,2,3\nx,y,z\n4,5,6\n", {}, ":3: a second line of names"},
    {"joined_commas.dat", "# x,y,z\n1 2 3\n# x,y,z\n4 5 6\n", {}, ":3: a second line of names"},
    {"comment.txt", "# x y z\n1 2 3\n# 2 more in y, z\n4 5 6\n", kTwo},
    {"two_lines.csv", "name,x,y,z\n\"a\nb\",1,2,3\nc,4,5,6\n", {}, "begins in line 2 and ends in"},
    {"miss_last.csv", "x,y,z,m\n1,2,3,10\n4,5,6\n", {}, ":3: got 3 columns, expected 4"},
};

}  // namespace

TEST(points_reported, positions_are_those_that_the_file_means) {
    const TempDir dir;
    for (const Case& one : kCases)
        for (const bool packed : {false, true}) {
            const std::string name = one.name + (packed ? ".gz" : "");
            write_bytes(dir / name, packed ? gzipped(one.text) : one.text);
            Points points;
            const std::string message = refusal([&] { points = read_points(dir / name); });
            if (!one.refusal.empty()) {
                EXPECT_NE(message.find(one.refusal), std::string::npos) << name << ": " << message;
                EXPECT_NE(message.find(name), std::string::npos) << message;
                continue;
            }
            EXPECT_EQ(message, "no error") << name;
            EXPECT_EQ(points.position, one.position) << name;
            std::vector<std::string> names;
            for (const PointAttribute& attribute : points.attributes)
                names.push_back(attribute.name);
            if (!one.attributes.empty()) {
                EXPECT_EQ(names, one.attributes) << name;
            }
        }
}

TEST(points_reported, files_in_the_table_of_reports) {
    const auto folder = source_dir() / ".." / "shared" / "reported";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    for (const char* name :
         {"atomnum.xyz", "pts_count.xyz", "cr.xyz", "commas.txt", "trailcomma.csv"})
        EXPECT_EQ(read_points(folder / name).position, kThree) << name;
    EXPECT_EQ(read_points(folder / "dup.csv").position, kTwo);
    EXPECT_EQ(read_points(folder / "cc.txt").position[0], (Vec3d{1.4, 2.7, 1.7}));
    EXPECT_EQ(read_points(folder / "miss_attr.csv").position[1], (Vec3d{4, 5, 6}));
}

TEST(points_reported, a_missing_value_is_refused_where_it_is_used) {
    const TempDir dir;
    write_bytes(dir / "m.csv", "x,y,z,vx,vy,vz,m,t\n1,2,3,4,5,6,,8\n1,2,4,,5,6,7,8\n");
    const Points points = read_points(dir / "m.csv");
    EXPECT_TRUE(std::isnan(points.attributes[0].value[0]));
    EXPECT_EQ(point_values(points, "t"), (BigVector<float>{8, 8}));
    EXPECT_NE(refusal([&] { point_values(points, "m"); }).find("'m' of particle 0 is missing"),
              std::string::npos);
    EXPECT_NE(refusal([&] { point_values(points, "speed"); }).find("'speed' of particle 1"),
              std::string::npos);
    write_bytes(dir / "words.csv", "x,y,z,m,n\n1,2,3,4,NA\n1,2,4,--,5\n");
    EXPECT_TRUE(std::isnan(read_points(dir / "words.csv").attributes[0].value[1]));
    EXPECT_TRUE(std::isnan(read_points(dir / "words.csv").attributes[1].value[0]));
    write_bytes(dir / "place.csv", "x,y,z\n1,2,3\n1,NA,4\n");
    EXPECT_NE(refusal([&] { read_points(dir / "place.csv"); }).find("got 'NA' in column 2"),
              std::string::npos);
    ValueNotes notes;
    write_bytes(dir / "n.csv", "x,y,z,m\n1,2,3,4\n1,2,4,\n");
    EXPECT_EQ(read_points(dir / "n.csv", {.values = {.skip_nonfinite = true}}, &notes).size(), 1u);
    EXPECT_EQ(notes.skipped_nonfinite, 1u);
    for (const char* name : {"again.csv", "again.xyz", "again.vdb"}) {
        write_points(dir / name, points);
        EXPECT_TRUE(std::isnan(read_points(dir / name).attributes[0].value[0])) << name;
    }
}

/// Masses in grams are beyond single precision.
TEST(points_reported, numbers_beyond_floats_have_a_unit) {
    const TempDir dir;
    write_bytes(dir / "m.csv", "x,y,z,m\n1,2,3,2e43\n1,2,4,1e42\n");
    write_bytes(dir / "n.csv", "x,y,z,m\n1,2,5,8e41\n");
    const std::vector<std::filesystem::path> files{dir / "n.csv", dir / "m.csv"};
    std::vector<std::string> notes;
    const Points points = read_points(files, {}, &notes);
    EXPECT_EQ(points.attributes[0].unit, 1e43);
    EXPECT_EQ(point_values(points, "m"), (BigVector<float>{0.08f, 2, 0.1f}));
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("'m' is divided by 1e+43"), std::string::npos) << notes[0];
    for (const char* name : {"again.csv", "again.xyz", "again.vdb"}) {
        write_points(dir / name, points);
        const Points again = read_points(dir / name);
        EXPECT_EQ(again.attributes[0].unit, 1e43) << name;
        float most = 0;
        for (const float value : again.attributes[0].value) most = std::max(most, value);
        EXPECT_EQ(most, 2) << name;
    }
}

/// Masses of molecules in solar masses are below it; zeros have every unit.
TEST(points_reported, numbers_below_floats_have_a_unit) {
    const TempDir dir;
    write_bytes(dir / "m.csv", "x,y,z,m,n\n1,2,3,2e-57,1e-50\n1,2,4,-3e-58,7\n");
    write_bytes(dir / "n.csv", "x,y,z,m,n\n1,2,5,0,0\n");
    for (const char* first : {"m.csv", "n.csv"}) {
        const std::vector<std::filesystem::path> files{dir / first,
                                                       dir / (first[0] == 'm' ? "n.csv" : "m.csv")};
        std::vector<std::string> notes;
        const Points points = read_points(files, {}, &notes);
        EXPECT_NEAR(points.attributes[0].unit / 1e-57, 1, 1e-12);
        EXPECT_EQ(points.attributes[1].unit, 1) << "1e-50 is nothing beside 7";
        BigVector<float> masses = point_values(points, "m");
        std::ranges::sort(masses);
        EXPECT_EQ(masses, (BigVector<float>{-0.3f, 0, 2}));
        ASSERT_EQ(notes.size(), 1u);
        EXPECT_NE(notes[0].find("'m' is divided by 1e-57"), std::string::npos) << notes[0];
        write_points(dir / "again.csv", points);
        EXPECT_NEAR(read_points(dir / "again.csv").attributes[0].unit / 1e-57, 1, 1e-12);
    }
}

TEST(points_reported, positions_have_the_unit_of_their_columns) {
    const TempDir dir;
    write_bytes(dir / "a.csv", "X [kpc],Y [kpc],Z [kpc]\n1,2,3\n");
    write_bytes(dir / "b.csv", "X [Mpc],Y [Mpc],Z [Mpc]\n1,2,3\n");
    EXPECT_EQ(read_points(dir / "a.csv").length_unit, "kpc");
    for (const char* name : {"um", "\xc2\xb5m", "\xce\xbcm", "micron"}) {
        write_bytes(dir / "u.csv", fmt::format("x [{0}],y [{0}],z [{0}]\n1,2,3\n", name));
        EXPECT_EQ(read_points(dir / "u.csv").length_unit, "um") << name;
    }
    const std::vector<std::filesystem::path> files{dir / "a.csv", dir / "b.csv"};
    EXPECT_NE(refusal([&] { read_points(files, {}, nullptr); }).find("in 'Mpc', expected 'kpc'"),
              std::string::npos);
    write_bytes(dir / "none.csv", "x,y,z\n1,2,3\n");
    const std::vector<std::filesystem::path> mixed{dir / "a.csv", dir / "none.csv"};
    EXPECT_NE(refusal([&] { read_points(mixed, {}, nullptr); }).find("in no unit, expected 'kpc'"),
              std::string::npos);
    write_bytes(dir / "row.csv", "x,y,z,m\nkpc,kpc,kpc,Msun\n1,2,3,4\n");
    write_bytes(dir / "brackets.csv", "x,y,z\n[kpc],[kpc],[pc]\n1,2,3000\n");
    write_bytes(dir / "table.ecsv",
                "# %ECSV 1.0\n# ---\n# datatype:\n# - {name: x, unit: kpc, datatype: float64}\n"
                "# - {name: y, unit: \"kpc\", datatype: float64}\n# - {name: z, datatype: float64, "
                "unit: kpc}\n"
                "x y z\n1 2 3\n");
    const std::string serialized =
        "# meta: !!omap\n# - __serialized_columns__:\n#     x:\n"
        "#       unit: &id001 !astropy.units.Unit {unit: kpc}\n"
        "#       value: !astropy.table.SerializedColumn {name: x}\n#     z:\n"
        "#       unit: !astropy.units.Unit {unit: pc}\n"
        "#       value: !astropy.table.SerializedColumn {name: z}\n";
    write_bytes(dir / "quantities.dat",
                "# %ECSV 1.0\n# ---\n# datatype:\n# - {name: x, unit: kpc, datatype: float64}\n"
                "# - {name: y, unit: kpc, datatype: float64}\n"
                "# - {name: z, unit: pc, datatype: float64}\n" +
                    serialized + "x y z\n1 2 3000\n");
    std::string lines = "# %ECSV 1.0\n# ---\n# datatype:\n";
    for (const char* const column : {"x\n#   unit: kpc", "y\n#   unit: kpc", "z\n#   unit: pc"})
        lines += "# - name: " + std::string(column) +
                 "\n#   datatype: float64\n#   meta: !!omap\n#   - {ucd: pos}\n";
    write_bytes(dir / "lines.dat", lines + "# schema: astropy-2.0\nx y z\n1 2 3000\n");
    for (const char* name :
         {"row.csv", "brackets.csv", "table.ecsv", "quantities.dat", "lines.dat"}) {
        const Points points = read_points(dir / name);
        EXPECT_EQ(points.length_unit, "kpc") << name;
        ASSERT_EQ(points.size(), 1u) << name;
        EXPECT_NEAR(points.position[0].z, 3, 1e-12) << name;
    }
    write_bytes(dir / "words.csv", "x,y,z\nfirst,second,third\n1,2,3\n");
    EXPECT_EQ(read_points(dir / "words.csv").length_unit, "");
}

TEST(points_reported, files_named_twice_are_refused) {
    const TempDir dir;
    write_bytes(dir / "a.csv", "x,y,z\n1,2,3\n");
    const std::vector<std::filesystem::path> files{dir / "a.csv", dir / "." / "a.csv"};
    EXPECT_NE(refusal([&] { read_points(files, {}, nullptr); }).find("a.csv: named twice"),
              std::string::npos);
}

/// 20,000 lines took 13.5 s: every line was sought to the end of the file.
TEST(points_reported, time_is_linear_for_every_end_of_line) {
    const TempDir dir;
    const auto seconds = [&](const char* name, const char* end) {
        std::string text;
        for (int n = 0; n < 200'000; ++n) text += "1 2 3" + std::string(end);
        write_bytes(dir / name, text);
        const auto start = std::chrono::steady_clock::now();
        EXPECT_EQ(read_points(dir / name).size(), 200'000u);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const double lf = seconds("lf.xyz", "\n"), cr = seconds("cr.xyz", "\r");
    // Quadratic time would be thousands of times as long; the rest allows for a busy machine.
    EXPECT_LT(cr, 20 * lf + 1);
}

TEST(points_reported, columns_that_their_places_name_are_noted) {
    struct Row {
        std::string name, text, note;
        bool velocity = false;
    };
    const std::vector<Row> rows{
        {"element.xyz", "2\nwater\nO 1 2 3\nH 4 5 6\n", ""},
        {"names.txt", "x y z vx vy vz\n1 2 3 4 5 6\n", "", true},
        {"four.dat", "1 2 3 4\n4 5 6 4\n", "four.dat: no names of columns: 1, 2, 3 are x, y, z ("},
        {"six.xyz", "1 2 3 4 5 6\n", "1, 2, 3 are x, y, z and 4, 5, 6 the velocity (--columns",
         true},
        {"seven.xyz", "1\nt\nO 1 2 3 4 5 6\n", "2, 3, 4 are x, y, z and 5, 6, 7 the velocity",
         true},
        {"many.csv", "1,2,3,4,5,6,7\n", "1, 2, 3 are x, y, z ("},
        {"scan.pts", "1 2 3 4 5 6\n", "1, 2, 3 are x, y, z ("}};
    const TempDir dir;
    for (const Row& row : rows) {
        write_bytes(dir / row.name, row.text);
        const std::filesystem::path file = dir / row.name;
        std::vector<std::string> notes;
        EXPECT_EQ(read_points(std::span(&file, 1), {}, &notes).velocity.empty(), !row.velocity);
        EXPECT_EQ(notes.size(), row.note.empty() ? 0u : 1u) << row.name;
        if (!row.note.empty()) {
            EXPECT_NE(notes.at(0).find(row.note), std::string::npos) << notes.at(0);
        }
        notes.clear();
        read_points(std::span(&file, 1), {.columns = {"2", "3", "4"}}, &notes);
        EXPECT_TRUE(notes.empty()) << row.name;
    }
}

}  // namespace vog::test
