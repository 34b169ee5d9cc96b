// data.h: paths of the source tree, the command and real inputs; temporary folders.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace vog::test {

/// Source tree of this build, and path of its vog command.
std::filesystem::path source_dir();
std::string vog_command();

/// Folder of real inputs: VOG_DATA, or ../shared/data beside the source tree.
inline std::filesystem::path data_dir() {
    if (const char* named = std::getenv("VOG_DATA")) return named;
    return source_dir() / ".." / "shared" / "data";
}

/// True in runs of scripts/nightly.sh (VOG_NIGHTLY is set), which try more values of a parameter than every change does.
inline bool nightly() { return std::getenv("VOG_NIGHTLY") != nullptr; }

/// New temporary folder, removed with its contents on destruction.
class TempDir {
  public:
    TempDir() {
        std::string pattern = (std::filesystem::temp_directory_path() / "vog-test-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TempDir() { std::filesystem::remove_all(path_); }
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

}  // namespace vog::test

/// Skips the test with a message if a real input is absent.
#define VOG_NEEDS_DATA(name)                                      \
    if (!std::filesystem::exists(vog::test::data_dir() / (name))) \
    GTEST_SKIP() << (vog::test::data_dir() / (name)).string()     \
                 << " is absent (set VOG_DATA to the folder of real inputs)"
