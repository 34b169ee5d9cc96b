// serve_requests_test.cpp: heads, hosts, ranges and paths of requests to vog serve, without a network.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "serve/request_head.h"
#include "serve/site_folder.h"
#include "support/data.h"
#include "vog/error.h"

namespace vog::test {

using cli::RangeRequest;
using Kind = cli::RangeRequest::Kind;

constexpr std::string_view kHead =
    "GET /chunks/a%20b.0?x=1 HTTP/1.1\r\nHost: localhost\r\nX-Two: a\r\nx-two:\tb \r\n\r\n";

TEST(serve_requests, a_head_is_parsed) {
    const cli::RequestHead head = cli::parse_request_head(kHead, false);
    EXPECT_EQ(head.status, 200) << head.reason;
    EXPECT_EQ(head.method, "GET");
    EXPECT_EQ(head.path, "/chunks/a%20b.0");
    EXPECT_TRUE(head.keeps_open);
    EXPECT_EQ(head.fields,
              (std::map<std::string, std::string>{{"host", "localhost"}, {"x-two", "a, b"}}));
}

TEST(serve_requests, a_head_ends_at_its_empty_line) {
    const std::string both = std::string(kHead) + "GET /next HTTP/1.1\r\n";
    for (std::size_t n = 0; n <= both.size(); ++n)
        EXPECT_EQ(cli::head_size(both.substr(0, n)), n < kHead.size() ? 0 : kHead.size()) << n;
    EXPECT_EQ(cli::head_size("GET / HTTP/1.1\n\nrest"), 16u);
}

TEST(serve_requests, truncated_heads_are_refused) {
    for (std::size_t n = 0; n < kHead.size() - 2; ++n) {
        const cli::RequestHead head = cli::parse_request_head(kHead.substr(0, n), false);
        // At ends of lines behind the first two only the empty line is absent.
        const bool line = n > 50 && kHead.substr(0, n).ends_with("\r\n");
        EXPECT_EQ(head.status, line ? 200 : 400) << n;
    }
}

TEST(serve_requests, a_single_other_byte_is_parsed_or_refused) {
    for (std::size_t n = 0; n < kHead.size(); ++n)
        for (const int byte : {0, 9, 10, 13, 32, 37, 47, 58, 92, 127, 128, 255}) {
            std::string text(kHead);
            text[n] = char(byte);
            const cli::RequestHead head = cli::parse_request_head(text, false);
            EXPECT_EQ(head.status == 200, head.reason.empty());
            EXPECT_EQ(head.method, head.status == 200 ? "GET" : "");
        }
}

TEST(serve_requests, connections_close_on_demand) {
    const auto keeps = [](const std::string& version, const std::string& connection) {
        return cli::parse_request_head(
                   "GET / HTTP/" + version + "\r\nHost: a\r\n" + connection + "\r\n", false)
            .keeps_open;
    };
    EXPECT_TRUE(keeps("1.1", ""));
    EXPECT_TRUE(keeps("1.1", "Connection: keep-alive\r\n"));
    EXPECT_FALSE(keeps("1.1", "Connection: Close\r\n"));
    EXPECT_FALSE(keeps("1.0", "Connection: keep-alive\r\n"));
}

TEST(serve_requests, only_names_of_loopback_are_hosts) {
    for (const char* host : {"localhost", "LOCALHOST:8080", "127.0.0.1", "[::1]", "[::1]:1", "own"})
        EXPECT_TRUE(cli::is_loopback_host(host, "Own")) << host;
    for (const char* host : {"", ":", "a.example", "localhost.a.example", "localhost:x", "[::1",
                             "]", "[", "[::1]]", "127.0.0.10", "localhost:123456", "[localhost]"})
        EXPECT_FALSE(cli::is_loopback_host(host, "own")) << host;
    EXPECT_FALSE(cli::is_loopback_host("", ""));
    EXPECT_FALSE(cli::is_loopback_host(":80", ""));
}

void expect_range(const char* field, std::uint64_t size, Kind kind, std::uint64_t first = 0,
                  std::uint64_t count = 0) {
    const RangeRequest range = cli::requested_range(field, size);
    EXPECT_TRUE(range.kind == kind) << field;
    EXPECT_EQ(range.first, first) << field;
    EXPECT_EQ(range.count, count) << field;
}

TEST(serve_requests, ranges_lie_within_the_file) {
    expect_range("bytes=0-0", 10, Kind::part, 0, 1);
    expect_range("bytes=3-99", 10, Kind::part, 3, 7);
    expect_range("bytes=9-", 10, Kind::part, 9, 1);
    expect_range("bytes=-3", 10, Kind::part, 7, 3);
    expect_range("bytes=-99", 10, Kind::part, 0, 10);
    expect_range("bytes=0-999999999999999999", UINT64_MAX, Kind::part, 0,
                 1'000'000'000'000'000'000);
    expect_range("bytes=10-", 10, Kind::beyond);
    expect_range("bytes=-0", 10, Kind::beyond);
    for (const char* field : {"bytes=0-", "bytes=-1"}) expect_range(field, 0, Kind::beyond);
    for (const char* field :
         {"", "bytes=", "bytes=-", "bytes=5-4", "bytes=0-1,3-4", "bytes=+0-1", "bytes=0-1 ",
          "lines=0-1", "bytes=0-1000000000000000000", "bytes=18446744073709551616-", "bytes=0--1"})
        expect_range(field, 10, Kind::whole);
}

TEST(serve_requests, paths_stay_below_the_folder) {
    EXPECT_EQ(cli::site_path("/"), "index.html");
    EXPECT_EQ(cli::site_path("/a%20b/"), "a b/index.html");
    EXPECT_EQ(cli::site_path("/a..b/c."), "a..b/c.");
    EXPECT_EQ(cli::site_path("/%252e%252e"), "%2e%2e");
    using namespace std::string_literals;
    for (const std::string& path :
         {""s,       "a"s,      "//"s,    "/."s,   "/.."s,   "/../a"s, "/a/../b"s,  "/%2e%2e/a"s,
          "/a%2fb"s, "/a%2Fb"s, "/a\\b"s, "/%5c"s, "/a%00"s, "/a\0b"s, "/.hidden"s, "/a/.b"s,
          "/a//b"s,  "/%"s,     "/%4"s,   "/%4g"s, "/a%0a"s, "/%7f"s})
        EXPECT_EQ(cli::site_path(path), std::nullopt) << path;
}

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

TEST_F(site_folder, links_that_leave_it_open_nothing) {
    namespace fs = std::filesystem;
    fs::create_symlink("../secret", dir_ / "site/out");
    fs::create_symlink("..", dir_ / "site/up");
    fs::create_symlink(".hidden", dir_ / "site/hidden");
    fs::create_symlink("index.html", dir_ / "site/in.html");
    fs::create_directory_symlink(dir_ / "site", dir_ / "link");
    for (const char* name : {"site", "link"}) {
        const cli::SiteFolder folder(dir_ / name);
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
        EXPECT_THROW(cli::SiteFolder{dir_ / name}, Error) << name;
    std::filesystem::remove(dir_ / "site/manifest.json");
    EXPECT_THROW(cli::SiteFolder{dir_ / "site"}, Error);
    EXPECT_EQ(cli::SiteFolder(dir_ / "site/index.html").start(), "index.html");
}

}  // namespace vog::test
