// units_test.cpp: factors between units in texts.
#include <gtest/gtest.h>

#include "vog/units.h"

namespace vog {

TEST(units, products_convert_and_names_that_are_not_known_are_units_of_their_own) {
    // Products of doubles, each rounded once: ten of them at most.
    constexpr double kRounding = 1e-14;
    const auto expect = [](const char* from, const char* to, double factor) {
        const auto found = unit_factor(from, to);
        ASSERT_TRUE(found) << from << " to " << to;
        EXPECT_NEAR(*found / factor, 1, kRounding) << from << " to " << to;
    };
    expect("kpc", "cm", 3.0856775814913673e21);
    expect("g/cm3 kpc", "g/cm2", 3.0856775814913673e21);
    expect("g/cm**3*Mpc", "kg m-2", 3.0856775814913673e25);
    expect("Msun kpc^-2", "g/cm\xc2\xb2", 1.98841e33 / 9.521406136918413e42);
    expect("HU mm", "cm HU", 0.1);
    expect("1/cm mm2", "mm", 0.1);
    expect("erg", "g cm2 s-2", 1);
    expect("Jy/beam", "mJy/beam", 1000);
    for (const auto& [from, to] : {std::pair{"g/cm3 kpc", "g/cm3"},
                                   {"HU mm", "g/cm2"},
                                   {"K", "km/s"},
                                   {"", "cm"},
                                   {"$", "cm"}})
        EXPECT_FALSE(unit_factor(from, to)) << from << " to " << to;
    EXPECT_EQ(unit_factor("$", "$"), 1) << "equal texts need no meaning";
}

TEST(units, products_collect_names_in_their_order) {
    EXPECT_EQ(unit_product("g/cm3", "kpc"), "g/cm3 kpc");
    EXPECT_EQ(unit_product("Msun/kpc3", "kpc"), "Msun/kpc2");
    EXPECT_EQ(unit_product("1", "0.5 kpc", -3), "8/kpc3");
    EXPECT_EQ(unit_product("km/s", "0.5 kpc", 1), "0.5 km/s kpc");
    EXPECT_EQ(unit_product("$ a", "mm"), "$ a mm") << "no product";
    EXPECT_EQ(unit_product("$ a", "mm", -3), "");
    EXPECT_EQ(unit_product("", "mm"), "");
}

}  // namespace vog
