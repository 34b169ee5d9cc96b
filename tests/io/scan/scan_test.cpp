// scan_test.cpp: dense images: values, maps, names and refusals of NIfTI, NRRD, MetaImage and raw values.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/scan/scan_files.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/refused_files.h"
#include "vog/scan_io.h"
#include "vog/voxel_field.h"

namespace vog::test {

namespace {

const std::string kNrrdHead =
    "NRRD0004\n# comment\ntype: short\ndimension: 3\nsizes: 2 3 4\nspacings: 0.5 1 2\nendian: "
    "little\n";

}  // namespace

TEST(scan, nifti_has_values_in_either_byte_order_and_packed) {
    const TempDir dir;
    const Nifti nifti;
    for (const bool big : {false, true}) {
        const std::string bytes = nifti.head(big) + bytes_of(scan_values(), big);
        const Volume volume = read_bytes(dir, "a.nii", bytes);
        expect_counted(volume, "raw");
        EXPECT_EQ(volume.name, "value");
        expect_map(volume.world_from_index, diagonal({0.5, 1, 2}));
        expect_counted(read_bytes(dir, "a.nii.gz", gzipped(bytes)), "gzip");
        const std::string members = gzipped(bytes.substr(0, 360)) + gzipped(bytes.substr(360));
        expect_counted(read_bytes(dir, "b.nii.gz", members), "two members");
    }
    const VolumeInfo info = inspect_volume(dir / "a.nii").front();
    EXPECT_EQ(info.grid.type, "int16");
    EXPECT_EQ(info.length_unit, "mm");
    EXPECT_EQ(info.grid.max, 24);
}

TEST(scan, nifti_maps_by_sform_then_qform) {
    const TempDir dir;
    Nifti nifti;
    // A quarter turn about z: (b, c, d) = (0, 0, sin 45 degrees); the third axis mirrored.
    nifti.qform = 1;
    nifti.quatern = {0, 0, std::sqrt(0.5f), 10, 20, 30};
    nifti.pixdim[0] = -1;
    const std::string values = bytes_of(scan_values());
    const Affine turned{{{Vec3d{0, -1, 0}, {0.5, 0, 0}, {0, 0, -2}}}, {10, 20, 30}};
    expect_map(read_bytes(dir, "q.nii", nifti.head() + values).world_from_index, turned);
    nifti.sform = 2;
    nifti.srow = {1, 0.25f, 0, 5, 0, 3, 0, 6, 0.5f, 0, 2, 7};
    const Affine sheared{{{Vec3d{1, 0.25, 0}, {0, 3, 0}, {0.5, 0, 2}}}, {5, 6, 7}};
    expect_map(read_bytes(dir, "s.nii", nifti.head() + values).world_from_index, sheared);
    nifti.srow = {};
    expect_map(read_bytes(dir, "z.nii", nifti.head() + values).world_from_index, turned);
    nifti.qform = 0;
    EXPECT_THROW(read_bytes(dir, "z.nii", nifti.head() + values), Error);
}

TEST(scan, scaled_signed_values_need_a_measure_of_volume) {
    const TempDir dir;
    Nifti nifti;
    nifti.slope = 2;
    nifti.inter = -20;
    const std::string bytes = nifti.head() + bytes_of(scan_values());  // -18 to 28
    const std::string message = refusal([&] { read_bytes(dir, "ct.nii", bytes); });
    EXPECT_NE(message.find("9 active values are negative, the first at index [0, 0, 0]"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("--measure volume"), std::string::npos) << message;
    EXPECT_EQ(active_voxels(read_volume(dir / "ct.nii", {.values = {false, true}})), 14u);
    Volume measure = read_volume(dir / "ct.nii", {.ones = true});
    EXPECT_EQ(active_voxels(measure), 24u) << "of signed values 0 is no background";
    const VoxelField field = read_field({.file = dir / "ct.nii"}, measure);
    EXPECT_EQ(field.name, "value");
    EXPECT_EQ(field.lower, -18);
    EXPECT_EQ(field.upper, 28);
}

TEST(scan, background_and_values_that_are_no_numbers_are_inactive) {
    const TempDir dir;
    Nifti nifti;
    nifti.datatype = 16;
    std::vector<float> values(24, 0.0f);
    values[5] = 3;
    const std::string sparse = nifti.head() + bytes_of(values);
    EXPECT_EQ(active_voxels(read_bytes(dir, "a.nii", sparse)), 1u);
    EXPECT_EQ(active_voxels(read_volume(dir / "a.nii", {.ones = true})), 1u);
    values[7] = std::nanf("");
    const std::string blank = nifti.head() + bytes_of(values);
    EXPECT_NE(
        refusal([&] { read_bytes(dir, "b.nii", blank); }).find("1 active values are not finite"),
        std::string::npos);
    std::vector<std::string> notes;
    EXPECT_EQ(active_voxels(read_volume(dir / "b.nii", {.values = {true, false}}, &notes)), 1u);
    EXPECT_EQ(notes.size(), 1u);
    EXPECT_NE(refusal([&] {
                  read_bytes(dir, "c.nii", nifti.head() + bytes_of(std::vector<float>(24, 0.0f)));
              }).find("no voxel above 0"),
              std::string::npos);
}

TEST(scan, frames_are_grids) {
    const TempDir dir;
    Nifti nifti;
    nifti.dim = {4, 2, 3, 4, 2, 1, 1, 1};
    write_bytes(dir / "a.nii", nifti.head() + bytes_of(scan_values(100)) + bytes_of(scan_values()));
    EXPECT_EQ(grid_names(dir / "a.nii"), (std::vector<std::string>{"t0", "t1"}));
    expect_counted(read_volume(dir / "a.nii", {.grid = "t1"}), "frame");
    std::vector<std::string> notes;
    EXPECT_EQ(read_volume(dir / "a.nii", {}, &notes).name, "t0");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes.front().find("reading 't0', one of 2 grids; --grid chooses another: t1"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  read_volume(dir / "a.nii", {.refuse_several = true});
              }).find("2 grids; choose one with --grid (it has: t0, t1)"),
              std::string::npos);
    EXPECT_NE(
        refusal([&] { read_volume(dir / "a.nii", {.grid = "t2"}); }).find("no grid named 't2'"),
        std::string::npos);
}

TEST(scan, nrrd_attached_detached_packed_and_as_text) {
    const TempDir dir;
    const std::string values = bytes_of(scan_values());
    expect_counted(read_bytes(dir, "a.nrrd", kNrrdHead + "encoding: raw\n\n" + values), "raw");
    expect_map(read_volume(dir / "a.nrrd").world_from_index, diagonal({0.5, 1, 2}));
    expect_counted(read_bytes(dir, "b.nrrd", kNrrdHead + "encoding: gzip\n\n" + gzipped(values)),
                   "gzip");
    std::string text;
    for (const std::int16_t v : scan_values()) text += std::to_string(v) + "\n";
    expect_counted(read_bytes(dir, "c.nrrd", kNrrdHead + "encoding: ascii\n\n" + text), "text");
    std::string digits;
    for (const char c : values)
        digits += fmt::format("{:02X}{}", static_cast<unsigned char>(c),
                              digits.size() % 36 == 0 ? "\n" : "");
    expect_counted(read_bytes(dir, "f.nrrd", kNrrdHead + "encoding: hex\n\n" + digits + "\n"),
                   "hexadecimal");
    write_bytes(dir / "values", "skip" + values);
    const std::string detached = kNrrdHead + "encoding: raw\nbyte skip: 4\ndata file: values\n";
    expect_counted(read_bytes(dir, "d.nhdr", detached), "detached");
    const std::string last = kNrrdHead + "encoding: raw\nbyte skip: -1\ndata file: values\n";
    expect_counted(read_bytes(dir, "e.nhdr", last), "from the end");
}

TEST(scan, nrrd_directions_are_turned_to_ras) {
    const TempDir dir;
    const std::string head =
        "NRRD0005\ntype: int16\ndimension: 3\nsizes: 2 3 4\nendian: little\nencoding: raw\n"
        "space directions: (0,1,0) (2,0,0) (0,0.5,3)\nspace origin: (7,8,9)\nspace: ";
    const std::string values = bytes_of(scan_values());
    const Affine lps{{{Vec3d{0, 2, 0}, {1, 0, 0.5}, {0, 0, 3}}}, {7, 8, 9}};
    const auto map = [&](const std::string& space) {
        return read_bytes(dir, "a.nrrd", head + space + "\n\n" + values).world_from_index;
    };
    expect_map(map("right-anterior-superior"), lps);
    const Affine ras{{{Vec3d{0, -2, 0}, {-1, 0, -0.5}, {0, 0, 3}}}, {-7, -8, 9}};
    expect_map(map("left-posterior-superior"), ras);
    EXPECT_NE(refusal([&] { map("3D-left-handed"); }).find("3D-left-handed"), std::string::npos);
}

TEST(scan, nrrd_channels_side_by_side) {
    const TempDir dir;
    std::string values;
    for (const std::int16_t v : scan_values())
        values += {static_cast<char>(2 * v), static_cast<char>(v), '\x01'};
    const std::string head =
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 3 4\nkinds: RGB-color domain domain "
        "domain\n"
        "encoding: raw\n\n";
    write_bytes(dir / "a.nrrd", head + values);
    EXPECT_EQ(grid_names(dir / "a.nrrd"), (std::vector<std::string>{"red", "green", "blue"}));
    expect_counted(read_volume(dir / "a.nrrd", {.grid = "green"}), "green");
    EXPECT_EQ(inspect_volume(dir / "a.nrrd")[0].grid.max, 48);
}

TEST(scan, metaimage_in_one_file_or_two) {
    const TempDir dir;
    const std::string head =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = True\n"
        "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 0.5 1 2\n"
        "DimSize = 2 3 4\nElementType = MET_SHORT\n";
    const std::string values = bytes_of(scan_values(), true);
    const Volume volume = read_bytes(dir, "a.mha", head + "ElementDataFile = LOCAL\n" + values);
    expect_counted(volume, "local");
    const Affine map{{{Vec3d{0, -1, 0}, {0.5, 0, 0}, {0, 0, 2}}}, {1, 2, 3}};
    expect_map(volume.world_from_index, map);
    write_bytes(dir / "a.zraw", gzipped(values));
    const std::string packed =
        head + "AnatomicalOrientation = RAI\nCompressedData = True\nElementDataFile = a.zraw\n";
    const Volume turned = read_bytes(dir, "b.mhd", packed);
    expect_counted(turned, "packed");
    expect_map(turned.world_from_index, {{{Vec3d{0, 1, 0}, {-0.5, 0, 0}, {0, 0, 2}}}, {-1, -2, 3}});
}

TEST(scan, raw_values_with_a_head) {
    const TempDir dir;
    write_bytes(dir / "a.raw", "head" + bytes_of(scan_values(), true));
    const auto read = [&](const std::string& json) {
        write_bytes(dir / "a.raw.json", json);
        return read_volume(dir / "a.raw");
    };
    const std::string start = "{\"size\": [2, 3, 4], \"type\": \"int16\", \"endian\": \"big\", ";
    const Volume volume = read(start +
                               "\"skip\": 4, \"spacing\": [0.5, 1, 2], \"origin\": [1, 2, 3], "
                               "\"unit\": \"um\", \"name\": \"dose\"}");
    expect_counted(volume, "raw");
    EXPECT_EQ(volume.name, "dose");
    expect_map(volume.world_from_index, diagonal({0.5, 1, 2}, {1, 2, 3}));
    // IEEE 754's half floats of 1 to 24, below the normal ones, and the largest.
    std::vector<std::uint16_t> halves;
    for (unsigned n = 1; n <= 24; ++n) {
        const auto exponent = static_cast<unsigned>(std::bit_width(n)) - 1;
        halves.push_back(
            static_cast<std::uint16_t>((exponent + 15) << 10 | ((n << (10 - exponent)) & 1023)));
    }
    write_bytes(dir / "a.raw", bytes_of(halves, true));
    const std::string half = "{\"size\": [2, 3, 4], \"type\": \"float16\", \"endian\": \"big\"}";
    expect_counted(read(half), "float16");
    halves[0] = 1, halves[1] = 0x7bff, halves[2] = 0xbc00, halves[3] = 0x7c00;
    write_bytes(dir / "a.raw", bytes_of(halves, true));
    const Volume special =
        read_volume(dir / "a.raw", {.values = {.skip_nonfinite = true, .clip_negative = true}});
    EXPECT_EQ(value_at(special, {0, 0, 0}), std::ldexp(1.0f, -24));
    EXPECT_EQ(value_at(special, {1, 0, 0}), 65504);
    EXPECT_EQ(active_voxels(special), 22u) << "without the infinite and the negative one";
    write_bytes(dir / "a.raw", "head" + bytes_of(scan_values(), true));
    EXPECT_NE(refusal([&] { read(start + "\"skip\": 3}"); }).find("52 bytes, expected 51"),
              std::string::npos);
    EXPECT_NE(refusal([&] { read(start + "\"spaces\": 3}"); }).find("unknown key 'spaces'"),
              std::string::npos);
    EXPECT_NE(refusal([&] { read("{\"type\": \"int16\"}"); }).find("no key 'size'"),
              std::string::npos);
    std::filesystem::remove(dir / "a.raw.json");
    EXPECT_NE(refusal([&] { read_volume(dir / "a.raw"); }).find("a.raw.json"), std::string::npos);
}

TEST(scan, a_field_has_the_note_of_its_file_once) {
    const TempDir dir;
    Nifti head, flat;
    head.pixdim[1] = 1, flat.pixdim[1] = 0;
    Volume volume = read_bytes(dir, "a.nii", head.head() + bytes_of(scan_values()));
    write_bytes(dir / "b.nii", flat.head() + bytes_of(scan_values(3)));
    std::vector<std::string> notes;
    for (int times = 0; times < 2; ++times) {
        FieldCoverage coverage;
        EXPECT_EQ(read_field({.file = dir / "b.nii"}, volume, {}, &notes, &coverage).lower, 3);
    }
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("b.nii: pixdim[1] is 0, read as 1"), std::string::npos) << notes[0];
}

TEST(scan, every_truncation_is_refused) {
    const std::string values = bytes_of(scan_values());
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.nii", Nifti{}.head() + values},
        {"a.nii.gz", gzipped(Nifti{}.head() + values)},
        {"a.nrrd", kNrrdHead + "encoding: raw\n\n" + values},
        {"b.nrrd", kNrrdHead + "encoding: gzip\n\n" + gzipped(values)},
        {"a.mha", "NDims = 3\nDimSize = 2 3 4\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
                      values}};
    const TempDir dir;
    testing::internal::CaptureStderr();
    for (const auto& [name, bytes] : files) {
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_THROW(read_bytes(dir, name, bytes.substr(0, size)), Error)
                << name << " " << size;
        EXPECT_NO_THROW(read_bytes(dir, name, bytes)) << name;
        for (std::size_t n = 0; n < bytes.size(); ++n) {
            std::string changed = bytes;
            changed[n] = static_cast<char>(~changed[n]);
            const std::string message = refusal([&] { read_bytes(dir, name, changed); });
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(scan, sizes_are_checked_against_the_file) {
    const TempDir dir;
    Nifti nifti;
    nifti.dim = {3, 8000, 8000, 8000, 1, 1, 1, 1};
    const std::string bytes = nifti.head() + bytes_of(scan_values());
    EXPECT_NE(refusal([&] { read_bytes(dir, "a.nii", bytes); }).find("truncated"),
              std::string::npos);
    EXPECT_NE(refusal([&] { read_bytes(dir, "a.nii.gz", gzipped(bytes)); }).find("truncated"),
              std::string::npos);
    nifti.dim = {4, 1, 1, 1, -1, 1, 1, 1};
    EXPECT_NE(refusal([&] { read_bytes(dir, "b.nii", nifti.head()); }).find("-1 images"),
              std::string::npos);
    nifti = {};
    nifti.datatype = 32;
    EXPECT_NE(refusal([&] { read_bytes(dir, "c.nii", nifti.head()); }).find("datatype 32"),
              std::string::npos);
    EXPECT_NE(
        refusal([&] { read_bytes(dir, "d.nii", "no image, but text\n"); }).find("expected NIfTI"),
        std::string::npos);
}

}  // namespace vog::test
