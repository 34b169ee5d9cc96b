// request_fuzz.cpp: Heads, paths, hosts and ranges of requests to vog serve.
#include <algorithm>
#include <cctype>
#include <string_view>

#include "fuzz_target.h"
#include "serve/request_head.h"
#include "serve/site_folder.h"

namespace vog::fuzz {

const Limits kLimits{};

namespace {

void check_path(std::string_view request_path) {
    const std::optional<std::string> path = cli::site_path(request_path);
    if (!path) return;
    expect(std::ranges::none_of(
               *path, [](char letter) { return (letter >= 0 && letter < ' ') || letter == '\\'; }),
           "a path has no control characters and no backslashes");
    const std::filesystem::path root = "/site", whole = (root / *path).lexically_normal();
    expect(whole.string() == "/site/" + *path, "a path is in normal form, below the site");
    for (const std::filesystem::path& name : std::filesystem::path(*path))
        expect(!name.empty() && !name.string().starts_with('.'), "no name is hidden");
}

void check_head(std::string_view text) {
    const std::size_t size = cli::head_size(text);
    expect(size <= text.size(), "a head ends within the received bytes");
    for (const bool preflight : {false, true}) {
        const cli::RequestHead head = cli::parse_request_head(text.substr(0, size), preflight);
        expect((head.status == 200) == head.reason.empty(), "a refusal has a reason");
        if (head.status != 200) continue;
        expect(size > 0 && size <= cli::kLargestRequestHead,
               "a head is whole and within its limit");
        expect(head.path.starts_with('/') && head.path.size() < cli::kLargestRequestLine &&
                   head.path.find_first_of(" \r\n?#") == std::string::npos,
               "a path is one word without its query");
        expect(head.method == "GET" || head.method == "HEAD" ||
                   (preflight && head.method == "OPTIONS"),
               "a method reads");
        expect(head.fields.size() <= cli::kMostFields, "fields are few");
        for (const auto& [name, value] : head.fields)
            expect(value.find_first_of("\r\n") == std::string::npos, "a field is one line");
        check_path(head.path);
    }
}

void check_host(std::string_view text) {
    if (!cli::is_loopback_host(text, "own")) return;
    for (const std::string_view name : {"localhost", "127.0.0.1", "[::1]", "own"}) {
        if (text.size() < name.size() ||
            !std::ranges::equal(text.substr(0, name.size()), name, [](char a, char b) {
                return std::tolower(static_cast<unsigned char>(a)) == b;
            }))
            continue;
        const std::string_view port = text.substr(name.size());
        expect(port.empty() ||
                   (port.front() == ':' && port.find_first_not_of("0123456789", 1) == port.npos),
               "nothing but a port follows a host");
        return;
    }
    expect(false, "a host of loopback has one of four names");
}

}  // namespace

void run(Bytes input) {
    // First byte: what the rest is; then a file's size for a range.
    Numbers numbers(input);
    const int kind = numbers.byte() % 4;
    const std::size_t skipped = std::min<std::size_t>(input.size(), kind == 3 ? 9 : 1);
    const std::string_view text(reinterpret_cast<const char*>(input.data()) + skipped,
                                input.size() - skipped);
    if (kind == 0) check_head(text);
    if (kind == 1) check_path(text);
    if (kind == 2) check_host(text);
    if (kind == 3) {
        const std::uint64_t size = numbers.bits(8);
        const cli::RangeRequest range = cli::requested_range(text, size);
        expect(range.kind != cli::RangeRequest::Kind::part ||
                   (range.count > 0 && range.first < size && range.count <= size - range.first),
               "a range lies within the file");
    }
}

}  // namespace vog::fuzz
