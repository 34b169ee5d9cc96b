// html_text_test.cpp: escaped text and base64 of known inputs.
#include "core/html_text.h"

#include <gtest/gtest.h>

namespace vog {
namespace {

TEST(html_text, markup_characters_become_entities) {
    EXPECT_EQ(escaped("a < b & \"c\" > d"), "a &lt; b &amp; &quot;c&quot; &gt; d");
    EXPECT_EQ(escaped("&lt;"), "&amp;lt;");
    EXPECT_EQ(escaped(""), "");
}

TEST(html_text, base64_of_every_remainder) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("\xff\xfe\x00\x01"), "//4=");  // ends at the null of the literal
}

}  // namespace
}  // namespace vog
