// recent_files.h: files that were opened lately.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vog::viewer {

/// Sets of files opened together, the latest first, kept in one text file: a set a line, tabs between.
class RecentFiles {
  public:
    static constexpr std::size_t kMost = 12;  ///< sets

    /// list  empty: nothing is kept; a file that cannot be read holds nothing
    explicit RecentFiles(std::filesystem::path list);
    const std::vector<std::vector<std::string>>& sets() const { return sets_; }
    /// Puts a set first, by absolute paths, and writes the list. Names with a tab or an end of line are left out.
    /// throws  vog::Error if the list cannot be written
    void add(const std::vector<std::string>& files);

  private:
    std::filesystem::path list_;
    std::vector<std::vector<std::string>> sets_;
};
/// $XDG_STATE_HOME/vog/recent, else ~/.local/state/vog/recent; empty: there is no home.
std::filesystem::path recent_files_path();
/// "smoke.vdb", "level0.vdb and 2 more".
std::string set_name(const std::vector<std::string>& files);

}  // namespace vog::viewer
