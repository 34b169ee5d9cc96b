// ply_fields.cpp: the comment lines that describe fields, and the properties they ask for.
#include "io/ply/ply_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "data/fields/field_arrays.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::ply {

namespace {

constexpr const char *kKey = "field ", *kSpread = "spread ", *kBackground = "background ";

/// A comment line about a field, word by word.
class FieldLine {
  public:
    FieldLine(const std::filesystem::path& file, const std::string& text)
        : file_(file), text_(text), words_(text.substr(text.find(' '))) {}

    std::string word() {
        std::string next;
        words_ >> next;
        return next;
    }
    double number() {
        const std::string digits = word();
        const char* end = digits.data() + digits.size();
        double value = 0;
        const auto [stop, code] = std::from_chars(digits.data(), end, value);
        if (digits.empty() || code != std::errc{} || stop != end) refuse();
        return value;
    }
    /// The text that percent_escaped() wrote; empty at the end of the line.
    std::string text() {
        const std::string safe = word();
        std::string plain;
        for (std::size_t n = 0; n < safe.size(); ++n) {
            if (safe[n] != '%') {
                plain += safe[n];
                continue;
            }
            unsigned byte = 0;
            const char* first = safe.data() + n + 1;
            if (n + 2 >= safe.size() ||
                std::from_chars(first, first + 2, byte, 16).ptr != first + 2)
                refuse();
            plain += static_cast<char>(byte);
            n += 2;
        }
        // One spelling a name: properties are compared with percent_escaped().
        if (percent_escaped(plain) != safe) refuse();
        return plain;
    }
    [[noreturn]] void refuse() const {
        fail(file_, fmt::format("comment '{}': expected 'field', 'scalar', 'measure' or 'vector', "
                                "a name, its range as two numbers, and its unit or nothing",
                                printable(text_, 200)));
    }

  private:
    const std::filesystem::path& file_;
    const std::string& text_;
    std::istringstream words_;
};

template <class Field>
Field field_of(FieldLine& line) {
    Field field;
    field.name = line.text();
    field.lower = line.number();
    field.upper = line.number();
    field.unit = line.text();
    if (!line.word().empty()) line.refuse();
    return field;
}

template <class Field>
std::string comment_of(const char* kind, const Field& field) {
    return fmt::format("comment {}{} {} {} {}{}{}\n", kKey, kind, percent_escaped(field.name),
                       field.lower, field.upper, field.unit.empty() ? "" : " ",
                       percent_escaped(field.unit));
}

/// Sets the spread or the background of a field that an earlier line describes.
void take_numbers(const std::filesystem::path& file, const std::string& text, Fields& fields) {
    FieldLine line(file, text);
    const std::string name = line.text();
    const auto field = std::ranges::find(fields.scalar, name, &ScalarField::name);
    if (field == fields.scalar.end()) line.refuse();
    if (text.starts_with(kBackground))
        field->background = line.number();
    else
        field->spread = {line.number(), line.number(), line.number(), true};
}

}  // namespace

std::string field_comments(const Fields& fields) {
    std::string text;
    for (const ScalarField& field : fields.scalar)
        text += comment_of(field.is_measure ? "measure" : "scalar", field);
    for (const ScalarField& field : fields.scalar)
        if (const ValueSpread& s = field.spread; s.known)
            text += fmt::format("comment {}{} {} {} {}\n", kSpread, percent_escaped(field.name),
                                s.low, s.middle, s.high);
    for (const ScalarField& field : fields.scalar)
        if (field.background != 0)
            text += fmt::format("comment {}{} {}\n", kBackground, percent_escaped(field.name),
                                field.background);
    for (const VectorField& field : fields.vector) text += comment_of("vector", field);
    return text;
}

Fields described_fields(const std::filesystem::path& file, const Header& header) {
    Fields fields;
    for (const std::string& text : header.comments) {
        if (text.starts_with(kSpread) || text.starts_with(kBackground))
            take_numbers(file, text, fields);
        if (!text.starts_with(kKey)) continue;
        FieldLine line(file, text);
        const std::string kind = line.word();
        if (kind == "scalar" || kind == "measure")
            fields.scalar.emplace_back(field_of<ScalarField>(line)).is_measure = kind == "measure";
        else if (kind == "vector")
            fields.vector.push_back(field_of<VectorField>(line));
        else
            line.refuse();
    }
    try {
        check_descriptions(fields);
    } catch (const Error& error) {
        fail(file, error.what());
    }
    return fields;
}

void require_columns(const std::filesystem::path& file, const Header& header,
                     const Fields& fields) {
    const auto require = [&](const auto& field) {
        for (const std::string& name : column_names(field))
            if (std::ranges::find(header.properties, name) == header.properties.end())
                fail(file, fmt::format("no property '{}', expected those of field '{}': {} in all",
                                       name, field.name, column_names(field).size()));
    };
    std::ranges::for_each(fields.scalar, require);
    std::ranges::for_each(fields.vector, require);
}

}  // namespace vog::ply
