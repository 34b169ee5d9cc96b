// site_folder.h: files below one folder, opened by the paths of requests.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace vog::cli {

/// A file open for reading, closed with its last owner; null: it cannot be opened.
std::shared_ptr<std::FILE> open_shared(const std::filesystem::path& path);

/// A regular file of a site.
struct SiteFile {
    std::shared_ptr<std::FILE> file;
    std::uint64_t size = 0;  ///< bytes, when it was opened
    std::string tag;         ///< of this content: an HTTP entity tag with its quotes
    std::string type;        ///< MIME type, by extension; application/octet-stream for others
    bool immutable = false;  ///< a chunk, named by its content
};

/// A folder, or a single file, whose files are served.
class SiteFolder {
  public:
    /// path    a site (docs/streaming.md), a page (.html) or a compact model (.vogz)
    /// throws  vog::Error for anything else
    explicit SiteFolder(const std::filesystem::path& path);

    /// Answers requests of / by a page in place of the only file, which stays beside it.
    void begin_with(std::shared_ptr<std::FILE> page) { page_ = std::move(page); }

    /// Opens the file that a request names; a path that ends in / stands for the index.html in there.
    /// path  decoded, from the first slash on
    /// returns  none: there is no such file, it is hidden, no regular one, or lies outside the folder
    std::optional<SiteFile> open(const std::string& path) const;

    /// Path of the page to open, percent-encoded, without its first slash: empty for a site and for begin_with.
    std::string start() const { return page_ ? "" : only(); }
    /// Percent-encoded name of the only file; empty: a site.
    std::string only() const;

  private:
    std::filesystem::path root_;  ///< without symbolic links
    std::string only_;            ///< name of the single file; empty: all below root_
    std::shared_ptr<std::FILE> page_;
};

}  // namespace vog::cli
