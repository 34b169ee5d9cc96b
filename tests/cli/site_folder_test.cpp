// site_folder_test.cpp: files that vog serve opens for paths of requests, without a network.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "serve/site_folder.h"
#include "support/data.h"
#include "vog/error.h"

namespace vog::test {

class site_folder : public ::testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(dir_ / "site/chunks");
        for (const char* file : {"site/index.html", "site/manifest.json", "site/.hidden", "secret",
                                 "site/chunks/0123456789abcdef0123456789abcdef.vogz"})
            std::ofstream(dir_ / file) << file;
    }
    TempDir dir_;
};

TEST_F(site_folder, paths_stay_below_it) {
    const vog::cli::SiteFolder folder(dir_ / "site");
    std::filesystem::create_directories(dir_ / "site/a..b");
    std::ofstream(dir_ / "site/a..b/index.html") << "x";
    for (const char* path : {"/", "/index.html", "/a..b/", "/a..b/index.html"})
        EXPECT_TRUE(folder.open(path)) << path;
    using namespace std::string_literals;
    for (const std::string& path :
         {""s, "index.html"s, "//"s, "/."s, "/.."s, "/../site/index.html"s,
          "/chunks/../index.html"s, "/index.html/"s, "/.hidden"s, "//index.html"s,
          "/a..b//index.html"s, "/index.html\0"s, "/index.html\0.txt"s, "/index.html\n"s,
          "/index.html\x7f"s, "/%69ndex.html"s})
        EXPECT_FALSE(folder.open(path)) << path;
}

TEST_F(site_folder, links_that_leave_it_open_nothing) {
    namespace fs = std::filesystem;
    fs::create_symlink("../secret", dir_ / "site/out");
    fs::create_symlink("..", dir_ / "site/up");
    fs::create_symlink(".hidden", dir_ / "site/hidden");
    fs::create_symlink("index.html", dir_ / "site/in.html");
    fs::create_directory_symlink(dir_ / "site", dir_ / "link");
    for (const char* name : {"site", "link"}) {
        const vog::cli::SiteFolder folder(dir_ / name);
        for (const char* path :
             {"/out", "/up/secret", "/hidden", "/chunks", "/absent", "/../secret"})
            EXPECT_FALSE(folder.open(path)) << path;
        for (const char* path : {"/", "/index.html", "/in.html"}) {
            const auto file = folder.open(path);
            ASSERT_TRUE(file) << path;
            EXPECT_EQ(file->size, std::string_view("site/index.html").size());
            EXPECT_EQ(file->type, "text/html; charset=utf-8");
            EXPECT_FALSE(file->immutable);
        }
        const auto chunk = folder.open("/chunks/0123456789abcdef0123456789abcdef.vogz");
        ASSERT_TRUE(chunk);
        EXPECT_TRUE(chunk->immutable);
        EXPECT_EQ(chunk->type, "application/octet-stream");
    }
}

TEST_F(site_folder, other_folders_and_files_are_refused) {
    for (const char* name :
         {"absent", "site/chunks", "secret", "site/manifest.json", "site/.hidden"})
        EXPECT_THROW(vog::cli::SiteFolder{dir_ / name}, Error) << name;
    std::filesystem::remove(dir_ / "site/manifest.json");
    EXPECT_THROW(vog::cli::SiteFolder{dir_ / "site"}, Error);
    EXPECT_EQ(vog::cli::SiteFolder(dir_ / "site/index.html").start(), "index.html");
}

}  // namespace vog::test
