// text_test.cpp: counts and sizes as text at the edges of groups and units; texts of any bytes.
#include "vog/text.h"

#include <gtest/gtest.h>

#include "vog/error.h"

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

TEST(text, printable_text_has_no_control_characters_and_is_utf8) {
    using namespace std::string_literals;
    EXPECT_EQ(printable("density"), "density");
    EXPECT_EQ(printable("Dichte \u03c1, \u5bc6\u5ea6, \U0001f30a"),
              "Dichte \u03c1, \u5bc6\u5ea6, \U0001f30a");
    EXPECT_EQ(printable("\x1b[31mred\a\n\x7f"), "\\x1b[31mred\\x07\\x0a\\x7f");
    EXPECT_EQ(printable("a\0b"s), "a\\x00b");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m"),
              "\\xc2\\x9b31m")
        << "the one-byte escape of C1";
    EXPECT_EQ(printable("\u202egnp.exe"), "\\xe2\\x80\\xaegnp.exe");
    // Bytes that no UTF-8 has, or has not there: alone, cut, overlong, a surrogate, beyond Unicode.
    EXPECT_EQ(printable("\xff \xa9"), "\\xff \\xa9");
    EXPECT_EQ(printable("\xe5\xaf"), "\\xe5\\xaf");
    EXPECT_EQ(printable("\xc0\x80"), "\\xc0\\x80");
    EXPECT_EQ(printable("\xe0\x80\xaf"), "\\xe0\\x80\\xaf");
    EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(text, printable_text_ends_between_two_characters) {
    EXPECT_EQ(printable("abcdef", 6), "abcdef");
    EXPECT_EQ(printable("abcdef", 5), "abcde...");
    EXPECT_EQ(printable("ab\u5bc6", 4), "ab...");
    EXPECT_EQ(printable("ab\u5bc6", 5), "ab\u5bc6");
}

TEST(text, errors_are_one_printable_line) {
    EXPECT_STREQ(Error("a\nb\x1b"
                       "c")
                     .what(),
                 "a\\x0ab\\x1b"
                 "c");
}

}  // namespace
}  // namespace vog
