// text_head.cpp: lines and numbers of heads in text.
#include "io/scan/text_head.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "core/atomic_file.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

constexpr std::size_t kMostShown = 60;

template <class T>
std::vector<T> parsed(const std::filesystem::path& file, const std::string& key,
                      std::string_view text, std::size_t count, const char* kind) {
    std::vector<T> values;
    bool good = true;
    for (const std::string& word : words_of(text)) {
        T value{};
        const char *begin = word.data(), *end = begin + word.size();
        if (*begin == '+') ++begin;
        const auto [stop, code] = std::from_chars(begin, end, value);
        good &= code == std::errc{} && stop == end;
        values.push_back(value);
    }
    if (!good || values.empty() || (count > 0 && values.size() != count))
        throw Error(fmt::format("{}: {} '{}', expected {}{}", file.string(), key,
                                printable(text, kMostShown),
                                count > 0 ? fmt::format("{} ", count) : std::string(), kind));
    return values;
}

std::filesystem::path file_beside(const std::filesystem::path& head, const std::string& name) {
    if (name.empty() || printable(name) != name)
        throw Error(fmt::format("{}: values in a file named '{}', expected the name of a file",
                                head.string(), printable(name, kMostShown)));
    return head.parent_path() / name;
}

/// "s%03d.raw 0 9 1": the name's text around a number, the number's least digits, the text of the range.
struct NumberedName {
    std::string before, behind, numbers;
    int width = 0;
};
std::optional<NumberedName> numbered_name(const std::string& text) {
    const std::size_t percent = text.find('%');
    if (percent == std::string::npos) return std::nullopt;
    NumberedName name;
    name.before = text.substr(0, percent);
    const char *digits = text.data() + percent + 1, *end = text.data() + text.size();
    const char* stop = std::from_chars(digits, end, name.width).ptr;
    constexpr int kMostDigits = 20;
    if (stop == end || *stop != 'd' || name.width > kMostDigits) return std::nullopt;
    const std::string rest(stop + 1, end);
    const std::size_t blank = rest.find_first_of(" \t");
    if (blank == std::string::npos) return std::nullopt;
    name.behind = rest.substr(0, blank);
    name.numbers = rest.substr(blank);
    return name;
}

}  // namespace

TextHead::TextHead(const std::filesystem::path& file) {
    require_readable(file);
    constexpr std::size_t kMostBytes = std::size_t{1} << 20;
    std::error_code code;
    text_.resize(std::min<std::uintmax_t>(kMostBytes, std::filesystem::file_size(file, code)));
    std::ifstream stream(file, std::ios::binary);
    stream.read(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.resize(static_cast<std::size_t>(stream.gcount()));
    whole_ = stream.peek() == std::ifstream::traits_type::eof();
    if (const std::size_t first = text_.find_first_of("\r\n");
        first != std::string::npos && text_[first] == '\r' && text_[first + 1] != '\n')
        end_ = '\r';
}

bool TextHead::next(std::string& line) {
    const std::size_t end = std::min(text_.find(end_, position_), text_.size());
    if (end == text_.size() && (!whole_ || position_ >= end)) return false;
    line = text_.substr(position_, end - position_);
    if (line.ends_with('\r')) line.pop_back();
    position_ = std::min(end + 1, text_.size());
    return true;
}

std::string_view without_blanks(std::string_view text) {
    constexpr const char* kBlanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    while (!(text = without_blanks(text)).empty()) {
        const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
        words.emplace_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return words;
}

std::vector<double> numbers_of(const std::filesystem::path& file, const std::string& key,
                               std::string_view text, std::size_t count) {
    return parsed<double>(file, key, text, count, "numbers");
}

std::vector<std::int64_t> integers_of(const std::filesystem::path& file, const std::string& key,
                                      std::string_view text, std::size_t count) {
    return parsed<std::int64_t>(file, key, text, count, "whole numbers");
}

std::uint64_t skip_lines(const std::filesystem::path& file, std::uint64_t begin,
                         std::int64_t lines) {
    require_readable(file);
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(begin));
    for (std::int64_t n = 0; n < lines; ++n)
        if (!stream.ignore(std::numeric_limits<std::streamsize>::max(), '\n') || stream.eof())
            throw Error(fmt::format("{}: truncated: {} lines, expected to skip {}", file.string(),
                                    n, lines));
    return static_cast<std::uint64_t>(stream.tellg());
}

std::vector<std::filesystem::path> data_files(const std::filesystem::path& head,
                                              const std::string& named,
                                              const std::vector<std::string>& list,
                                              const std::vector<std::int64_t>& sizes) {
    const std::vector<std::string> words = words_of(named);
    const bool listed = !words.empty() && words[0] == "LIST";
    const std::optional<NumberedName> numbered = numbered_name(named);
    if (!listed && !numbered) return {file_beside(head, named)};

    std::vector<std::filesystem::path> files;
    std::string axes;
    if (listed) {
        for (const std::string& name : list) files.push_back(file_beside(head, name));
        if (words.size() > 1) axes = words[1];
        if (axes.ends_with('D') || axes.ends_with('d')) axes.pop_back();  // MetaImage: "LIST 2D"
    } else {
        std::vector<std::string> numbers = words_of(numbered->numbers);
        if (numbers.size() > 3) axes = numbers[3], numbers.resize(3);
        if (numbers.size() == 2) numbers.emplace_back("1");
        const std::vector<std::int64_t> range =
            integers_of(head, named, fmt::format("{}", fmt::join(numbers, " ")), 3);
        constexpr std::int64_t kMost = 1 << 16;
        if (range[2] == 0 || std::abs(static_cast<double>(range[1] - range[0])) > 1e9 ||
            (range[1] - range[0]) / range[2] < 0 || (range[1] - range[0]) / range[2] >= kMost)
            throw Error(fmt::format("{}: files '{}', expected FIRST LAST STEP of 1 to {} files",
                                    head.string(), printable(named, kMostShown), kMost));
        for (std::int64_t n = range[0]; range[2] > 0 ? n <= range[1] : n >= range[1]; n += range[2])
            files.push_back(file_beside(head, fmt::format("{}{:0{}}{}", numbered->before, n,
                                                          numbered->width, numbered->behind)));
    }
    // The last axes count the files; files with all axes are slabs along the last one.
    const auto most = static_cast<std::int64_t>(sizes.size());
    const std::int64_t in_file = axes.empty() ? most - 1 : integers_of(head, named, axes, 1)[0];
    std::int64_t expected = 1;
    for (std::int64_t n = std::max<std::int64_t>(in_file, 0); n < most && expected < (1 << 20); ++n)
        expected *= sizes[static_cast<std::size_t>(n)];
    const auto count = static_cast<std::int64_t>(files.size());
    const bool slabs = in_file == most && count > 0 && sizes.back() % count == 0;
    if (in_file < 1 || in_file > most || (count != expected && !slabs))
        throw Error(fmt::format("{}: {} files of values, expected {} with {} axes each",
                                head.string(), count, expected, in_file));
    return files;
}

}  // namespace vog::scan
