// tiff_files.cpp: Slices in a folder or by a pattern, and the order of their names.
#include "io/scan/tiff/tiff_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/file_extension.h"
#include "io/scan/scan_file.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

/// Whether a name matches a pattern with one or several *.
bool matches(std::string_view pattern, std::string_view name) {
    const std::size_t star = pattern.find('*');
    if (star == std::string_view::npos) return pattern == name;
    if (!name.starts_with(pattern.substr(0, star))) return false;
    for (std::size_t from = star; from <= name.size(); ++from)
        if (matches(pattern.substr(star + 1), name.substr(from))) return true;
    return false;
}

/// A number in a file's name, and its place there.
struct NameNumber {
    double value = 0;
    std::size_t begin = 0, end = 0;
};

/// decimals  whether 0.25 is one number, not two
std::vector<NameNumber> name_numbers(const std::filesystem::path& file, bool decimals = false) {
    const std::string name = file.stem().string();
    const auto digit = [&](std::size_t n) {
        return n < name.size() && std::isdigit(static_cast<unsigned char>(name[n])) != 0;
    };
    std::vector<NameNumber> numbers;
    for (std::size_t n = 0; n < name.size(); ++n) {
        if (!digit(n)) continue;
        NameNumber number{0, n, n};
        for (; digit(n); ++n) number.value = 10 * number.value + (name[n] - '0');
        if (decimals && name[std::min(n, name.size() - 1)] == '.' && digit(n + 1)) {
            double place = 1;
            for (++n; digit(n); ++n) number.value += (place /= 10) * (name[n] - '0');
        }
        number.end = n;
        numbers.push_back(number);
    }
    return numbers;
}

/// Slices by one of the numbers of their names.
struct NumberedSlices {
    std::vector<std::pair<double, std::filesystem::path>> slices;  ///< in the order of the numbers
    std::size_t place = 0;                                         ///< of the number in a name
    std::size_t count = 0;                                         ///< of different numbers
    double step = 0;                                               ///< least one between two

    NumberedSlices(const std::vector<std::filesystem::path>& files, std::size_t which,
                   bool decimals)
        : place(which) {
        for (const auto& file : files)
            slices.emplace_back(name_numbers(file, decimals)[which].value, file);
        std::ranges::stable_sort(slices, {}, [](const auto& slice) { return slice.first; });
        for (std::size_t n = 0; n < slices.size(); ++n) count += n == 0 || gap(n) > 0;
        step = gap(1);
        for (std::size_t n = 2; n < slices.size(); ++n) step = std::min(step, gap(n));
    }
    double gap(std::size_t n) const { return slices[n].first - slices[n - 1].first; }
    bool distinct() const { return count == slices.size(); }
    /// First slice whose number is too far behind that of the one before it; 0: none.
    std::size_t first_gap() const {
        constexpr double kRounding = 1e-6;
        for (std::size_t n = 1; n < slices.size(); ++n)
            if (gap(n) > step * (1 + kRounding)) return n;
        return 0;
    }
    std::string name(std::size_t n) const {
        return printable(slices[n].second.filename().string());
    }
    /// Pattern of the names that differ from the first one in this number.
    std::string pattern() const {
        const NameNumber number = name_numbers(slices[0].second)[place];
        return name(0).replace(number.begin, number.end - number.begin, "*");
    }
};

std::size_t least_count(const std::vector<std::filesystem::path>& files, bool decimals) {
    std::size_t count = name_numbers(files[0], decimals).size();
    for (const auto& file : files) count = std::min(count, name_numbers(file, decimals).size());
    return count;
}

/// throws vog::Error where a name has another count of numbers than most
void check_counts(const std::filesystem::path& where,
                  const std::vector<std::filesystem::path>& files) {
    const auto count = [](const std::filesystem::path& file) { return name_numbers(file).size(); };
    std::map<std::size_t, std::size_t> equals;
    for (const auto& file : files) equals[count(file)] += 1;
    const auto most =
        std::ranges::max_element(files, {}, [&](const auto& file) { return equals[count(file)]; });
    for (const auto& file : files)
        if (count(file) != count(*most))
            throw Error(
                fmt::format("{}: {} has {} numbers in its name, expected {} as in {}: move it, or "
                            "give a pattern of slices",
                            where.string(), printable(file.filename().string()), count(file),
                            count(*most), printable(most->filename().string())));
}

/// Sorts slices by the first number of their names that steps evenly from slice to slice.
/// throws vog::Error where there is none, unless all numbers are constant
void order_series(const std::filesystem::path& where, std::vector<std::filesystem::path>& files) {
    if (files.size() < 2) return;
    check_counts(where, files);
    std::optional<NumberedSlices> best;
    // Places in decimals, 0.25 and 0.5, are numbers where their halves are none.
    for (const bool decimals : {false, true})
        for (std::size_t n = 0; n < least_count(files, decimals); ++n) {
            NumberedSlices one(files, n, decimals);
            if (one.distinct() && one.first_gap() == 0) {
                std::ranges::transform(one.slices, files.begin(),
                                       [](const auto& s) { return s.second; });
                return;
            }
            if (!decimals && (!best || one.count >= best->count)) best = std::move(one);
        }
    if (!best || best->count == 1) return;
    if (const std::size_t n = best->first_gap(); best->distinct())
        throw Error(fmt::format(
            "{}: slice {} is missing between {} and {}, expected numbers that step evenly",
            where.string(), best->slices[n - 1].first + best->step, best->name(n - 1),
            best->name(n)));
    std::size_t n = 1;
    while (best->gap(n) > 0) ++n;
    throw Error(
        fmt::format("{}: {} and {} have one slice number, expected one file for each: give a "
                    "pattern of one channel, such as '{}'",
                    where.string(), best->name(n - 1), best->name(n), best->pattern()));
}

}  // namespace

bool is_tiff(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".tif" || extension == ".tiff";
}

bool is_tiff_folder(const std::filesystem::path& folder) {
    std::error_code code;
    if (!std::filesystem::is_directory(folder, code)) return false;
    for (const auto& entry : std::filesystem::directory_iterator(folder, code))
        if (is_tiff(entry.path())) return true;
    return false;
}

std::vector<std::filesystem::path> tiff_files(const std::filesystem::path& file) {
    std::error_code code;
    const bool folder = std::filesystem::is_directory(file, code);
    const std::string pattern = folder ? "*" : file.filename().string();
    if (!folder && (pattern.find('*') == std::string::npos || std::filesystem::exists(file, code)))
        return {file};
    const std::filesystem::path parent = folder                   ? file
                                         : file.has_parent_path() ? file.parent_path()
                                                                  : std::filesystem::path(".");
    constexpr std::size_t kLongest = 200;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(parent, code))
        if (const std::string name = entry.path().filename().string();
            is_tiff(entry.path()) && name.size() < kLongest && matches(pattern, name))
            files.push_back(entry.path());
    if (files.empty()) throw Error(fmt::format("{}: no TIFF files of this pattern", file.string()));
    std::ranges::sort(files);
    order_series(file, files);
    return files;
}

}  // namespace vog::scan
