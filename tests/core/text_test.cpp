// text_test.cpp: counts and sizes as text at the edges of groups and units.
#include "vog/text.h"

#include <gtest/gtest.h>

namespace vog {
namespace {

TEST(text, counts_are_grouped_by_three_digits) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(1000), "1,000");
    EXPECT_EQ(count_text(1234567), "1,234,567");
    EXPECT_EQ(count_text(UINT64_MAX), "18,446,744,073,709,551,615");
}

TEST(text, sizes_have_decimal_units) {
    EXPECT_EQ(bytes_text(0), "0 B");
    EXPECT_EQ(bytes_text(999), "999 B");
    EXPECT_EQ(bytes_text(1000), "1.0 kB");
    EXPECT_EQ(bytes_text(4400000), "4.4 MB");
    EXPECT_EQ(bytes_text(2500000000), "2.5 GB");
    EXPECT_EQ(bytes_text(5000000000000000), "5000.0 TB");
}

}  // namespace
}  // namespace vog
