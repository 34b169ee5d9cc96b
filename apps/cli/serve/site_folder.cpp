// site_folder.cpp: from a request's path to a file that lies below the folder.
#include "serve/site_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "vog/error.h"

namespace vog::cli {

namespace {

namespace fs = std::filesystem;

/// Whether a path consists of names that are not hidden: no empty one, none that begins with a dot, no control characters.
bool plain_names(std::string_view path) {
    if (path.empty() || path.front() == '/' || path.back() == '/') return false;
    for (std::size_t n = 0; n < path.size(); ++n) {
        const auto byte = static_cast<unsigned char>(path[n]);
        const bool first = n == 0 || path[n - 1] == '/';
        if (byte < ' ' || byte == 0x7f || (first && (byte == '.' || byte == '/'))) return false;
    }
    return true;
}

/// Chunks are named by 32 lower-case hexadecimal digits of their content's checksum.
bool is_chunk(std::string_view path) {
    constexpr std::string_view kFolder = "chunks/";
    return path.starts_with(kFolder) &&
           path.find_first_not_of("0123456789abcdef", kFolder.size()) == kFolder.size() + 32 &&
           path[kFolder.size() + 32] == '.';
}

std::string content_type(const fs::path& name) {
    static const std::map<std::string, std::string> kTypes = {
        {".html", "text/html; charset=utf-8"},
        {".json", "application/json"},
        {".js", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".txt", "text/plain; charset=utf-8"},
        {".png", "image/png"},
        {".jpg", "image/jpeg"},
        {".svg", "image/svg+xml"},
        {".ico", "image/x-icon"},
        {".wasm", "application/wasm"}};
    const auto found = kTypes.find(name.extension().string());
    return found == kTypes.end() ? "application/octet-stream" : found->second;
}

/// An open file with its size and time; none unless it is a regular one.
/// path  of the request, without its first slash
std::optional<SiteFile> described(const std::shared_ptr<std::FILE>& file, const std::string& path) {
    struct stat status {};
    if (!file || ::fstat(::fileno(file.get()), &status) != 0 || !S_ISREG(status.st_mode)) return {};
    return SiteFile{file, static_cast<std::uint64_t>(status.st_size),
                    fmt::format("\"{:x}-{:x}-{:x}\"", status.st_size, status.st_ctim.tv_sec,
                                status.st_ctim.tv_nsec),
                    content_type(path), is_chunk(path)};
}

/// Refusal of a folder that is no site, with what it lacks.
void check_site(const fs::path& folder) {
    std::string absent;
    for (const char* name : {"index.html", "manifest.json"}) {
        std::error_code code;
        if (!fs::is_regular_file(folder / name, code))
            absent += fmt::format("{}{}", absent.empty() ? "" : " and ", name);
    }
    if (!absent.empty())
        throw Error(
            fmt::format("{}: a folder without {}; expected a site (vog page MODEL -o site/ writes "
                        "one), a page (.html) or a compact model (.vogz)",
                        folder.string(), absent));
}

}  // namespace

std::shared_ptr<std::FILE> open_shared(const fs::path& path) {
    std::FILE* file = std::fopen(path.c_str(), "rbe");
    return file ? std::shared_ptr<std::FILE>(file, &std::fclose) : nullptr;
}

SiteFolder::SiteFolder(const fs::path& path) {
    std::error_code code;
    root_ = fs::canonical(path, code);
    if (code)
        throw Error(fmt::format(
            "{}: {}", path.string(),
            code == std::errc::no_such_file_or_directory ? "no such folder" : code.message()));
    if (fs::is_directory(root_, code)) {
        check_site(path);
        return;
    }
    only_ = root_.filename().string();
    const std::string extension = root_.extension().string();
    if (!fs::is_regular_file(root_, code) || (extension != ".html" && extension != ".vogz") ||
        !plain_names(only_))
        throw Error(
            fmt::format("{}: expected a site (a folder from vog page MODEL -o site/), a page "
                        "(.html) or a compact model (.vogz)",
                        path.string()));
    root_ = root_.parent_path();
}

std::optional<SiteFile> SiteFolder::open(const std::string& request_path) const {
    if (page_ && request_path == "/") return described(page_, "index.html");
    if (!request_path.starts_with('/')) return {};
    const std::string path =
        request_path.substr(1) + (request_path.ends_with('/') ? "index.html" : "");
    if (!plain_names(path) || (!only_.empty() && path != only_)) return {};
    std::error_code code;
    if (!fs::is_regular_file(root_ / path, code)) return {};  // opening a pipe would wait
    const std::shared_ptr<std::FILE> file = open_shared(root_ / path);
    if (!file) return {};
    // Links count by the place of the file that they opened, as they may change at any time.
    const std::string link = fmt::format("/proc/self/fd/{}", ::fileno(file.get()));
    const fs::path place = fs::read_symlink(link, code).lexically_relative(root_);
    if (code || !plain_names(place.string())) return {};  // "../x" among them
    return described(file, path);
}

std::string SiteFolder::only() const {
    std::string text;
    for (const char letter : only_) {
        const auto byte = static_cast<unsigned char>(letter);
        const bool plain =
            std::isalnum(byte) || std::string_view("-._~").find(letter) != std::string_view::npos;
        text += plain ? std::string{letter} : fmt::format("%{:02X}", byte);
    }
    return text;
}

}  // namespace vog::cli
