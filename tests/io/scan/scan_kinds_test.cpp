// scan_kinds_test.cpp: MetaImage, NRRD and NIfTI of which other tools' users reported wrong places or values, a row each.
#include "io/scan/scan_kinds.h"

namespace vog::test {

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
        {"intensities by a slope and an offset",
         {{"a.mha", mha("ElementToIntensityFunctionSlope = 0.5\nElementToIntensityFunctionOffset = "
                        "-49\n") +
                        local + bytes_of([] {
                            std::vector<std::int16_t> values = scan_values();
                            for (std::int16_t& v : values)
                                v = static_cast<std::int16_t>(2 * v + 98);
                            return values;
                        }())}}},
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
        {{{"a.mha", mha("ElementToIntensityFunctionSlope = 0\n") + local + counted()}},
         "values times 0 plus 0 by ElementToIntensityFunction"},
    });
}

TEST(scan_kinds, whole_numbers_that_floats_round_are_noted) {
    const TempDir dir;
    const auto note_of = [&](std::int32_t label) {
        std::vector<std::int32_t> labels(24, 1);
        labels[5] = label;
        Nifti nifti;
        nifti.datatype = 8;
        std::ofstream(dir / "a.nii", std::ios::binary) << nifti.head() << bytes_of(labels);
        std::vector<std::string> notes;
        (void)read_volume(dir / "a.nii", {.values = {.background = 0}}, &notes);
        const std::string note = inspect_volume(dir / "a.nii")[0].note;
        EXPECT_EQ(notes.empty(), note.empty());
        return note;
    };
    EXPECT_EQ(note_of(1 << 24), "");
    EXPECT_NE(note_of(312782574).find("beyond 16777216 are rounded"), std::string::npos);
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
         "t1",
         "",
         "without a space; if ITK wrote it"},
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
        {"one unit of all axes beside directions",
         {{"a.nrrd", nrrd("space dimension: 3\nspace directions: (2,0,0) (0,2,0) (0,0,3)\n"
                          "units: \"um\" \"um\" \"um\"\n" +
                          raw + "\n") +
                         counted()}},
         {"value"},
         voxels,
         "",
         "um"},
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
        {{{"a.nrrd", nrrd("space dimension: 3\nspace directions: (2,0,0) (0,2,0) (0,0,3)\n"
                          "axis mins: 10 20 30\n" +
                          raw + "\n") +
                         counted()}},
         "axis mins beside space directions, expected space origin"},
        {{{"a.nrrd", nrrd("space dimension: 3\nspace directions: (2,0,0) (0,2,0) (0,0,3)\n"
                          "units: \"mm\" \"mm\" \"um\"\n" +
                          raw + "\n") +
                         counted()}},
         "beside space directions, expected space units"},
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
