// scan_refused_test.cpp: Dense images that contradict themselves, each refused in one line, and their neighbours that do not.
#include "io/scan/scan_kinds.h"

namespace vog::test {

TEST(scan_refused, more_values_than_the_head_states) {
    const std::string raw = "encoding: raw\n", local = "ElementDataFile = LOCAL\n",
                      more = counted() + counted();
    const std::string text = [] {
        std::string numbers;
        for (const std::int16_t v : scan_values()) numbers += fmt::format("{} ", v);
        return numbers;
    }();
    const Affine edges = diagonal({0.5, 1, 2});
    const auto met_long = [](const std::string& fields) {
        std::string head = mha(fields);
        return head.replace(head.find("MET_SHORT"), 9, "MET_LONG");
    };
    expect_refused({
        {{{"a.nhdr", nrrd(raw + "data file: b\n")}, {"b", "head" + counted()}},
         "b: 52 bytes of values, expected 48 for 24 values of int16: state 'byte skip: -1'"},
        {{{"a.nhdr", nrrd(raw + "data file: b\n")}, {"b", std::string(4, '\0') + counted()}},
         "52 bytes of values, expected 48"},
        {with_slices({{"a.nhdr", nrrd(raw + "data file: LIST\ns0\ns1\ns2\ns3")}}, "s{}", "head"),
         "s0: 16 bytes of values, expected 12 for 6 values of int16"},
        {{{"a.nrrd", nrrd(raw + "\n") + more}}, "96 bytes of values, expected 48"},
        {{{"a.nrrd", nrrd("encoding: gzip\n\n") + gzipped(more)}},
         "96 bytes unpacked of values, expected 48"},
        {with_slices({{"a.nhdr", nrrd("encoding: gzip\ndata file: s%d 0 3 1 2\n")}}, "s{}", "head",
                     true),
         "16 bytes unpacked of values, expected 12"},
        {{{"a.nrrd", nrrd("encoding: hex\n\n") + std::string(94, '0')}}, "truncated"},
        {{{"a.nrrd", nrrd("encoding: hex\n\n") + std::string(95, '0')}}, "truncated"},
        {{{"a.nrrd", nrrd("encoding: hex\n\n") + std::string(95, '0') + "g"}},
         "'g' among hexadecimal digits"},
        {{{"a.nrrd", nrrd("encoding: hex\n\n") + std::string(98, '1')}},
         "49 bytes unpacked of values, expected 48"},
        {{{"a.nrrd", nrrd("encoding: bzip2\n\n") + counted()}},
         "encoding 'bzip2', expected raw, gzip (unu save -e gzip), hex or ascii"},
        {{{"a.nii.gz", gzipped(Nifti{}.head() + counted()) + "tail"}},
         "behind the end of the deflated stream, expected none"},
        {{{"a.nrrd", nrrd("encoding: text\n\n") + text + "25 26\n"}},
         "26 values as text, expected 24"},
        {{{"a.nrrd", nrrd("encoding: text\n\n") + text + ",5"}}, "decimals have a point"},
        {{{"a.mhd", mha("ElementDataFile = b\n")}, {"b", "head" + counted()}},
         "b: 52 bytes of values, expected 48 for 24 values of int16"},
        {{{"a.mha", mha(local) + more}}, "ElementNumberOfChannels for several in each voxel"},
        {{{"a.mha", met_long(local) + more + more}}, "MET_LONG_LONG for 8 bytes each"},
        {{{"a.nii", Nifti{}.head() + more}}, "96 bytes of values, expected 48"},
        {{{"a.nii.gz", gzipped(Nifti{}.head() + more)}},
         "96 bytes unpacked of values, expected 48"},
    });
    expect_kinds({
        {"a newline at the end", {{"a.nrrd", nrrd(raw + "\n") + counted() + "\r\n"}}},
        {"zeros at the end", {{"a.mha", mha(local) + counted() + std::string(8, '\0')}}},
        {"zeros behind a packed file",
         {{"a.nii.gz", gzipped(Nifti{}.head() + counted()) + std::string(9, '\0')}},
         {"value"},
         edges,
         "",
         "mm"},
        {"text that ends in blanks", {{"a.nrrd", nrrd("encoding: text\n\n") + text + " \n\n"}}},
        {"a stated place", {{"a.nhdr", nrrd(raw + "byte skip: 0\ndata file: b\n")}, {"b", more}}},
        {"the place of a slab",
         {{"a.mhd", mha("HeaderSize = 4\nElementDataFile = b\n")}, {"b", "head" + more}}},
        {"channels of packed voxels",
         {{"a.nrrd", nrrd("kinds: vector domain domain domain\nencoding: gzip\n\n", "2 2 3 4", 4) +
                         gzipped(side_by_side())}},
         {"c0", "c1"}},
        {"less than a slice behind NIfTI",
         {{"a.nii", Nifti{}.head() + counted() + std::string(11, 'x')}},
         {"value"},
         edges,
         "",
         "mm"},
    });
}

TEST(scan_refused, nrrd_that_contradicts_itself) {
    const auto file = [](const std::string& fields, const std::string& sizes = "2 3 4") {
        return Files{{"a.nrrd", nrrd(fields + "encoding: raw\n\n", sizes) + counted()}};
    };
    const std::string directions = "space directions: (2,0,0) (0,2,0) (0,0,3)\n";
    expect_refused({
        {file("space: RAS\n" + directions + "space origin: (10,20)\n"),
         "of 2 components in a space of 3 dimensions"},
        {file("space: RAS\nspace directions: (2,0) (0,2) (0,3)\n"),
         "of 2 components in a space of 3"},
        {file("space dimension: 4\n" + directions), "of 3 components in a space of 4"},
        {file("axis mins: 1 2 3\naxis maxs: 5 8 11\nspacings: 1 2 2\n"),
         "axis 1 from 1 to 5, which is a spacing of 2, but its spacing is 1"},
        {file("axis mins: 1 2 3\naxis maxs: 3 6 9\nspacings: 2 2 2\ncenters: cell cell cell\n"),
         "axis 1 from 1 to 3, which is a spacing of 1, but its spacing is 2"},
        {file("spacings: 2 3 inf\n"), "axis 3 with spacing inf"},
        {file("axis mins: 0 -inf 0\n"), "axis 2 with spacing nan from -inf"},
    });
    const Affine map = diagonal({2, 2, 3}, {2, 3, 4.5});
    expect_kinds({
        {"places and spacings that agree",
         file("axis mins: 1 2 3\naxis maxs: 5 8 15\nspacings: 2 2 3\n"),
         {"value"},
         map},
        {"places of samples, by the spacings",
         file("axis mins: 2 3 4.5\naxis maxs: 4 7 13.5\nspacings: 2 2 3\n"),
         {"value"},
         map},
        {"largest places only", file("axis maxs: 5 8 15\nspacings: 2 2 3\n"), {"value"}, map},
        {"an axis without a place",
         file("axis mins: 1 nan 3\nspacings: 2 2 3\n"),
         {"value"},
         diagonal({2, 2, 3}, {2, 0, 4.5}),
         "",
         "",
         "axis 2 has no least place, read as 0"},
    });
}

TEST(scan_refused, doubles_beyond_single_precision) {
    const auto doubles = [](double factor, bool big_endian = false) {
        std::vector<double> values;
        for (const std::int16_t v : scan_values()) values.push_back(factor * v);
        return bytes_of(values, big_endian);
    };
    Nifti nifti, scaled;
    nifti.datatype = 64;
    scaled.slope = 1e-30f;
    scaled.datatype = 16;
    const std::vector<float> small(24, 1e-20f);
    const std::string head = nrrd("encoding: raw\n\n");
    const auto as_double = [](std::string text) {
        return text.replace(text.find("short"), 5, "double");
    };
    expect_refused({
        {{{"a.nii", nifti.head() + doubles(1e-300)}},
         "a.nii: values up to 2.4e-299, expected ones within single precision, 1.2e-38 to "
         "3.4e+38: write them in another unit, or change scl_slope"},
        {{{"a.nii", nifti.head() + doubles(-1e300)}}, "values up to 2.4e+301"},
        {{{"a.nii", scaled.head() + bytes_of(small)}}, "values up to 1e-50"},
        {{{"a.nrrd", as_double(head) + doubles(1e-45)}}, "values up to 2.4e-44"},
        {{{"a.nrrd", as_double(nrrd("encoding: text\n\n")) + "1e-50 " +
                         [] {
                             std::string zeros;
                             for (int n = 1; n < 24; ++n) zeros += "0 ";
                             return zeros;
                         }()}},
         "values up to 1e-50"},
        {{{"a.fits", fits_of(cube_cards("-64"), doubles(1e-45, true))}}, "or change BSCALE"},
    });
    // Far smaller values beside others are as good as 0.
    std::vector<double> wide(24, 1e-300);
    wide[0] = 1;
    const TempDir dir;
    EXPECT_EQ(value_at(read_bytes(dir, "a.nii", nifti.head() + bytes_of(wide)), {0, 0, 0}), 1);
}

TEST(scan_refused, heads_with_fields_that_are_no_numbers) {
    Nifti infinite;
    infinite.slope = std::numeric_limits<float>::infinity();
    std::string close = Nifti{}.head();
    Nifti::put(close, 108, 348.0f, false);
    std::vector<std::string> cards = cube_cards("16");
    cards.push_back(card("CDELT3", "'abc'"));
    std::string packed = tiff_of({{1, 2}}, 2, 1);
    packed.replace(packed.find(std::string{3, 1, 3, 0}), 12,
                   std::string{3, 1, 3, 0, 1, 0, 0, 0, '\x98', '\x87', 0, 0});  // JPEG 2000
    std::vector<std::pair<Files, std::string>> rows{
        {{{"a.nii", infinite.head() + counted()}}, "scl_slope is inf"},
        {{{"a.nii", close + counted()}}, "values at byte 348, expected 352 or more"},
        {{{"a.fits", fits_of(cards, bytes_of(scan_values(), true))}},
         "CDELT3 is 'abc', expected a number"},
        {{{"a.tif", packed}}, "compression 34712, which this build's libtiff does not read"},
    };
    for (const auto& [fields, text] : std::vector<std::pair<std::string, std::string>>{
             {R"("size": "2x3x4")", R"(size is "2x3x4", expected 3 whole numbers)"},
             {R"("size": [2, 3, 4, 1])", "size is [2,3,4,1], expected 3 whole numbers"},
             {R"("size": [2, 3.5, 4])", "size is [2,3.5,4], expected 3 whole numbers"},
             {R"("size": [2, 3, 4], "spacing": [1, 2])", "spacing is [1,2], expected 3 numbers"},
             {R"("size": [2, 3, 4], "spacing": [-1, 2, 3])", "a.raw.json: voxel size -1 x 2 x 3"},
             {R"("size": [2, 3, 4], "matrix": [[1, 0, 0, 0]])", "expected 4 rows of 4 numbers"},
             {R"("size": [2, 3, 4], "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,1,1]])",
              "a.raw.json: matrix: last row 0 0 1 1"},
             {R"("size": [2, 3, 4], "unit": 3)", "unit is 3, expected a text"}})
        rows.push_back(
            {{{"a.raw", counted()}, {"a.raw.json", "{\"type\": \"int16\", " + fields + "}"}},
             text});
    expect_refused(rows);
}

}  // namespace vog::test
