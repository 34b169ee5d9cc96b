// text_head.h: lines of text before the values of a file, and their numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace vog::scan {

/// Lines of the head of a file.
class TextHead {
  public:
    /// Reads up to 1 MiB.
    explicit TextHead(const std::filesystem::path& file);
    /// Next line without its end: LF, CR LF, or CR where the first line has that. The last line of a file needs none.
    /// Returns false where the text ends, or a line longer than the head.
    bool next(std::string& line);
    std::uint64_t position() const { return position_; }  ///< of the next line, bytes

  private:
    std::string text_;
    std::uint64_t position_ = 0;
    bool whole_ = true;  ///< no byte of the file lies behind the text
    char end_ = '\n';
};

/// Text without blanks at its ends.
std::string_view without_blanks(std::string_view text);
/// Lower case of ASCII letters.
std::string lower_case(std::string_view text);
/// Parts of a text between blanks.
std::vector<std::string> words_of(std::string_view text);
/// Numbers of a text between blanks; NaN is one.
/// throws vog::Error: "scan.nrrd: sizes '3 x': expected 3 numbers"
/// count  expected number; 0: any
std::vector<double> numbers_of(const std::filesystem::path& file, const std::string& key,
                               std::string_view text, std::size_t count = 0);
/// As numbers_of, for integers.
std::vector<std::int64_t> integers_of(const std::filesystem::path& file, const std::string& key,
                                      std::string_view text, std::size_t count = 0);
/// Position of the byte behind `lines` ends of line.
/// throws vog::Error where there are fewer
std::uint64_t skip_lines(const std::filesystem::path& file, std::uint64_t begin,
                         std::int64_t lines);

/// Files of values that a head names, relative to its folder: one file, "LIST" and `list`, or numbered ones,
/// "s%03d.raw FIRST LAST STEP". Behind either may stand the number of axes in each file; default: all but the last.
/// throws vog::Error unless the files together make an array of these sizes
std::vector<std::filesystem::path> data_files(const std::filesystem::path& head,
                                              const std::string& named,
                                              const std::vector<std::string>& list,
                                              const std::vector<std::int64_t>& sizes);

}  // namespace vog::scan
