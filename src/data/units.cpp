// units.cpp: names of units, and products of them.
#include "vog/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "vog/error.h"

namespace vog {

const LengthUnit* length_unit(const std::string& name) {
    // The units of OME's schema, of FITS, and names that programs write.
    static const std::map<std::string, LengthUnit> kUnits{{"Ym", {1, 24}},
                                                          {"Zm", {1, 21}},
                                                          {"Em", {1, 18}},
                                                          {"Pm", {1, 15}},
                                                          {"Tm", {1, 12}},
                                                          {"Gm", {1, 9}},
                                                          {"Mm", {1, 6}},
                                                          {"km", {1, 3}},
                                                          {"hm", {1, 2}},
                                                          {"dam", {1, 1}},
                                                          {"m", {1, 0}},
                                                          {"dm", {1, -1}},
                                                          {"cm", {1, -2}},
                                                          {"mm", {1, -3}},
                                                          {"um", {1, -6}},
                                                          {"nm", {1, -9}},
                                                          {"pm", {1, -12}},
                                                          {"fm", {1, -15}},
                                                          {"am", {1, -18}},
                                                          {"zm", {1, -21}},
                                                          {"ym", {1, -24}},
                                                          {"Angstrom", {1, -10}},
                                                          {"thou", {2.54, -5}},
                                                          {"li", {2.54 / 12, -2}},
                                                          {"in", {2.54, -2}},
                                                          {"ft", {3.048, -1}},
                                                          {"yd", {9.144, -1}},
                                                          {"mi", {1.609344, 3}},
                                                          {"au", {1.495978707, 11}},
                                                          {"ly", {9.4607304725808, 15}},
                                                          {"pc", {3.0856775814913673, 16}},
                                                          {"kpc", {3.0856775814913673, 19}},
                                                          {"Mpc", {3.0856775814913673, 22}},
                                                          {"Gpc", {3.0856775814913673, 25}},
                                                          {"pt", {2.54 / 72, -2}},
                                                          {"solRad", {6.957, 8}}};
    const auto at = kUnits.find(name);
    return at == kUnits.end() ? nullptr : &at->second;
}

std::string length_unit_name(const std::string& unit) {
    static const std::map<std::string, std::string> kOther{{"\xc2\xb5m", "um"},
                                                           {"\xce\xbcm", "um"},
                                                           {"\xb5m", "um"},
                                                           {"\\u00B5m", "um"},
                                                           {"micron", "um"},
                                                           {"microns", "um"},
                                                           {"micrometer", "um"},
                                                           {"micrometre", "um"},
                                                           {"\xc3\x85", "Angstrom"},
                                                           {"\xe2\x84\xab", "Angstrom"},
                                                           {"\xc5", "Angstrom"},
                                                           {"\\u00C5", "Angstrom"},
                                                           {"angstrom", "Angstrom"},
                                                           {"nanometer", "nm"},
                                                           {"millimeter", "mm"},
                                                           {"centimeter", "cm"},
                                                           {"meter", "m"},
                                                           {"inch", "in"},
                                                           {"ua", "au"},
                                                           {"AU", "au"},
                                                           {"lyr", "ly"}};
    const auto at = kOther.find(unit);
    return at == kOther.end() ? unit : at->second;
}

namespace {

/// A product of powers of dimensions: "m", "kg", "s", or names that are not known.
struct Product {
    double factor = 1;
    std::map<std::string, int> power;

    void multiply(const Product& other, int exponent) {
        factor *= std::pow(other.factor, exponent);
        for (const auto& [name, n] : other.power)
            if ((power[name] += n * exponent) == 0) power.erase(name);
    }
};

Product unit_named(const std::string& name) {
    static const std::map<std::string, Product> kUnits{
        {"g", {1e-3, {{"kg", 1}}}},
        {"kg", {1, {{"kg", 1}}}},
        {"mg", {1e-6, {{"kg", 1}}}},
        {"Msun", {1.98841e30, {{"kg", 1}}}},
        {"solMass", {1.98841e30, {{"kg", 1}}}},
        {"s", {1, {{"s", 1}}}},
        {"ms", {1e-3, {{"s", 1}}}},
        {"min", {60, {{"s", 1}}}},
        {"h", {3600, {{"s", 1}}}},
        {"yr", {3.15576e7, {{"s", 1}}}},
        {"Myr", {3.15576e13, {{"s", 1}}}},
        {"Gyr", {3.15576e16, {{"s", 1}}}},
        {"J", {1, {{"kg", 1}, {"m", 2}, {"s", -2}}}},
        {"erg", {1e-7, {{"kg", 1}, {"m", 2}, {"s", -2}}}},
        {"mK", {1e-3, {{"K", 1}}}},
        {"Jy", {1e-26, {{"kg", 1}, {"s", -2}}}},
        {"mJy", {1e-29, {{"kg", 1}, {"s", -2}}}},
    };
    if (const LengthUnit* length = length_unit(name == "AU" ? "au" : name == "lyr" ? "ly" : name))
        return {length->power < 0 ? length->number / std::pow(10.0, -length->power)
                                  : length->number * std::pow(10.0, length->power),
                {{"m", 1}}};
    const auto known = kUnits.find(name);
    return known == kUnits.end() ? Product{1, {{name, 1}}} : known->second;
}

/// Text with exponents as digits in place of superscripts.
std::string plain(std::string text) {
    for (const auto& [super, digit] : {std::pair{"\xc2\xb9", "1"},
                                       {"\xc2\xb2", "2"},
                                       {"\xc2\xb3", "3"},
                                       {"\xe2\x81\xbb", "-"},
                                       {"\xc2\xb7", " "},
                                       {"**", "^"}})
        for (std::size_t at; (at = text.find(super)) != text.npos;)
            text.replace(at, std::string_view(super).size(), digit);
    return text;
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%' || (c & 0x80);
}

/// A product of names as a text has them, in its order.
struct Names {
    double number = 1;
    std::vector<std::pair<std::string, int>> power;

    void multiply(const std::string& name, int exponent) {
        const auto at = std::ranges::find(power, name, &std::pair<std::string, int>::first);
        if (at == power.end())
            power.emplace_back(name, exponent);
        else if ((at->second += exponent) == 0)
            power.erase(at);
    }
};

std::optional<Names> names_in(const std::string& given) {
    const std::string text = plain(given);
    Names all;
    int sign = 1;
    std::size_t at = 0;
    while (at < text.size()) {
        const char c = text[at];
        if (c == ' ' || c == '*' || c == '.' || c == '/') {
            if (c == '/') sign = -1;
            ++at;
            continue;
        }
        if (double number = 0; c >= '0' && c <= '9') {
            const auto [stop, code] =
                std::from_chars(text.data() + at, text.data() + text.size(), number);
            if (code != std::errc{} || !(number > 0)) return {};
            all.number *= std::pow(number, sign);
            sign = 1;
            at = static_cast<std::size_t>(stop - text.data());
            continue;
        }
        std::size_t end = at;
        while (end < text.size() && is_letter(text[end])) ++end;
        if (end == at) return {};
        const std::string name = text.substr(at, end - at);
        at = end;
        if (at < text.size() && text[at] == '^') ++at;
        if (at < text.size() && text[at] == '+') ++at;
        int exponent = 1;
        const auto [stop, code] =
            std::from_chars(text.data() + at, text.data() + text.size(), exponent);
        if (code == std::errc{}) at = static_cast<std::size_t>(stop - text.data());
        if (std::abs(exponent) > 9) return {};
        all.multiply(name, sign * exponent);
        sign = 1;
    }
    return all;
}

std::optional<Product> parsed(const std::string& text) {
    const std::optional<Names> names = names_in(text);
    if (!names) return {};
    Product all{names->number, {}};
    for (const auto& [name, exponent] : names->power) all.multiply(unit_named(name), exponent);
    if (all.power.empty()) return {};
    return all;
}

}  // namespace

std::optional<double> unit_factor(const std::string& from, const std::string& to) {
    if (from == to) return 1;
    const std::optional<Product> a = parsed(from), b = parsed(to);
    if (!a || !b || a->power != b->power) return {};
    return a->factor / b->factor;
}

void require_same_length(const std::string& unit, const std::string& where,
                         const std::string& expected, const std::string& of) {
    if (unit.empty() || expected.empty()) return;
    if (unit_factor(length_unit_name(unit), length_unit_name(expected)) != 1)
        throw Error(
            fmt::format("{}: lengths in '{}', expected '{}' as in {}", where, unit, expected, of));
}

std::string unit_product(const std::string& a, const std::string& b, int power) {
    if (a.empty() || b.empty()) return {};
    std::optional<Names> all = names_in(a);
    const std::optional<Names> more = names_in(b);
    if (!all || !more) return power == 1 ? a + " " + b : "";
    all->number *= std::pow(more->number, power);
    for (const auto& [name, exponent] : more->power) all->multiply(name, power * exponent);
    std::string text;
    if (all->number != 1) text = fmt::format("{:.7g}", all->number);
    for (const auto& [name, exponent] : all->power) {
        const char* before = exponent < 0 ? "/" : text.empty() ? "" : " ";
        text = fmt::format("{}{}{}", exponent < 0 && text.empty() ? "1" : text, before, name);
        if (std::abs(exponent) != 1) text += fmt::format("{}", std::abs(exponent));
    }
    return text;
}

}  // namespace vog
