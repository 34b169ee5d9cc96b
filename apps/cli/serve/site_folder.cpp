// site_folder.cpp: from a request's path to a file that lies below the folder.
#include "serve/site_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <system_error>
#include <utility>

#include "vog/error.h"

namespace vog::cli {

namespace {

namespace fs = std::filesystem;

/// Value of a hexadecimal digit; -1: none.
int digit_of(char letter) {
    if (letter >= '0' && letter <= '9') return letter - '0';
    if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
    return letter >= 'A' && letter <= 'F' ? letter - 'A' + 10 : -1;
}

/// Bytes of a percent-encoded path. None for bytes that no name of a site has.
std::optional<std::string> decoded(std::string_view text) {
    std::string path;
    for (std::size_t n = 0; n < text.size(); ++n) {
        char letter = text[n];
        const bool encoded = letter == '%';
        if (encoded) {
            if (text.size() - n < 3) return {};
            const int high = digit_of(text[n + 1]), low = digit_of(text[n + 2]);
            if (high < 0 || low < 0) return {};
            letter = char(high * 16 + low);
            n += 2;
        }
        const auto byte = static_cast<unsigned char>(letter);
        if (byte < ' ' || byte == 0x7f || letter == '\\' || (encoded && letter == '/')) return {};
        path += letter;
    }
    return path;
}

/// Whether each part of a path is a name that is not hidden: no empty one, none that begins with a dot.
bool plain_names(std::string_view path) {
    while (true) {
        const std::size_t end = path.find('/');
        const std::string_view name = path.substr(0, end);
        if (name.empty() || name.front() == '.') return false;
        if (end == path.npos) return true;
        path.remove_prefix(end + 1);
    }
}

/// Opens a name in a folder, following no link; null: it cannot be opened.
std::shared_ptr<const OpenFile> open_in(const OpenFile& folder, const std::string& name,
                                        int flags) {
    const int descriptor = ::openat(folder.descriptor(), name.c_str(),
                                    flags | O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    return descriptor < 0 ? nullptr : std::make_shared<const OpenFile>(descriptor);
}

/// Chunks are named by 32 lower-case hexadecimal digits of their content's checksum.
bool is_chunk(std::string_view path) {
    constexpr std::string_view kFolder = "chunks/";
    constexpr std::size_t kDigits = 32;
    if (!path.starts_with(kFolder)) return false;
    path.remove_prefix(kFolder.size());
    return path.size() > kDigits && path[kDigits] == '.' &&
           std::ranges::all_of(path.substr(0, kDigits), [](char letter) {
               return digit_of(letter) >= 0 && !(letter >= 'A' && letter <= 'F');
           });
}

/// An open file with its size and time; none unless it is a regular one.
/// path  of the request, without its first slash
std::optional<SiteFile> described(const std::shared_ptr<const OpenFile>& file,
                                  const std::string& path) {
    struct stat status {};
    if (!file || ::fstat(file->descriptor(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
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
            fmt::format("{}: a folder without {}, expected a site, as vog export MODEL -o site/ "
                        "writes it, a page (.html) or a compact model (.vogz)",
                        folder.string(), absent));
}

}  // namespace

OpenFile::~OpenFile() { (void)::close(descriptor_); }

std::optional<std::string> site_path(std::string_view request_path) {
    if (!request_path.starts_with('/')) return {};
    std::optional<std::string> path = decoded(request_path.substr(1));
    if (!path) return {};
    if (path->empty() || path->ends_with('/')) *path += "index.html";
    if (!plain_names(*path)) return {};
    return path;
}

std::string content_type(const std::string& name) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kTypes = {
        {{".html", "text/html; charset=utf-8"},
         {".json", "application/json"},
         {".js", "text/javascript; charset=utf-8"},
         {".css", "text/css; charset=utf-8"},
         {".txt", "text/plain; charset=utf-8"},
         {".png", "image/png"},
         {".jpg", "image/jpeg"},
         {".svg", "image/svg+xml"},
         {".ico", "image/x-icon"},
         {".wasm", "application/wasm"}}};
    std::string extension = fs::path(name).extension().string();
    for (char& letter : extension) letter = char(std::tolower(static_cast<unsigned char>(letter)));
    const auto found =
        std::ranges::find(kTypes, extension, [](const auto& type) { return type.first; });
    return std::string(found == kTypes.end() ? "application/octet-stream" : found->second);
}

SiteFolder::SiteFolder(const fs::path& path) {
    std::error_code code;
    root_ = fs::canonical(path, code);
    if (code)
        throw Error(fmt::format(
            "{}: {}", path.string(),
            code == std::errc::no_such_file_or_directory ? "no such folder" : code.message()));
    const bool folder = fs::is_directory(root_, code);
    if (folder) {
        check_site(path);
    } else {
        const std::string extension = root_.extension().string();
        if (!fs::is_regular_file(root_, code) || (extension != ".html" && extension != ".vogz") ||
            !plain_names(root_.filename().string()))
            throw Error(fmt::format(
                "{}: expected a site (a folder of vog export MODEL -o site/), a page (.html) or a "
                "compact model (.vogz)",
                path.string()));
        only_ = root_.filename().string();
        root_ = root_.parent_path();
    }
    const int descriptor = ::open(root_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        throw Error(fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
    folder_ = std::make_shared<const OpenFile>(descriptor);
}

std::optional<SiteFile> SiteFolder::open(std::string_view request_path) const {
    std::optional<std::string> path = site_path(request_path);
    if (path && page_ && request_path == "/") return described(page_, "index.html");
    if (!path || (!only_.empty() && *path != only_)) return {};
    // Links are resolved first. The result is then opened name by name without following any, so that one
    // that is put there in between opens nothing.
    std::error_code code;
    const fs::path real = fs::canonical(root_ / *path, code);
    if (code) return {};
    const std::string inside = real.lexically_relative(root_).string();
    if (!plain_names(inside)) return {};  // "../x" among them
    std::shared_ptr<const OpenFile> file = folder_;
    for (std::size_t begin = 0; begin != std::string::npos && file;) {
        const std::size_t end = inside.find('/', begin);
        const bool last = end == std::string::npos;
        const std::string name = inside.substr(begin, last ? end : end - begin);
        struct stat status {};
        // Opening a device may do something; a pipe has no end.
        if (last &&
            (::fstatat(file->descriptor(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 ||
             !S_ISREG(status.st_mode)))
            return {};
        file = open_in(*file, name, last ? 0 : O_DIRECTORY);
        begin = last ? end : end + 1;
    }
    return described(file, *path);
}

std::string SiteFolder::start() const { return page_ ? "" : only(); }

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
