// fits_kinds_test.cpp: FITS cubes of which other tools' users reported wrong places or values, a row each.
#include "io/scan/scan_kinds.h"

namespace vog::test {

TEST(fits_kinds, voxels_lie_where_keywords_say) {
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
        // As wcslib's cdfix makes a matrix invertible.
        {"an axis without an entry",
         cube({{"CD1_2", "2.0"},
               {"CD2_1", "3.0"},
               {"CDELT3", "5.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "2.0"}}),
         {"value"},
         {{{Vec3d{0, 2, 0}, {3, 0, 0}, {0, 0, 1}}}, {0, 0, -1}},
         "",
         "",
         "CD has no entry for axis 3"},
        {"both matrices",
         cube({{"PC1_1", "0.5"},
               {"CD1_1", "7.0"},
               {"CDELT3", "5.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"}}),
         {"value"},
         diagonal({0.5, 1, 5}),
         "",
         "",
         "both PC and CD"},
        {"a turn of no sky",
         cube({{"CROTA2", "30.0"},
               {"CDELT1", "2.0"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"}}),
         {"value"},
         diagonal({2, 1, 1}),
         "",
         "",
         "CROTA2 is not applied"},
        {"a turn without edges",
         cube({{"PC1_1", "0.8"},
               {"PC1_2", "-0.6"},
               {"PC2_1", "0.6"},
               {"PC2_2", "0.8"},
               {"CRPIX1", "1.0"},
               {"CRPIX2", "1.0"},
               {"CRPIX3", "1.0"}}),
         {"value"},
         {{{Vec3d{0.8, -0.6, 0}, {0.6, 0.8, 0}, {0, 0, 1}}}, {}}},
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
    });
}

TEST(fits_kinds, steps_of_axes_without_a_common_length_are_reported) {
    std::vector<std::string> cards = cube_cards("16");
    for (const char* text :
         {"CTYPE1  = 'RA---TAN'", "CTYPE2  = 'DEC--TAN'", "CTYPE3  = 'VRAD    '",
          "CUNIT1  = 'deg     '", "CUNIT2  = 'deg     '", "CUNIT3  = 'm/s     '"})
        cards.emplace_back(text);
    // 0.005 degrees a pixel, turned: tangents of 3 : 4.
    for (const auto& [key, value] : {std::pair{"CD1_1", "-0.004"},
                                     {"CD1_2", "0.003"},
                                     {"CD2_1", "0.003"},
                                     {"CD2_2", "0.004"},
                                     {"CD3_3", "500.0"}})
        cards.push_back(card(key, value));
    const TempDir dir;
    write_bytes(dir / "a.fits", fits_of(cards, bytes_of(scan_values(), true)));
    if (absent(dir / "a.fits")) GTEST_SKIP() << "this build reads no FITS";
    const VolumeInfo info = inspect_volume(dir / "a.fits").at(0);
    EXPECT_EQ(info.coordinates,
              "pixels; steps of the axes are RA---TAN 0.005 deg, DEC--TAN 0.005 deg, VRAD 500 m/s");
    expect_map(info.grid.world_from_index, {});
    EXPECT_EQ(info.length_unit, "");
}

}  // namespace vog::test
