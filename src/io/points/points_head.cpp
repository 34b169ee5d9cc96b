// points_head.cpp: reading of the lines above the particles of a text file, and of the first particles.
#include "io/points/points_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/points/column_names.h"
#include "io/points/text_fields.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::point_files {

namespace {

/// Particles that are looked at for separators, columns and their types.
constexpr std::size_t kSample = 64;

/// Number of numbers among the fields of a line, those with a decimal comma included.
std::size_t count_numbers(std::string_view line, char separator) {
    const Fields fields = split_fields(line, separator);
    return static_cast<std::size_t>(std::ranges::count_if(
        fields, [](auto field) { return is_number(field) || has_decimal_comma(field); }));
}

/// Separator that gives most of the first lines the most numbers. Lines that leave a choice have no say; `own` is preferred.
char find_separator(std::string_view text, char own) {
    std::array<char, 4> candidates{0, ';', ',', '\t'};
    std::array<std::size_t, 4> votes{};
    bool tabs = false;  // between the names of a header, which may hold blanks
    for (std::size_t lines = 0; !text.empty() && lines < kSample;) {
        const std::string_view line = trimmed(take_line(text));
        if (line.empty()) continue;
        if (is_comment_or_empty(line)) {
            tabs |= line.find('\t') != line.npos;
            continue;
        }
        ++lines;
        std::array<std::size_t, 4> numbers{};
        std::ranges::transform(candidates, numbers.begin(),
                               [&](char separator) { return count_numbers(line, separator); });
        const std::size_t most = std::ranges::max(numbers);
        if (most == 0) tabs |= line.find('\t') != line.npos;
        for (std::size_t n = 0; n < votes.size(); ++n) votes[n] += most > 0 && numbers[n] == most;
    }
    const std::size_t most = std::ranges::max(votes);
    const auto voted = [&](char separator) {
        return votes[static_cast<std::size_t>(std::ranges::find(candidates, separator) -
                                              candidates.begin())] == most;
    };
    if (voted(own) && !(own == 0 && tabs && voted('\t'))) return own;
    if (tabs && voted('\t')) return '\t';
    return *std::ranges::find_if(candidates, voted);
}

std::size_t filled(const Fields& fields) {
    std::size_t count = fields.size();
    while (count > 0 && fields[count - 1].empty()) --count;
    return count;
}

Names names_of(const Fields& fields) {
    Names names;
    for (const std::string_view field : fields)
        names.push_back(field.empty() ? number_name(names.size()) : printable(field));
    return names;
}

/// Reads the lines of a head in turn.
class HeadReader {
  public:
    HeadReader(std::string_view text, char separator, bool xyz, bool title)
        : text_(text), xyz_(xyz), title_(title) {
        head_.separator = separator;
    }

    PointHead read() {
        for (; !text_.empty(); ++head_.line) {
            const std::string_view before = text_;
            const std::string_view line = trimmed(take_line(text_), head_.separator);
            if (trimmed(line).empty()) continue;
            if (is_comment_or_empty(line, head_.separator) || line.front() == '\\') {
                comments_.push_back(without_mark(line));
                continue;
            }
            if (line.front() == '|' && line.back() == '|')
                throw Error(
                    "an IPAC table, expected columns between blanks or commas: astropy makes them "
                    "by Table.read(FILE, format='ipac').write('particles.ecsv')");
            const Fields fields = split_fields(line, head_.separator);
            if (is_count(fields)) {
                read_count(fields.front());
                continue;
            }
            if (is_header(fields) && !lacks_position(fields)) {
                if (head_.separator && !names_position(fields) && std::ranges::count(line, '"') % 2)
                    throw Error(fmt::format(
                        "a quoted field begins in line {} and ends in another, expected one line",
                        head_.line + 1));
                headers_.push_back(line);
                continue;
            }
            if (is_counted_header(fields)) {
                own_names_ = counted_names(fields);
                head_.counted = true;
                continue;
            }
            text_ = before;
            read_rows();
            return std::move(head_);
        }
        throw Error("no particles");
    }

  private:
    bool is_count(const Fields& fields) const {
        return !head_.count && filled(fields) == 1 && is_whole(fields.front());
    }
    /// Whether a line counts columns that have no names: one with an index, or above numbers that are not all whole.
    bool is_counted_header(const Fields& fields) const {
        if (!own_names_.empty() || counted_names(fields).empty()) return false;
        std::string_view rest = text_;
        const Fields next =
            split_fields(trimmed(take_line(rest), head_.separator), head_.separator);
        return next.size() == fields.size() &&
               (fields.front().empty() || !std::ranges::all_of(next, is_whole));
    }
    /// Whether a line below the names is a particle without a position: NA or the like, no word that may be a unit, or one without the others.
    bool lacks_position(const Fields& fields) const {
        for (const auto* lines : {&headers_, &comments_})
            for (const std::string_view line : *lines) {
                const Fields names = header_fields(line, head_.separator);
                if (!names_position(names)) continue;
                std::size_t empty = 0;
                for (const std::size_t n : position_columns({names.begin(), names.end()}))
                    if (n >= fields.size() || fields[n].empty())
                        ++empty;
                    else if (is_missing(fields[n]) || !may_be_unit(fields[n]))
                        return true;
                if (empty == 1 || empty == 2) return true;
            }
        return false;
    }
    /// "kpc", "[10^3 km]" or "µm", but not a number written otherwise, such as "$1", "1'000", "***" or "−1.5" with a long minus.
    static bool may_be_unit(std::string_view field) {
        constexpr std::string_view kDigits = "0123456789";
        if (std::string_view("[(").find(field.front()) != field.npos) return true;
        const bool begins = (field.front() | 0x20) >= 'a' && (field.front() | 0x20) <= 'z';
        return begins || (static_cast<unsigned char>(field.front()) >= 0x80 &&
                          field.find_first_of(kDigits) == field.npos);
    }
    static bool is_header(const Fields& fields) {
        if (names_position(fields)) return true;
        if (std::ranges::any_of(fields, is_number)) return false;
        for (const std::string_view field : fields)
            if (has_decimal_comma(field))
                throw Error(
                    fmt::format("got '{}', a decimal comma; expected decimal points", field));
        return true;
    }
    void read_count(std::string_view digits) {
        std::uint64_t count = 0;
        if (std::from_chars(digits.data(), digits.data() + digits.size(), count).ec != std::errc{})
            throw Error(fmt::format("{} particles, expected fewer", digits));
        head_.count = count;
        head_.count_line = head_.line;
        if (!xyz_ || !headers_.empty()) return;
        // The title may be empty, prose, names of columns, or look like a particle.
        std::string_view rest = text_;
        const std::string_view title = trimmed(take_line(rest));
        const Fields fields = split_fields(title, head_.separator);
        if (!is_comment_or_empty(title) && !is_header(fields) && like_next(fields, rest)) {
            // Of words and numbers, it is the title where one line more than the count follows.
            head_.may_be_title = !std::ranges::all_of(fields, is_number);
            if (!head_.may_be_title || !title_) return;
        }
        head_.titled = true;
        own_names_ = extended_names(title);
        comments_.push_back(without_mark(title));
        text_ = rest;
        ++head_.line;
    }
    /// Whether the fields of a line are numbers and words as those of the next particle are. Without one, whether they are numbers.
    bool like_next(const Fields& fields, std::string_view rest) const {
        while (!rest.empty()) {
            const std::string_view line = trimmed(take_line(rest), head_.separator);
            if (is_comment_or_empty(line, head_.separator)) continue;
            const Fields next = split_fields(line, head_.separator);
            return std::ranges::equal(fields, next, {}, is_number, is_number);
        }
        return fields.size() >= 3 && std::ranges::all_of(fields, is_number);
    }
    void read_rows() {
        std::vector<Fields> rows;
        const std::size_t sample = std::min<std::uint64_t>(kSample, head_.count.value_or(kSample));
        for (std::string_view rest = text_;
             !rest.empty() && rows.size() < std::max<std::size_t>(sample, 1);) {
            const std::string_view line = trimmed(take_line(rest), head_.separator);
            if (is_comment_or_empty(line, head_.separator)) continue;
            rows.push_back(split_fields(line, head_.separator));
        }
        // Fields of the first line, with empty ones at its end, and those that some line fills.
        const std::size_t most = rows.empty() ? 0 : rows.front().size();
        std::size_t held = 0;
        for (const Fields& fields : rows) held = std::max(held, std::min(most, filled(fields)));
        std::size_t columns = held;
        // The header decides whether empty fields at the ends of lines are columns.
        const auto take = [&](const Fields& fields) {
            if (fields.size() < held || filled(fields) > most || fields.empty()) return false;
            columns = std::max(filled(fields), held);
            head_.names = names_of({fields.begin(), fields.begin() + std::ptrdiff_t(columns)});
            return true;
        };
        name_columns(take, held);
        find_units();
        for (const Fields& fields : rows) {
            Names row(fields.begin(), fields.end());
            row.resize(columns);
            head_.rows.push_back(std::move(row));
        }
    }
    /// Chooses the line that names the columns: one with x, y and z first, of headers the first, of comments the last.
    template <class Take>
    void name_columns(const Take& take, std::size_t columns) {
        if (!own_names_.empty()) {
            if (own_names_.size() == columns)
                head_.names = own_names_;
            else
                head_.misfit = fmt::format("Properties names {} columns", own_names_.size());
            return;
        }
        std::vector<std::string_view> lines = headers_;
        lines.insert(lines.end(), comments_.rbegin(), comments_.rend());
        for (const bool with_position : {true, false}) {
            if (!head_.misfit.empty()) return;
            for (const std::string_view line : lines) {
                const Fields fields = header_fields(line, head_.separator);
                if (names_position(fields) != with_position) continue;
                if (!with_position && std::ranges::any_of(fields, is_number)) continue;
                if (take(fields)) {
                    head_.misfit.clear();
                    return;
                }
                if (with_position && head_.misfit.empty())
                    head_.misfit = fmt::format("a header of {} names", fields.size());
            }
        }
    }

    /// Units of the columns: those of ECSV, or a line of words below the names.
    void find_units() {
        head_.units = ecsv_units(comments_, head_.names);
        for (const std::string_view line : headers_) {
            const Fields fields = split_fields(line, head_.separator);
            if (fields.size() == head_.units.size() && !names_position(fields))
                head_.units.assign(fields.begin(), fields.end());
        }
    }

    std::string_view text_;
    bool xyz_, title_;
    PointHead head_;
    std::vector<std::string_view> headers_, comments_;
    Names own_names_;  ///< of extended XYZ or of counted columns; empty: none
};

}  // namespace

PointHead read_head(std::string_view text, char own, bool xyz, bool title) {
    return HeadReader(text, find_separator(text, own), xyz, title).read();
}

}  // namespace vog::point_files
