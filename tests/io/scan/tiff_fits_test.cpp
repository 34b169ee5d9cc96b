// tiff_fits_test.cpp: TIFF stacks and FITS cubes, made byte by byte.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "io/scan/scan_files.h"
#include "support/command.h"
#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "vog/scan_io.h"

namespace vog::test {

TEST(scan_tiff, pages_are_slices_and_imagej_states_voxels) {
    const TempDir dir;
    const std::string words = "ImageJ=1.53t\nimages=2\nslices=2\nunit=um\nspacing=2.5\n";
    const std::string bytes = tiff_of({{1, 2, 3, 4, 5, 6}, {7, 8, 9, 10, 11, 12}}, 3, 2, words);
    write_bytes(dir / "a.tif", bytes);
    if (absent(dir / "a.tif")) GTEST_SKIP() << "this build has no libtiff";
    const Volume volume = read_volume(dir / "a.tif");
    EXPECT_EQ(active_voxels(volume), 12u);
    const auto at = [&](int x, int y, int z) {
        return volume.leaves.at(0).value[static_cast<std::size_t>(leaf_offset(x, y, z))];
    };
    EXPECT_EQ(at(2, 0, 0), 3);
    EXPECT_EQ(at(0, 1, 0), 4);
    EXPECT_EQ(at(2, 1, 1), 12);
    EXPECT_EQ(volume.world_from_index.linear(2, 2), 2.5);
    EXPECT_EQ(inspect_volume(dir / "a.tif")[0].length_unit, "um");
    testing::internal::CaptureStderr();
    for (std::size_t size = 0; size < bytes.size() - 60; ++size)
        EXPECT_THROW(read_bytes(dir, "cut.tif", bytes.substr(0, size)), Error) << size;
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        std::string changed = bytes;
        changed[n] = static_cast<char>(~changed[n]);
        const std::string message = refusal([&] { read_bytes(dir, "changed.tif", changed); });
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(scan_tiff, tags_of_maps_and_of_white_change_voxels_and_values) {
    const TempDir dir;
    const std::vector<std::vector<std::uint16_t>> page{{1, 2, 3, 4, 5, 6}};
    write_bytes(dir / "plain.tif", tiff_of(page, 3, 2));
    if (absent(dir / "plain.tif")) GTEST_SKIP() << "this build has no libtiff";
    // GeoTIFF's edges of pixels: three doubles behind the pixels.
    constexpr std::uint32_t kBehind = 8 + 2 + 12 * 9 + 4 + 12;
    const std::string scale = bytes_of<double>({10, 20, 0});
    const Volume map = read_bytes(
        dir, "map.tif", tiff_of(page, 3, 2, "", scale, tiff_entry(33550, 12, 3, kBehind)));
    expect_map(map.world_from_index, diagonal({10, 20, 10}));
    EXPECT_EQ(active_voxels(map), 6u);
    // GDAL's number of pixels without a value.
    write_bytes(dir / "blank.tif", tiff_of(page, 3, 2, "", "", tiff_entry(42113, 2, 2, '3')));
    EXPECT_NE(
        refusal([&] { read_volume(dir / "blank.tif"); }).find("1 active values are not finite"),
        std::string::npos);
    EXPECT_EQ(active_voxels(read_volume(dir / "blank.tif", {.values = {true, false}})), 5u);
    // Of floats and doubles it is the least number, whose digits GDAL rounds.
    const auto floats = [&]<class T>(T least, const std::string& no_data) {
        std::vector<T> values{1, 2, least, 4, 5, 6};
        const auto text = static_cast<std::uint32_t>(no_data.size() + 1);
        // Pixels that are wider than tiff_of's lie behind them, with the text.
        std::string bytes =
            tiff_of(page, 3, 2, "", no_data + std::string(1, 0) + bytes_of(values),
                    tiff_entry(339, 3, 1, 3) + tiff_entry(42113, 2, text, kBehind + 12));
        const auto put = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
            const std::string head = tiff_entry(tag, type, 1, 0).substr(0, 8);
            bytes.replace(bytes.find(head) + 8, 4, bytes_of<std::uint32_t>({value}));
        };
        put(258, 3, 8 * sizeof(T)), put(273, 4, kBehind + 12 + text), put(279, 4, 6 * sizeof(T));
        return active_voxels(read_bytes(dir, "f.tif", bytes, {.values = {true, false}}));
    };
    EXPECT_EQ(floats(std::numeric_limits<float>::lowest(), "-3.40282346639e+38"), 5u);
    EXPECT_EQ(floats(std::numeric_limits<double>::lowest(), "-1.7976931348623157e+308"), 5u);
    // PhotometricInterpretation 0: white is the least number.
    const std::string black = bytes_of<std::uint16_t>({262, 3, 1, 0, 1}),
                      white = bytes_of<std::uint16_t>({262, 3, 1, 0, 0});
    for (const std::string words : {"", "ImageJ=1.53t\nimages=1\n"}) {
        std::string bytes = tiff_of(page, 3, 2, words);
        bytes.replace(bytes.find(black), black.size(), white);
        const Volume volume = read_bytes(dir, "white.tif", bytes);
        EXPECT_EQ(value_at(volume, {1, 1, 0}), words.empty() ? 65535 - 5 : 5);
    }
}

TEST(scan_tiff, slices_of_a_folder_and_a_pattern_by_their_numbers) {
    const TempDir dir;
    std::filesystem::create_directory(dir / "slices");
    for (const std::uint16_t n : std::vector<std::uint16_t>{9, 10, 11})
        write_bytes(dir / ("slices/s" + std::to_string(n) + ".tif"), tiff_of({{n, 1}}, 2, 1));
    if (absent(dir / "slices")) GTEST_SKIP() << "this build has no libtiff";
    for (const char* name : {"slices", "slices/s*.tif"}) {
        const Volume volume = read_volume(dir / name);
        for (int z = 0; z < 3; ++z)
            EXPECT_EQ(volume.leaves.at(0).value[static_cast<std::size_t>(leaf_offset(0, 0, z))],
                      9 + z)
                << name;
    }
    write_bytes(dir / "slices/s12.tif", tiff_of({{1, 1, 1}}, 3, 1));
    EXPECT_NE(refusal([&] { read_volume(dir / "slices"); }).find("pages of several forms"),
              std::string::npos);
}

class scan_command : public CommandLine {};

TEST_F(scan_command, a_quoted_pattern_is_one_volume_as_its_folder_is) {
    std::filesystem::create_directory(dir_ / "slices");
    for (const std::uint16_t n : std::vector<std::uint16_t>{9, 10, 11})
        write_bytes(dir_ / ("slices/s" + std::to_string(n) + ".tif"), tiff_of({{n, 1}}, 2, 1));
    if (absent(dir_ / "slices")) GTEST_SKIP() << "this build has no libtiff";
    must("render 'slices/s*.tif' -o pattern.png --size 16");
    must("render slices -o folder.png --size 16");
    expect_same_pixels("pattern.png", "folder.png");
    must("convert 'slices/s*.tif' -o model.ply --block 1");
    must_fail(1, "convert 'none/s*.tif' -o other.ply", "none/s*.tif: no TIFF files");
}

TEST(scan_fits, values_are_scaled_and_blanks_are_none) {
    const TempDir dir;
    std::vector<std::string> cards = cube_cards("16");
    for (const auto& [key, value] :
         std::vector<std::pair<std::string, std::string>>{{"BSCALE", "0.5"},
                                                          {"BZERO", "10.0"},
                                                          {"BLANK", "24"},
                                                          {"BUNIT", "'K       '"},
                                                          {"CRPIX1", "1.0"},
                                                          {"CRVAL1", "5.0"},
                                                          {"CDELT1", "0.5"},
                                                          {"CRPIX2", "2.0"},
                                                          {"CDELT2", "2.0"},
                                                          {"CRPIX3", "1.0"},
                                                          {"CDELT3", "3.0"}})
        cards.push_back(card(key, value));
    const std::string bytes = fits_of(cards, bytes_of(scan_values(), true));
    write_bytes(dir / "a.fits", bytes);
    if (absent(dir / "a.fits")) GTEST_SKIP() << "this build has no cfitsio";
    EXPECT_NE(refusal([&] { read_volume(dir / "a.fits"); }).find("1 active values are not finite"),
              std::string::npos);
    const Volume volume = read_volume(dir / "a.fits", {.values = {true, false}});
    EXPECT_EQ(active_voxels(volume), 23u);
    EXPECT_EQ(volume.leaves.at(0).value[static_cast<std::size_t>(leaf_offset(1, 0, 0))], 11);
    EXPECT_EQ(volume.world_from_index.linear(0, 0), 0.5);
    EXPECT_EQ(volume.world_from_index.translation, (Vec3d{5, -2, 0}));
    EXPECT_EQ(inspect_volume(dir / "a.fits")[0].value_unit, "K");
    EXPECT_EQ(
        active_voxels(read_bytes(dir, "a.fits.gz", gzipped(bytes), {.values = {true, false}})),
        23u);
    cards.push_back(card("CTYPE1", "'RA---TAN'"));
    const Volume sky = read_bytes(dir, "sky.fits", fits_of(cards, bytes_of(scan_values(), true)),
                                  {.values = {true, false}});
    EXPECT_EQ(sky.world_from_index, Affine{}) << "angles are no lengths";
}

TEST(scan_fits, truncated_and_changed_files_are_refused_in_silence) {
    const TempDir dir;
    const std::string bytes = fits_of(cube_cards("16"), bytes_of(scan_values(), true));
    write_bytes(dir / "a.fits", bytes);
    if (absent(dir / "a.fits")) GTEST_SKIP() << "this build has no cfitsio";
    testing::internal::CaptureStderr();
    for (std::size_t size = 0; size < 2880 + 48; size += 13)
        EXPECT_THROW(read_bytes(dir, "cut.fits", bytes.substr(0, size)), Error) << size;
    for (std::size_t n = 0; n < 600; ++n) {
        std::string changed = bytes;
        changed[n] = static_cast<char>(~changed[n]);
        const std::string message = refusal([&] { read_bytes(dir, "changed.fits", changed); });
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    std::vector<std::string> huge = cube_cards("16");
    huge[3] = card("NAXIS1", "1000000000");
    EXPECT_NE(refusal([&] { read_bytes(dir, "huge.fits", fits_of(huge, "")); }).find("huge.fits"),
              std::string::npos);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace vog::test
