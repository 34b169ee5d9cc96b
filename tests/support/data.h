// data.h: paths of the source tree, the command and real inputs; temporary folders.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

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

/// Skips the test with a message if a real input is absent. `ctest -L data` runs the tests whose names have "real_data",
/// which every test that needs real inputs therefore has.
#define VOG_NEEDS_DATA(file)                                                                  \
    ASSERT_NE(std::string_view(testing::UnitTest::GetInstance()->current_test_info()->name()) \
                  .find("real_data"),                                                         \
              std::string_view::npos)                                                         \
        << "a test that reads " << (file) << " has real_data in its name";                    \
    if (!std::filesystem::exists(vog::test::data_dir() / (file)))                             \
    GTEST_SKIP() << (vog::test::data_dir() / (file)).string()                                 \
                 << " is absent (set VOG_DATA to the folder of real inputs)"
