// scan_kinds_test.cpp: dense images of which other tools' users reported wrong places or values, a row each.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <utility>

#include "io/scan/scan_files.h"

namespace vog::test {

namespace {

using Files = std::vector<std::pair<std::string, std::string>>;

/// Files, the first of which is read, and what lies in it.
struct Kind {
    std::string what;
    Files files;
    std::vector<std::string> names{"value"};
    Affine map{};
    std::string grid{};  ///< with values 1 to 24; empty: the first of `names`
    std::string unit{};
    std::string note{};  ///< part of it; empty: none
};

std::string counted() { return bytes_of(scan_values()); }
/// Slices of the counted values as files of six voxels each.
Files with_slices(Files files, const std::string& pattern, const std::string& before = "",
                  bool packed = false) {
    for (int z = 0; z < 4; ++z) {
        const std::string slice = before + counted().substr(static_cast<std::size_t>(12 * z), 12);
        files.emplace_back(fmt::format(fmt::runtime(pattern), z), packed ? gzipped(slice) : slice);
    }
    return files;
}
/// Counted values beside others in every voxel.
std::string side_by_side() {
    std::string bytes;
    for (const std::int16_t v : scan_values())
        bytes += bytes_of(std::vector<std::int16_t>{v, static_cast<std::int16_t>(100 + v)});
    return bytes;
}
std::string two_frames() { return bytes_of(scan_values(100)) + counted(); }

std::string mha(const std::string& more, const std::string& sizes = "2 3 4", int axes = 3) {
    return fmt::format("ObjectType = Image\nNDims = {}\nDimSize = {}\nElementType = MET_SHORT\n{}",
                       axes, sizes, more);
}
std::string nrrd(const std::string& more, const std::string& sizes = "2 3 4", int axes = 3) {
    return fmt::format("NRRD0005\ntype: short\ndimension: {}\nsizes: {}\nendian: little\n{}", axes,
                       sizes, more);
}

void expect_kinds(const std::vector<Kind>& kinds) {
    for (const Kind& kind : kinds) {
        SCOPED_TRACE(kind.what);
        const TempDir dir;
        for (const auto& [name, bytes] : kind.files) {
            std::filesystem::create_directories((dir / name).parent_path());
            write_bytes(dir / name, bytes);
        }
        const std::filesystem::path file = dir / kind.files[0].first;
        if (absent(file)) GTEST_SKIP() << "this build lacks the library of " << file.extension();
        ASSERT_EQ(refusal([&] { grid_names(file); }), "no error");
        EXPECT_EQ(grid_names(file), kind.names);
        const std::string grid = kind.grid.empty() ? kind.names[0] : kind.grid;
        std::vector<std::string> notes;
        const Volume volume = read_volume(file, {.grid = grid}, &notes);
        expect_counted(volume, kind.what);
        expect_map(volume.world_from_index, kind.map);
        EXPECT_EQ(volume_head(file, grid).length_unit, kind.unit);
        EXPECT_EQ(notes.size(), kind.note.empty() ? 0u : 1u);
        EXPECT_TRUE(notes.empty() || notes[0].find(kind.note) != std::string::npos) << notes[0];
        EXPECT_EQ(volume_note(file), notes.empty() ? "" : notes[0]);
    }
}

/// Expects each file to be refused in one line with this text.
void expect_refused(const std::vector<std::pair<Files, std::string>>& rows) {
    for (const auto& [files, text] : rows) {
        const TempDir dir;
        for (const auto& [name, bytes] : files) write_bytes(dir / name, bytes);
        if (absent(dir / files[0].first)) continue;
        const std::string message = refusal([&] { read_volume(dir / files[0].first); });
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

}  // namespace

TEST(scan_kinds, metaimage) {
    const Affine ras = diagonal({-1.5, -2, 3}, {-10, 20, 30});
    const std::string space4 =
        "Offset = 10 -20 30 0\nElementSpacing = 1.5 2 3 1\nAnatomicalOrientation = ????\n"
        "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
    const std::string local = "ElementDataFile = LOCAL\n";
    expect_kinds({
        {"four axes",
         {{"a.mha", mha(space4, "2 3 4 2", 4) + local + two_frames()}},
         {"t0", "t1"},
         ras,
         "t1"},
        {"three axes",
         {{"a.mha",
           mha("Offset = 10 -20 30\nElementSpacing = 1.5 2 3\nAnatomicalOrientation = RAI\n") +
               local + counted()}},
         {"value"},
         ras},
        {"no newline at the end",
         {{"a.mhd", mha("ElementSpacing = 1 2 3\nElementDataFile = b.raw")}, {"b.raw", counted()}},
         {"value"},
         diagonal({1, 2, 3})},
        {"flags, comments, colons",
         {{"a.mha", mha("BinaryData : T\nCompressedData = f\nComment = one\nComment = two: 2\n") +
                        local + counted()}}},
        {"most significant byte first",
         {{"a.mha", mha("BinaryDataByteOrderMSB = t\n") + local + bytes_of(scan_values(), true)}}},
        {"a list of slices",
         with_slices({{"a.mhd", mha("ElementDataFile = LIST\ns0\ns1\ns2\ns3")}}, "s{}")},
        {"a list with its axes",
         with_slices({{"a.mhd", mha("ElementDataFile = LIST 2D\ns0\ns1\n\ns2\ns3\n")}}, "s{}")},
        {"a list of one", {{"a.mhd", mha("ElementDataFile = LIST 3D\nall\n")}, {"all", counted()}}},
        {"numbered slices",
         with_slices({{"a.mhd", mha("ElementDataFile = s%03d.raw 0 3 1\n")}}, "s{:03}.raw")},
        {"heads before slices",
         with_slices({{"a.mhd", mha("HeaderSize = -1\nElementDataFile = s%d 0 3 1\n")}}, "s{}",
                     "head")},
        {"packed slices",
         with_slices({{"a.mhd", mha("CompressedData = True\nElementDataFile = s%d 0 3 1\n")}},
                     "s{}", "", true)},
    });
    expect_refused({
        {{{"a.mha", mha("Offset = 1 2 3\nOffset = 4 5 6\n") + local + counted()}},
         "offset '1 2 3' and '4 5 6'"},
        {{{"a.mha", mha("BinaryData = Yes\n") + local + counted()}},
         "binarydata 'yes', expected True or False"},
        {{{"a.mha", mha(space4, "2 3 4 2", 4)
                            .replace(mha(space4, "2 3 4 2", 4).find("1 0 0 0 0"), 9, "1 0 0 5 0") +
                        local + two_frames()}},
         "mixes space and time"},
        {{{"a.mhd", mha("ElementDataFile = LIST\ns0\ns1\n")}},
         "2 files of values, expected 4 with 2 axes each"},
        {{{"a.mhd", mha("ElementDataFile = s%d 0 3 0\n")}}, "expected FIRST LAST STEP"},
    });
}

TEST(scan_kinds, nrrd) {
    const Affine voxels = diagonal({2, 2, 3});
    const std::string raw = "encoding: raw\n";
    const std::string directions4 =
        "space dimension: 4\nspace directions: (2,0,0,0) (0,2,0,0) (0,0,3,0) (0,0,0,1)\n"
        "kinds: domain domain domain domain\nspace origin: (7,8,9,0)\n";
    const std::string lps4 =
        "space: left-posterior-superior-time\nspace directions: (2,0,0,0) (0,2,0,0) (0,0,3,0) "
        "(0,0,0,1)\n"
        "space origin: (1,2,3,0)\n";
    expect_kinds({
        {"NaN marks the axis of channels",
         {{"a.nrrd", nrrd("spacings: nan 2 2 3\n" + raw + "\n", "2 2 3 4", 4) + side_by_side()}},
         {"c0", "c1"},
         voxels},
        {"NaN marks the axis of frames",
         {{"a.nrrd", nrrd("spacings: 2 2 3 nan\n" + raw + "\n", "2 3 4 2", 4) + two_frames()}},
         {"t0", "t1"},
         voxels,
         "t1"},
        {"no spacing at all is stated",
         {{"a.nrrd", nrrd("spacings: nan nan nan\n" + raw + "\n") + counted()}}},
        {"directions of NaN",
         {{"a.nrrd",
           nrrd("space dimension: 3\nspace directions: (nan,nan,nan) (2,0,0) (0,2,0) (0,0,3)\n" +
                    raw + "\n",
                "2 2 3 4", 4) +
               side_by_side()}},
         {"c0", "c1"},
         voxels},
        {"four axes of SimpleITK",
         {{"a.nrrd", nrrd(directions4 + raw + "\n", "2 3 4 2", 4) + two_frames()}},
         {"t0", "t1"},
         diagonal({2, 2, 3}, {7, 8, 9}),
         "t1"},
        {"space and time",
         {{"a.nrrd", nrrd(lps4 + raw + "\n", "2 3 4 2", 4) + two_frames()}},
         {"t0", "t1"},
         diagonal({-2, -2, 3}, {-1, -2, 3}),
         "t1"},
        {"no newline at the end",
         {{"a.nhdr", nrrd("encoding: raw\ndata file: sub/b\nspacings: 2 2 3\nbyte skip: 4")},
          {"sub/b", "head" + counted()}},
         {"value"},
         voxels},
        {"lines that end in CR",
         {{"a.nhdr",
           "NRRD0001\rtype: short\rdimension: 3\rsizes: 2 3 4\rendian: little\rencoding: "
           "raw\rspacings: 2 2 3\rdata file: b"},
          {"b", counted()}},
         {"value"},
         voxels},
        {"lines before a packed stream",
         {{"a.nhdr", nrrd("encoding: gzip\nline skip: 2\ndata file: b\n")},
          {"b", "one\ntwo\n" + gzipped(counted())}}},
        {"the end of a packed stream",
         {{"a.nhdr", nrrd("encoding: gzip\nbyte skip: -1\ndata file: b.nii.gz\n")},
          {"b.nii.gz", gzipped(Nifti{}.head() + counted())}}},
        {"bytes before the end",
         {{"a.nhdr", nrrd("encoding: raw\nline skip: 9\nbyte skip: -3\ndata file: b\n")},
          {"b", "head" + counted() + "xx"}}},
        {"a list",
         with_slices({{"a.nhdr", nrrd("encoding: raw\ndata file: LIST\ns0\ns1\ns2\ns3")}}, "s{}")},
        {"numbered",
         with_slices(
             {{"a.nhdr", nrrd("encoding: raw\nbyte skip: 4\ndata file: s%02d.raw 0 3 1\n")}},
             "s{:02}.raw", "head")},
        {"numbered and packed",
         with_slices({{"a.nhdr", nrrd("encoding: gzip\ndata file: s%d 0 3 1 2\n")}}, "s{}", "",
                     true)},
        {"slabs",
         {{"a.nhdr", nrrd("encoding: raw\ndata file: h%d 0 1 1 3\n")},
          {"h0", counted().substr(0, 24)},
          {"h1", counted().substr(24)}}},
        {"units of each axis",
         {{"a.nrrd",
           nrrd("units: \"mm\" \"mm\" \"um\"\nspacings: 2 2 3000\n" + raw + "\n") + counted()}},
         {"value"},
         voxels,
         "",
         "mm"},
        {"from the least place to the largest",
         {{"a.nrrd",
           nrrd("axis mins: 0 0 0\naxis maxs: 2 4 9\ncenters: node node node\n" + raw + "\n") +
               counted()}},
         {"value"},
         diagonal({2, 2, 3})},
    });
    expect_refused({
        {{{"a.nrrd",
           nrrd("space: left-posterior-superior\nspace origin: (1,2,3)\nspacings: 2 2 3\n" + raw +
                "\n") +
               counted()}},
         "space origin without space directions"},
        {{{"a.nrrd", nrrd("units: \"mm\" \"mm\" \"s\"\n" + raw + "\n") + counted()}},
         "axes in units 'mm, mm, s'"},
        {{{"a.nrrd",
           nrrd("space dimension: 4\nspace directions: (2,0,0,1) (0,2,0,0) (0,0,3,0) (0,0,0,1)\n" +
                    raw + "\n",
                "2 3 4 2", 4) +
               two_frames()}},
         "runs in space and in time"},
    });
}

TEST(scan_kinds, nifti) {
    const Affine turned{{{Vec3d{0, -1, 0}, {0.5, 0, 0}, {0, 0, 2}}}, {10, 20, 30}};
    Nifti quaternion;
    quaternion.qform = 1;
    quaternion.quatern = {0, 0, std::sqrt(0.5f), 10, 20, 30};
    Nifti zeros = quaternion, singular = quaternion, without = Nifti{}, flat = quaternion, timeless,
          several;
    zeros.sform = singular.sform = without.sform = 1;
    singular.srow = {1, 1, 0, 5, 1, 1, 0, 6, 0, 0, 1, 7};
    flat.pixdim[1] = 0;
    timeless.dim = {5, 2, 3, 4, 0, 0, 1, 1};
    several.dim = {5, 2, 3, 4, 2, 2, 1, 1};
    std::string offset = Nifti{}.head();
    Nifti::put(offset, 108, 0.0f, false);
    const Affine edges = diagonal({0.5, 1, 2});
    const Affine one{{{Vec3d{0, -1, 0}, {1, 0, 0}, {0, 0, 2}}}, {10, 20, 30}};
    expect_kinds({
        {"an sform of zeros",
         {{"a.nii", zeros.head() + counted()}},
         {"value"},
         turned,
         "",
         "mm",
         "the qform places"},
        {"a singular sform",
         {{"a.nii.gz", gzipped(singular.head() + counted())}},
         {"value"},
         turned,
         "",
         "mm",
         "the qform places"},
        {"offset 0",
         {{"a.nii", offset + counted()}},
         {"value"},
         edges,
         "",
         "mm",
         "vox_offset is 0, read as 352"},
        {"edge 0",
         {{"a.nii", flat.head() + counted()}},
         {"value"},
         one,
         "",
         "mm",
         "pixdim[1] is 0, read as 1"},
        {"dimension 0",
         {{"a.nii", timeless.head() + counted()}},
         {"value"},
         edges,
         "",
         "mm",
         "dim[4] is 0, read as 1; dim[5]"},
        {"frames of vectors",
         {{"a.nii", several.head() + two_frames() + two_frames()}},
         {"t0c0", "t1c0", "t0c1", "t1c1"},
         edges,
         "t1c1",
         "mm"},
    });
    Nifti far = quaternion;
    far.quatern = {0.8f, 0, 0.8f, 0, 0, 0};
    expect_refused(
        {{{{"a.nii", without.head() + counted()}}, "an sform that is singular and no qform"},
         {{{"a.nii", far.head() + counted()}}, "expected a length up to 1"}});
}

TEST(scan_kinds, tiff) {
    using Pages = std::vector<std::vector<std::uint16_t>>;
    const auto slices = [](std::uint16_t first) {
        Pages pages(4);
        for (std::uint16_t n = 0; n < 24; ++n)
            pages[n / 6].push_back(static_cast<std::uint16_t>(first + n));
        return pages;
    };
    const auto all = [](Pages a, const Pages& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    const auto ome = [](const std::string& attributes, const std::string& inside = "") {
        return "<?xml version=\"1.0\"?><!-- <Pixels> --><OME><Image><Pixels "
               "DimensionOrder=\"XYZCT\" SizeX=\"2\" "
               "SizeY=\"3\" " +
               attributes + ">" + inside + "</Pixels></Image></OME>";
    };
    const std::string z4 = "SizeZ=\"4\" SizeC=\"1\" SizeT=\"1\" ",
                      c2 = "SizeZ=\"4\" SizeC=\"2\" SizeT=\"1\" ";
    const auto edges = [](const std::string& z, const std::string& unit) {
        return "PhysicalSizeX=\"200\" PhysicalSizeXUnit=\"nm\" PhysicalSizeY=\"200\" "
               "PhysicalSizeYUnit=\"nm\" "
               "PhysicalSizeZ=\"" +
               z + "\" PhysicalSizeZUnit=\"" + unit + "\"";
    };
    // Channels of slices that lie side by side, by TiffData in an order of their own.
    Pages mixed;
    std::string places;
    for (std::size_t z = 0; z < 4; ++z)
        for (std::size_t c = 0; c < 2; ++c) {
            places +=
                fmt::format("<TiffData IFD=\"{}\" FirstZ=\"{}\" FirstC=\"{}\" PlaneCount='1'/>",
                            mixed.size(), z, 1 - c);
            mixed.push_back(slices(static_cast<std::uint16_t>(c == 0 ? 100 : 1))[z]);
        }
    std::string one_page;
    for (const auto& page : slices(1))
        if (page[0] > 1) one_page += bytes_of(page);
    const Pages first{slices(1)[0]};
    const auto file = [](const std::string& bytes) { return Files{{"a.tif", bytes}}; };
    std::vector<Kind> kinds{
        {"z in another unit",
         file(tiff_of(slices(1), 2, 3, ome(z4 + edges("0.5", "\xc2\xb5m")))),
         {"value"},
         diagonal({200, 200, 500}),
         "",
         "nm"},
        {"an escaped unit",
         file(tiff_of(slices(1), 2, 3, ome(z4 + edges("0.5", "&#181;m")))),
         {"value"},
         diagonal({200, 200, 500}),
         "",
         "nm"},
        {"no size along z",
         file(tiff_of(slices(1), 2, 3, ome(z4 + "PhysicalSizeX='2' PhysicalSizeY='2'"))),
         {"value"},
         diagonal({2, 2, 1}),
         "",
         "um",
         "OME states no PhysicalSizeZ"},
        {"slices, then channels",
         file(tiff_of(all(slices(1), slices(100)), 2, 3, ome(c2))),
         {"c0", "c1"}},
        {"places by TiffData", file(tiff_of(mixed, 2, 3, ome(c2, places))), {"c0", "c1"}},
        {"a stack from the top down",
         file(tiff_of(slices(1), 2, 3,
                      "ImageJ=1.5\nimages=4\nslices=4\nunit=micron\nspacing=-0.5\n")),
         {"value"},
         diagonal({1, 1, 0.5}),
         "",
         "um"},
        {"z in ImageJ's zunit",
         file(tiff_of(slices(1), 2, 3,
                      "ImageJ=1.5\nimages=4\nslices=4\nunit=um\nzunit=nm\nspacing=500\n")),
         {"value"},
         diagonal({1, 1, 0.5}),
         "",
         "um"},
        {"ImageJ's planes behind one page",
         file(tiff_of(first, 2, 3, "ImageJ=1.5\nimages=4\nslices=4\nspacing=2\n", one_page)),
         {"value"},
         diagonal({1, 1, 2})},
        {"tifffile's planes behind one page",
         file(tiff_of(first, 2, 3, "{\"shape\": [4, 3, 2], \"truncated\": true}", one_page))},
        {"tifffile's axes",
         file(tiff_of(all(slices(100), slices(1)), 2, 3,
                      "{\"shape\": [2, 4, 3, 2], \"axes\": \"CZYX\"}")),
         {"c0", "c1"},
         {},
         "c1"},
        {"axes without names",
         file(tiff_of(all(slices(100), slices(1)), 2, 3, "{\"shape\": [2, 4, 3, 2]}")),
         {"t0", "t1"},
         {},
         "t1"},
    };
    // Units of OME's schema beside one metre.
    const std::vector<std::pair<std::string, double>> units{{"Ym", 1e24},
                                                            {"Zm", 1e21},
                                                            {"Em", 1e18},
                                                            {"Pm", 1e15},
                                                            {"Tm", 1e12},
                                                            {"Gm", 1e9},
                                                            {"Mm", 1e6},
                                                            {"km", 1e3},
                                                            {"hm", 1e2},
                                                            {"dam", 10},
                                                            {"dm", 0.1},
                                                            {"cm", 1e-2},
                                                            {"mm", 1e-3},
                                                            {"\xc2\xb5m", 1e-6},
                                                            {"nm", 1e-9},
                                                            {"pm", 1e-12},
                                                            {"fm", 1e-15},
                                                            {"am", 1e-18},
                                                            {"zm", 1e-21},
                                                            {"ym", 1e-24},
                                                            {"\xc3\x85", 1e-10},
                                                            {"thou", 2.54e-5},
                                                            {"li", 0.0254 / 12},
                                                            {"in", 0.0254},
                                                            {"ft", 0.3048},
                                                            {"yd", 0.9144},
                                                            {"mi", 1609.344},
                                                            {"ua", 149597870700.0},
                                                            {"ly", 9460730472580800.0},
                                                            {"pc", 3.0856775814913673e16},
                                                            {"pt", 0.0254 / 72}};
    for (const auto& [unit, metres] : units) {
        const std::string size = fmt::format("{}", 3 / metres);
        kinds.push_back(
            {unit,
             file(tiff_of(slices(1), 2, 3,
                          ome(z4 +
                              "PhysicalSizeX=\"1\" PhysicalSizeXUnit=\"m\" PhysicalSizeY=\"1\" "
                              "PhysicalSizeYUnit=\"m\" PhysicalSizeZ=\"" +
                              size + "\" PhysicalSizeZUnit=\"" + unit + "\""))),
             {"value"},
             diagonal({1, 1, 3}),
             "",
             "m"});
    }
    expect_kinds(kinds);
    expect_refused({
        {file(tiff_of(slices(1), 2, 3, ome(z4 + edges("1", "pixel")))),
         "axes in units 'nm, nm, pixel'"},
        {file(tiff_of(slices(1), 2, 3, ome(z4) + ome(z4))), "OME describes 2 images"},
        {file(tiff_of(slices(1), 2, 3, ome(c2))),
         "4 pages of 1 samples in 1 files for 4 slices, 2 channels"},
        {file(tiff_of(first, 2, 3, "{\"shape\": [40, 3, 2]}")),
         "40 planes of 12 bytes in a file of"},
        {file(tiff_of(all(slices(1), slices(1)), 2, 3, "{\"shape\": [4, 3, 2]}")),
         "8 pages of 1 samples"},
    });
}

TEST(scan_kinds, fits) {
    const std::string big = bytes_of(scan_values(), true);
    const auto cube = [&](const std::vector<std::pair<std::string, std::string>>& keys) {
        std::vector<std::string> cards = cube_cards("16");
        for (const auto& [key, value] : keys) cards.push_back(card(key, value));
        return Files{{"a.fits", fits_of(cards, big)}};
    };
    // One plane of polarisation between the sky and the frequencies.
    const std::vector<std::string> stokes{
        card("SIMPLE", "T"),   card("BITPIX", "16"),         card("NAXIS", "4"),
        card("NAXIS1", "2"),   card("NAXIS2", "3"),          card("NAXIS3", "1"),
        card("NAXIS4", "4"),   card("CTYPE3", "'STOKES  '"), card("CDELT1", "0.5"),
        card("CDELT2", "1.0"), card("CDELT4", "2.0"),        card("CRPIX1", "1.0"),
        card("CRPIX2", "1.0"), card("CRPIX4", "1.0")};
    std::vector<std::string> several = stokes;
    several[5] = card("NAXIS3", "2");
    std::string planes;
    for (std::size_t z = 0; z < 4; ++z)
        planes += big.substr(12 * z, 12) + bytes_of(scan_values(100), true).substr(12 * z, 12);
    const auto extension = [&](const std::string& name, const std::string& version,
                               std::int16_t first) {
        return fits_of(
            {"XTENSION= 'IMAGE   '", card("BITPIX", "16"), card("NAXIS", "3"), card("NAXIS1", "2"),
             card("NAXIS2", "3"), card("NAXIS3", "4"), card("PCOUNT", "0"), card("GCOUNT", "1"),
             card("EXTNAME", "'" + name + "'"), card("EXTVER", version)},
            bytes_of(scan_values(first), true));
    };
    const std::string primary = fits_of(
        {card("SIMPLE", "T"), card("BITPIX", "8"), card("NAXIS", "0"), card("EXTEND", "T")}, "");
    const std::string padded = cube({})[0].second, unpadded = padded.substr(0, 2880 + big.size());
    const Affine edges = diagonal({0.5, 1, 2});
    expect_kinds({
        {"only entries off the diagonal",
         cube({{"CD1_2", "2.0"},
               {"CD2_1", "3.0"},
               {"CD3_3", "5.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"},
               {"CRVAL1", "7.0"}}),
         {"value"},
         {{{Vec3d{0, 2, 0}, {3, 0, 0}, {0, 0, 5}}}, {7, 0, 0}}},
        {"an axis through another",
         cube({{"CD1_3", "2.0"},
               {"CD3_1", "3.0"},
               {"CD2_2", "4.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "2.0"},
               {"CRPIX3", "3.0"},
               {"CRVAL1", "10.0"}}),
         {"value"},
         {{{Vec3d{0, 0, 2}, {0, 4, 0}, {3, 0, 0}}}, {6, -4, 0}}},
        {"the old spelling",
         cube({{"CD001002", "2.0"},
               {"CD002001", "3.0"},
               {"CD003003", "5.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"}}),
         {"value"},
         {{{Vec3d{0, 2, 0}, {3, 0, 0}, {0, 0, 5}}}, {}}},
        {"units of each axis",
         cube({{"CUNIT1", "'kpc'"},
               {"CUNIT2", "'pc'"},
               {"CUNIT3", "'pc'"},
               {"CDELT1", "2.0"},
               {"CDELT2", "3000.0"},
               {"CDELT3", "4000.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"}}),
         {"value"},
         diagonal({2, 3, 4}),
         "",
         "kpc"},
        {"an axis of one between others", {{"a.fits", fits_of(stokes, big)}}, {"value"}, edges},
        {"polarisations between others",
         {{"a.fits", fits_of(several, planes)}},
         {"c0", "c1"},
         edges},
        {"extensions of one name",
         {{"a.fits", primary + extension("SCI", "1", 100) + extension("SCI", "2", 1) +
                         extension("ERR", "1", 100)}},
         {"SCI[1]", "SCI[2]", "ERR"},
         {},
         "SCI[2]"},
        {"extensions of one name and version",
         {{"a.fits", primary + extension("SCI", "1", 100) + extension("SCI", "1", 1)}},
         {"SCI[0]", "SCI[1]"},
         {},
         "SCI[1]"},
        {"no padding", {{"a.fits", unpadded}}, {"value"}, {}, "", "", "not blocks of 2880"},
        {"no padding, packed",
         {{"a.fits.gz", gzipped(unpadded)}},
         {"value"},
         {},
         "",
         "",
         "not blocks of 2880"},
        {"several members",
         {{"a.fits.gz", gzipped(padded.substr(0, 100)) + gzipped(padded.substr(100, 2800)) +
                            gzipped(padded.substr(2900))}}},
    });
    expect_refused({
        {{{"a.fits", unpadded.substr(0, unpadded.size() - 1)}}, "truncated"},
        {{{"a.fits.gz", gzipped(padded.substr(0, 2890))}}, "truncated"},
        {{{"a.fits", primary + extension("SCI", "1", 100) + extension("SCI", "2", 1)}},
         "(it has: SCI[1], SCI[2])"},
    });
}

TEST(scan_kinds, reported_files_lie_where_they_should) {
    const std::filesystem::path folder = source_dir() / ".." / "shared" / "reported";
    if (!std::filesystem::exists(folder / "README.md")) GTEST_SKIP() << folder << " is absent";
    struct Reported {
        const char *file, *grids;
        Vec3d lower, upper;  ///< of the active voxels of the first grid
        double max;
        const char* unit = "";
    };
    // Boxes around the voxels that nibabel, SimpleITK, pynrrd, tifffile and astropy find above 0.
    const std::vector<Reported> all{
        {"ome_units.ome.tif", "value", {100, 300, 1250}, {900, 1300, 4250}, 996, "nm"},
        {"ome_czyx.ome.tif", "c0 c1", {0.1, 0.3, 1.25}, {0.9, 1.3, 4.25}, 996, "um"},
        {"four_p.mha", "t0 t1", {-16.75, 7, 37.5}, {-10.75, 17, 55.5}, 97},
        {"three_p.mha", "value", {-16.75, 7, 37.5}, {-10.75, 17, 55.5}, 97},
        {"spac_nan.nrrd", "c0 c1", {1, 3, 7.5}, {9, 13, 25.5}, 99},
        {"nonl_skip.nhdr", "value", {1, 3, 7.5}, {9, 13, 25.5}, 99},
        {"itk4d.nrrd", "t0 t1", {1, 3, 7.5}, {9, 13, 25.5}, 99},
        {"stokes3.fits", "value", {0.5, 1.5, 2.5}, {4.5, 6.5, 8.5}, 999},
        {"nopad.fits", "value", {0.5, 1.5, 2.5}, {4.5, 6.5, 8.5}, 999},
        {"sform_zero.nii", "value", {17, -19.25, 14.5}, {27, -13.25, 32.5}, 98},
        {"voxoff0.nii", "value", {17, -19.25, 14.5}, {27, -13.25, 32.5}, 98},
        {"bool.vdb", "density", {-0.5, -0.5, -0.5}, {3.5, 4.5, 5.5}, 1},
        {"same_name.nvdb.gz", "density[0] density[1]", {-1, -1, -1}, {7, 9, 11}, 9}};
    for (const Reported& one : all) {
        SCOPED_TRACE(one.file);
        std::vector<VolumeInfo> infos;
        ASSERT_EQ(refusal([&] { infos = inspect_volume(folder / one.file); }), "no error");
        std::string names;
        for (const VolumeInfo& info : infos) names += (names.empty() ? "" : " ") + info.grid.name;
        EXPECT_EQ(names, one.grids);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(infos[0].grid.world.lower[axis], one.lower[axis], 1e-5);
            EXPECT_NEAR(infos[0].grid.world.upper[axis], one.upper[axis], 1e-5);
        }
        EXPECT_EQ(infos[0].grid.max, one.max);
        EXPECT_EQ(infos[0].length_unit, one.unit);
        EXPECT_GT(read_volume(folder / one.file, {.grid = infos.back().grid.name}).leaves.size(),
                  0u);
    }
}

}  // namespace vog::test
