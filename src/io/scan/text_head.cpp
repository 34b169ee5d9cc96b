// text_head.cpp: lines and numbers of heads in text.
#include "io/scan/text_head.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>

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

}  // namespace

TextHead::TextHead(const std::filesystem::path& file) {
    require_readable(file);
    constexpr std::size_t kMostBytes = std::size_t{1} << 20;
    std::error_code code;
    text_.resize(std::min<std::uintmax_t>(kMostBytes, std::filesystem::file_size(file, code)));
    std::ifstream stream(file, std::ios::binary);
    stream.read(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.resize(static_cast<std::size_t>(stream.gcount()));
}

bool TextHead::next(std::string& line) {
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string::npos) return false;
    line = text_.substr(position_, end - position_);
    if (line.ends_with('\r')) line.pop_back();
    position_ = end + 1;
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

std::filesystem::path file_beside(const std::filesystem::path& head, const std::string& name) {
    if (name.empty() || printable(name) != name)
        throw Error(fmt::format("{}: values in a file named '{}', expected the name of a file",
                                head.string(), printable(name, kMostShown)));
    return head.parent_path() / name;
}

}  // namespace vog::scan
