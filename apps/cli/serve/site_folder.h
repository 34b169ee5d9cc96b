// site_folder.h: files below one folder, opened by the paths of requests.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace vog::cli {

/// An open file or folder, closed with its last owner.
class OpenFile {
  public:
    explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
    ~OpenFile();
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    int descriptor() const { return descriptor_; }

  private:
    int descriptor_;
};

/// A regular file of a site, open for reading.
struct SiteFile {
    std::shared_ptr<const OpenFile> file;
    std::uint64_t size = 0;  ///< bytes, when it was opened
    std::string tag;         ///< of this content: an HTTP entity tag with its quotes
    std::string type;        ///< MIME type, by extension
    bool immutable = false;  ///< a chunk, named by its content
};

/// File name that the path of a request stands for, relative to the site: "/a%20b/" ->
/// "a b/index.html". None for paths that leave the site (.., backslashes, encoded slashes), that name
/// hidden files, or with control characters. Decoded once: "%252e" is "%2e", a name like others.
std::optional<std::string> site_path(std::string_view request_path);

/// MIME type of a file's extension; application/octet-stream for those that a page does not name.
std::string content_type(const std::string& name);

/// A folder, or a single file, whose files are served.
class SiteFolder {
  public:
    /// path    a site (docs/streaming.md), a page (.html) or a compact model (.vogz)
    /// throws  vog::Error for anything else
    explicit SiteFolder(const std::filesystem::path& path);

    /// Answers requests of / by a page in place of the only file, which stays beside it.
    void begin_with(std::shared_ptr<const OpenFile> page) { page_ = std::move(page); }

    /// Opens the file that a request names. None: there is none, it is no regular file, it cannot be
    /// read, or a symbolic link leads out of the folder or to a hidden file.
    std::optional<SiteFile> open(std::string_view request_path) const;

    /// Path of the page to open, percent-encoded, without its first slash: empty for a site and for begin_with.
    std::string start() const;
    /// Percent-encoded name of the only file; empty: a site.
    std::string only() const;

  private:
    std::filesystem::path root_;  ///< without symbolic links
    std::string only_;            ///< name of the single file; empty: all below root_
    std::shared_ptr<const OpenFile> folder_;
    std::shared_ptr<const OpenFile> page_;  ///< of begin_with; null: none
};

}  // namespace vog::cli
