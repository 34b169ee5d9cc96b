// vog/temporary_file.h: files written beside their name and renamed when complete, and their
// removal when a signal ends the program.
#pragma once

#include <filesystem>

namespace vog {

/// New file under a short, unused name in the folder of a file to write, with its extension. The
/// short name is valid wherever the file's own is.
class TemporaryFile {
  public:
    /// Creates the file, empty.
    /// throws vog::Error if `file` cannot be written: with the system's reason
    explicit TemporaryFile(const std::filesystem::path& file);
    /// Removes the temporary file, unless it was renamed.
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Waits until the disk has its bytes (fsync), then renames it to `file`, which it replaces, and waits
    /// until the disk has the name.
    /// throws vog::Error with the system's reason
    void rename();

  private:
    std::filesystem::path file_, path_;
    int slot_ = -1;  ///< in the list of remove_temporary_files; -1: none, or renamed
    bool renamed_ = false;
};

/// Removes the files of all TemporaryFiles alive. Async-signal-safe, for handlers of signals that
/// end the program next: a later TemporaryFile waits for that end.
void remove_temporary_files() noexcept;

}  // namespace vog
