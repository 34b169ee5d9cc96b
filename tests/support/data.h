// data.h: where tests find real inputs, and a folder of their own to write into.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace vog::test {

/// The source tree this was built from, and the command it built.
std::filesystem::path source_dir();
std::string vog_command();

/// The folder of real inputs: VOG_DATA, or ../shared/data beside the source tree.
inline std::filesystem::path data_dir() {
    if (const char* named = std::getenv("VOG_DATA")) return named;
    return source_dir() / ".." / "shared" / "data";
}

/// A fresh folder, removed with its contents when the object goes.
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

/// Skips the test, aloud, where a real input is absent.
#define VOG_NEEDS_DATA(name)                                      \
    if (!std::filesystem::exists(vog::test::data_dir() / (name))) \
    GTEST_SKIP() << (vog::test::data_dir() / (name)).string()     \
                 << " is absent (set VOG_DATA to the folder of real inputs)"
