// usda_read.cpp: prims of an OpenUSD layer as text; values other than those of splats are skipped.
// Source: openusd.org, "USDA file format".
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <system_error>

#include "io/exchange/usd/usd_prims.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::exchange::usd {

namespace {

class Parser {
  public:
    Parser(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

    std::vector<Prim> prims() {
        skip_line();  // #usda 1.0
        skip_blanks(true);
        if (peek() == '(') skip_metadata();
        read_body(-1, 0);
        return std::move(prims_);
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        const auto line = 1 + std::count(text_.begin(), text_.begin() + std::ptrdiff_t(at_), '\n');
        throw Error(fmt::format("{}: line {}: {}", file_, line, what));
    }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    bool at_end() const { return at_ >= text_.size(); }
    bool take(char one) {
        if (at_end() || text_[at_] != one) return false;
        ++at_;
        return true;
    }
    void expect(char one) {
        if (!take(one))
            fail(at_end()
                     ? fmt::format("truncated, expected '{}'", one)
                     : fmt::format("'{}', expected '{}'", printable(text_.substr(at_, 1)), one));
    }
    void skip_line() { at_ = std::min(text_.find_first_of("\n\r", at_), text_.size()); }
    void skip_blanks(bool lines) {
        for (; !at_end(); ++at_) {
            const char c = text_[at_];
            if (c == '#') {
                skip_line();
                if (!lines || at_end()) return;
            } else if (c != ' ' && c != '\t' && c != '\r' && !(lines && (c == '\n' || c == ';'))) {
                return;
            }
        }
    }
    /// Names, types and keywords: all up to a blank, a bracket or a sign.
    std::string_view word() {
        const std::size_t end = text_.find_first_of(" \t\r\n=(){}\"';,#<@", at_);
        const std::string_view found = text_.substr(at_, end - at_);
        at_ += found.size();
        return found;
    }
    /// The content of a string in one or three quotation marks of either kind.
    std::string_view quoted() {
        const char mark = peek();
        const std::string three(3, mark);
        const std::string_view end = text_.substr(at_).starts_with(three)
                                         ? std::string_view(three)
                                         : std::string_view(three).substr(0, 1);
        const std::size_t begin = at_ += end.size();
        while (!at_end() && !text_.substr(at_).starts_with(end)) at_ += peek() == '\\' ? 2 : 1;
        at_ = std::min(at_, text_.size());
        if (at_end()) fail("truncated in a string");
        const std::string_view content = text_.substr(begin, at_ - begin);
        at_ += end.size();
        return content;
    }
    void skip_to(std::string_view end) {
        const std::size_t found = text_.find(end, at_ + end.size());
        if (found == std::string_view::npos) fail(fmt::format("truncated, expected '{}'", end));
        at_ = found + end.size();
    }
    /// A string, an asset, a path, or one character.
    void skip_item() {
        const char c = peek();
        if (c == '"' || c == '\'')
            quoted();
        else if (c == '@')
            skip_to(text_.substr(at_).starts_with("@@@") ? "@@@" : "@");
        else if (c == '<')
            skip_to(">");
        else if (c == '#')
            skip_line();
        else
            ++at_;
    }
    /// Brackets to their ends, a string, an asset, a path, or a word.
    void skip_value() {
        constexpr std::string_view kOpen = "([{", kClose = ")]}", kItems = "\"'@<";
        skip_blanks(true);
        if (kItems.find(peek()) != std::string_view::npos && !at_end()) return skip_item();
        if (kOpen.find(peek()) == std::string_view::npos || at_end()) {
            word();
            return;
        }
        std::size_t depth = 0;
        do {
            if (at_end()) fail("truncated in a value");
            if (kOpen.find(peek()) != std::string_view::npos) ++depth;
            if (kClose.find(peek()) != std::string_view::npos) --depth;
            skip_item();
        } while (depth > 0);
    }
    /// Metadata in parentheses; whether they do not say `active = false`.
    bool skip_metadata() {
        bool active = true;
        std::string_view name;
        for (expect('(');;) {
            skip_blanks(true);
            if (at_end()) fail("truncated in metadata");
            if (take(')')) return active;
            if (take('=')) {
                skip_blanks(true);
                const std::size_t begin = at_;
                skip_value();
                const std::string_view value = text_.substr(begin, at_ - begin);
                if (name == "active" && (value == "false" || value == "0")) active = false;
            } else if (const std::string_view found = word(); !found.empty()) {
                name = found;
            } else {
                const std::size_t begin = at_;
                skip_value();
                if (at_ == begin) ++at_;
            }
        }
    }
    float number() {
        skip_blanks(true);
        float value = 0;
        const auto [end, error] =
            std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
        if (error == std::errc::result_out_of_range) fail("a number beyond floats");
        if (error != std::errc{}) fail("expected a number");
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }
    /// `[1, 2]`, or `[(1, 2, 3), (4, 5, 6)]`; None is empty.
    std::vector<float> numbers(std::size_t components) {
        std::vector<float> out;
        skip_blanks(true);
        if (text_.substr(at_).starts_with("None")) {
            word();
            return out;
        }
        for (expect('[');;) {
            skip_blanks(true);
            if (take(']')) return out;
            if (components > 1) expect('(');
            for (std::size_t k = 0; k < components; ++k) {
                if (k > 0) expect(',');
                out.push_back(number());
                skip_blanks(true);
            }
            if (components > 1) expect(')');
            skip_blanks(true);
            if (!take(',') && peek() != ']') fail("expected ',' or ']'");
        }
    }
    void read_prim(bool defined, std::ptrdiff_t parent, int above) {
        constexpr int kMostAbove = 64;
        if (above == kMostAbove) fail(fmt::format("a prim below {} others", kMostAbove));
        skip_blanks(true);
        Prim prim;
        prim.parent = parent;
        prim.splats = word() == kSplatType;
        prim.absent = !defined;
        skip_blanks(true);
        if (peek() != '"' && peek() != '\'') fail("expected the name of a prim");
        prim.name = std::string(quoted());
        skip_blanks(true);
        if (peek() == '(') prim.absent |= !skip_metadata();
        skip_blanks(true);
        expect('{');
        prims_.push_back(std::move(prim));
        read_body(static_cast<std::ptrdiff_t>(prims_.size()) - 1, above + 1);
    }
    void read_body(std::ptrdiff_t own, int above) {
        for (;;) {
            skip_blanks(true);
            if (at_end() && above == 0) return;
            if (at_end()) fail("truncated, expected '}'");
            if (above > 0 && take('}')) return;
            const std::size_t begin = at_;
            const std::string_view first = word();
            if (first == "def" || first == "over" || first == "class")
                read_prim(first == "def", own, above);
            else
                read_property(own, first);
            if (at_ == begin) fail(fmt::format("'{}'", printable(text_.substr(at_, 1))));
        }
    }
    /// `TYPE NAME = VALUE (METADATA)`, of which all but a name may be absent.
    void read_property(std::ptrdiff_t own, std::string_view name) {
        for (;;) {
            skip_blanks(false);
            if (peek() == '"' || peek() == '\'') {
                quoted();
                continue;
            }
            const std::string_view found = word();
            if (found.empty()) break;
            name = found;
        }
        if (take('=')) read_value(own, name);
        skip_blanks(false);
        if (peek() == '(') skip_metadata();
    }
    void read_value(std::ptrdiff_t own, std::string_view name) {
        constexpr std::string_view kSamples = ".timeSamples";
        const bool sampled = name.ends_with(kSamples);
        if (sampled) name.remove_suffix(kSamples.size());
        const auto attribute = attribute_named(name);
        Prim* prim = own < 0 ? nullptr : &prims_[static_cast<std::size_t>(own)];
        if (prim && name == "xformOpOrder") {
            skip_blanks(true);
            const std::size_t begin = at_;
            skip_value();
            prim->moved |= text_.substr(begin, at_ - begin).find('"') != std::string_view::npos;
        } else if (prim && prim->splats && attribute && !sampled) {
            set_numbers(*prim, *attribute, numbers(kComponents[attribute->index]));
        } else if (prim && name == kFrameAttribute) {
            skip_blanks(true);
            if (peek() != '"') fail(fmt::format("expected {} in quotation marks", kFrameAttribute));
            prim->frame = quoted();
        } else {
            if (prim && attribute && sampled) prim->sampled = kAttributes[attribute->index];
            skip_value();
        }
    }

    std::string_view text_;
    std::string file_;
    std::size_t at_ = 0;
    std::vector<Prim> prims_;
};

}  // namespace

std::vector<Prim> read_text(FileBytes& in, const std::string& file) {
    const BigVector<char> bytes = in.range(0, in.size());
    return Parser({bytes.data(), bytes.size()}, file).prims();
}

}  // namespace vog::exchange::usd
