// tiff_kinds_test.cpp: TIFF stacks of which other tools' users reported wrong places or values, a row each.
#include "io/scan/scan_kinds.h"
#include "io/scan/tiff/tiff_stack.h"

namespace vog::test {

TEST(tiff_kinds, planes_lie_where_descriptions_say) {
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
        {"a channel by its name",
         file(tiff_of(all(slices(100), slices(1)), 2, 3,
                      ome(c2, "<Channel ID='0' Name='DAPI'/><Channel ID='1' Name='GFP'/>"))),
         {"c0", "c1"},
         {},
         "GFP"},
        {"places by TiffData", file(tiff_of(mixed, 2, 3, ome(c2, places))), {"c0", "c1"}},
        {"some pages placed, in the order of dimensions",
         file(tiff_of(slices(1), 2, 3, ome(z4, "<TiffData IFD='0' FirstZ='0'/>")))},
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
        {"ImageJ's origin, in voxels",
         file(
             tiff_of(slices(1), 2, 3,
                     "ImageJ=1.5\nimages=4\nslices=4\nunit=um\nspacing=0.5\nxorigin=10\nyorigin=-2."
                     "5\nzorigin=4\n")),
         {"value"},
         diagonal({1, 1, 0.5}, {-10, 2.5, -2}),
         "",
         "um"},
        {"ImageJ's signed pixels",
         file(tiff_of(slices(32769), 2, 3,
                      "ImageJ=1.5\nimages=4\nslices=4\ncf=0\nc0=-32768.0\nc1=1.0\nvunit=gray\n"))},
        {"ImageJ's polynomial of values",
         file(tiff_of(slices(1), 2, 3,
                      "ImageJ=1.5\nimages=4\nslices=4\ncf=1\nc0=0\nc1=1\nc2=0\nmin=5\nmax=9\n"))},
        {"ImageJ's exponential of values",
         file(tiff_of(slices(1), 2, 3,
                      "ImageJ=1.5\nimages=4\nslices=4\ncf=4\nc0=2\nc1=1\nvunit=OD\n")),
         {"value"},
         {},
         "",
         "",
         "without ImageJ's calibration by function 4"},
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
    // The tag Orientation in place of the number of samples, which is 1 by default.
    std::string turned = tiff_of(slices(1), 2, 3);
    const auto entry = [](char tag, char value) {
        return std::string{tag, 1, 3, 0, 1, 0, 0, 0, value, 0, 0, 0};
    };
    turned.replace(turned.find(entry(0x15, 1)), 12, entry(0x12, 4));
    kinds.push_back({"rows from the bottom",
                     file(turned),
                     {"value"},
                     {},
                     "",
                     "",
                     "rows and columns as stored, without the tag Orientation 4"});
    // An unknown ResolutionUnit.
    std::string other = tiff_of(slices(1), 2, 3);
    other.replace(other.find(entry(0x15, 1)), 12, entry(0x28, 5));
    kinds.push_back({"another unit of resolution", file(other)});
    const scan::TiffStack unknown = scan::tiff_stack({"a.tif", "", 2, 3, 1, 5, 10, 5});
    EXPECT_EQ(unknown.edge, (Vec3d{1, 0.5, 1}));
    EXPECT_TRUE(unknown.units.empty());
    EXPECT_NE(unknown.note.find("ResolutionUnit is 5"), std::string::npos) << unknown.note;
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
        {file(tiff_of(slices(1), 2, 3, ome(z4, "<TiffData IFD='1' FirstZ='0' PlaneCount='3'/>"))),
         "TiffData place 3 of 4 planes"},
        {file(
             tiff_of(slices(1), 2, 3,
                     ome(z4,
                         "<TiffData IFD='0'><UUID FileName='a.tif'>urn:uuid:1</UUID></TiffData>"
                         "<TiffData IFD='1'><UUID FileName='b.tif'>urn:uuid:2</UUID></TiffData>"))),
         "OME has planes in 2 files, a.tif to b.tif"},
        {file(tiff_of(slices(1), 2, 3, ome(c2))),
         "4 pages of 1 samples in 1 files for 4 slices, 2 channels"},
        {file(tiff_of(first, 2, 3, "{\"shape\": [40, 3, 2]}")),
         "40 planes of 12 bytes in a file of"},
        {file(tiff_of(all(slices(1), slices(1)), 2, 3, "{\"shape\": [4, 3, 2]}")),
         "8 pages of 1 samples"},
    });
}

TEST(tiff_kinds, slices_make_one_series) {
    const auto slices = [](const std::vector<std::string>& names,
                           const std::vector<std::string>& descriptions = {}) {
        Files files;
        for (std::size_t n = 0; n < names.size(); ++n)
            files.emplace_back(
                names[n] + ".tif",
                tiff_of({{1, 2}}, 2, 1, n < descriptions.size() ? descriptions[n] : ""));
        return files;
    };
    const auto refused = [&](const Files& files) {
        const TempDir dir;
        for (const auto& [name, bytes] : files) write_bytes(dir / name, bytes);
        return refusal([&] { read_volume(dir / "*.tif"); });
    };
    const std::string spacing = "ImageJ=1.5\nimages=1\nslices=1\nunit=um\nspacing=";
    const std::string plain = refused(slices({"s0", "s10", "s20"}));
    if (plain.find("this build reads no") != std::string::npos)
        GTEST_SKIP() << "this build has no libtiff";
    EXPECT_EQ(plain, "no error");
    for (const auto& [files, text] : std::vector<std::pair<Files, std::string>>{
             {slices({"s1", "s2"}, {spacing + "2\n", spacing + "2\n"}), "no error"},
             {slices({"s1_b3", "s2_b2", "s3_b1"}), "no error"},
             {slices({"top", "middle"}), "no error"},
             {slices({"z0.25", "z0.5", "z0.75", "z1.0"}), "no error"},
             {slices({"s1", "s2"}, {spacing + "2\n"}), "no error"},
             {slices({"s1", "s2"}, {spacing + "2\n", spacing + "5\n"}),
              "s2.tif: voxels of 1 x 1 x 5 um, expected 1 x 1 x 2 um as in s1.tif"},
             {slices({"s1", "s2", "s4"}), "slice 3 is missing between s2.tif and s4.tif"},
             {slices({"s1", "s2", "thumb"}),
              "thumb.tif has 0 numbers in its name, expected 1 as in s1.tif"},
             {slices({"s1_c0", "s1_c1", "s2_c0", "s2_c1", "s3_c0", "s3_c1"}),
              "s1_c0.tif and s1_c1.tif have one slice number"},
             {slices({"c0_s1", "c0_s2", "c0_s3", "c1_s1", "c1_s2", "c1_s3"}), "'c0_s*.tif'"}}) {
        const std::string message = refused(files);
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

}  // namespace vog::test
