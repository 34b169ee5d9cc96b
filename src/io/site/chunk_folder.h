// chunk_folder.h: files of a site's chunks as they are written, each once, by many threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "io/site/manifest.h"

namespace vog::site {

class ChunkFolder {
  public:
    /// site  the folder above that of the chunks
    explicit ChunkFolder(std::filesystem::path site) : site_(std::move(site)) {}

    /// Writes a chunk's files, and sets name and sizes in its row.
    /// contents  of chunk_contents
    /// throws    vog::Error if a file cannot be written
    void write_chunk(Row& row, const std::vector<std::string>& contents);
    /// Moves the parts of a row into a table.
    void write_table(Row& row);

    const std::filesystem::path& site() const { return site_; }
    const std::set<std::string>& files() const { return files_; }  ///< names in the folder
    std::uint64_t bytes() const { return bytes_; }                 ///< size of these files
    std::uint64_t kept() const { return kept_; }  ///< chunks that were there already

  private:
    bool put(const std::filesystem::path& file, const std::string& bytes);

    std::filesystem::path site_;
    std::set<std::string> files_;
    std::uint64_t bytes_ = 0, kept_ = 0;
    std::mutex mutex_;
};

}  // namespace vog::site
