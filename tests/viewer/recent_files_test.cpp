// recent_files_test.cpp: the list of files opened lately.
#include "ui/recent_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/data.h"
#include "vog/error.h"

namespace vog::test {

using viewer::RecentFiles;

TEST(recent_files, the_latest_set_is_first_and_the_list_is_kept) {
    TempDir dir;
    const auto list = dir / "state" / "recent";
    {
        RecentFiles recent(list);
        EXPECT_TRUE(recent.sets().empty());
        recent.add({"/a/one.vdb"});
        recent.add({"/a/level 0.vdb", "/a/b/../level 1.vdb"});
        recent.add({"/a/one.vdb"});
    }
    const RecentFiles again(list);
    ASSERT_EQ(again.sets().size(), 2u);
    EXPECT_EQ(again.sets()[0], std::vector<std::string>{"/a/one.vdb"});
    EXPECT_EQ(again.sets()[1], (std::vector<std::string>{"/a/level 0.vdb", "/a/level 1.vdb"}));
    EXPECT_EQ(viewer::set_name(again.sets()[1]), "level 0.vdb and 1 more");
}

TEST(recent_files, it_is_bounded_and_names_that_break_lines_are_left_out) {
    TempDir dir;
    RecentFiles recent(dir / "recent");
    for (int n = 0; n < 20; ++n) recent.add({"/a/" + std::to_string(n) + ".vdb"});
    recent.add({"/a/two\nlines.vdb"});
    recent.add({});
    EXPECT_EQ(recent.sets().size(), RecentFiles::kMost);
    EXPECT_EQ(recent.sets().front().front(), "/a/19.vdb");
}

TEST(recent_files, without_a_place_nothing_is_kept_and_a_bad_one_is_an_error) {
    RecentFiles none({});
    none.add({"/a/one.vdb"});
    EXPECT_TRUE(none.sets().empty());
    TempDir dir;
    std::ofstream(dir / "file") << "x";
    RecentFiles inside(dir / "file" / "recent");
    EXPECT_THROW(inside.add({"/a/one.vdb"}), Error);
}

}  // namespace vog::test
