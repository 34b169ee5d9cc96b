// request_json.cpp: requests from and to JSON, and members from words of a command line.
#include <charconv>

#include "core/json_fault.h"
#include "render/picture/request/request_member.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/text.h"

namespace vog {

namespace requests {

void refuse(const std::string& key, const Json& value, const std::string& expected) {
    const bool plain = value.is_array() && std::ranges::none_of(value, &Json::is_structured);
    std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
    if (plain)  // as a command line has it
        std::erase_if(shown, [](char c) { return c == '[' || c == ']' || c == '"'; });
    throw RequestError(key, fmt::format(" {}: expected {}", printable(shown, 60), expected));
}

double number(const std::string& key, const Json& value, const std::string& expected) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(key, value, expected);
    return value.get<double>();
}

std::vector<double> row(const std::string& key, const Json& value, std::size_t count,
                        const std::string& expected) {
    if (!value.is_array() || value.size() != count) refuse(key, value, expected);
    std::vector<double> numbers;
    for (const Json& one : value) {
        if (!one.is_number() || !std::isfinite(one.get<double>())) refuse(key, value, expected);
        numbers.push_back(one);
    }
    return numbers;
}

namespace {

/// Sets one member; errors of types become RequestErrors.
void read(const Entry& entry, const Json& value, PictureRequest& request) {
    static const PictureRequest unset;
    try {
        entry.values.read(entry.schema.key, value.is_null() ? entry.values.write(unset) : value,
                          request);
    } catch (const nlohmann::json::exception&) {
        refuse(entry.schema.key, value, "another type");
    }
}

/// A number, or the text itself.
Json word_value(const std::string& text) {
    const char* end = text.data() + text.size();
    const char* begin = text.starts_with('+') ? text.data() + 1 : text.data();
    double number = 0;
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error != std::errc{} || rest != end || !std::isfinite(number)) return text;
    const bool whole = number == std::floor(number) && std::abs(number) < 1e15;
    return whole ? Json(static_cast<std::int64_t>(number)) : Json(number);
}

}  // namespace

Json words_value(const std::string& text) {
    if (text.find(',') == text.npos) return word_value(text);
    Json parts = Json::array();
    for (std::size_t at = 0, comma = 0; comma != text.npos; at = comma + 1) {
        comma = text.find(',', at);
        parts.push_back(word_value(text.substr(at, comma - at)));
    }
    return parts;
}

}  // namespace requests

std::string request_json(const PictureRequest& request) {
    static const PictureRequest unset;
    requests::Json json = requests::Json::object();
    for (const auto& [schema, values] : requests::entries()) {
        requests::Json value = values.write(request);
        if (value != values.write(unset)) json[schema.key] = std::move(value);
    }
    return json.dump(-1, ' ', false, requests::Json::error_handler_t::replace);
}

PictureRequest request_of_json(const std::string& text, const PictureRequest& base) {
    PictureRequest request = base;
    requests::Json json;
    try {
        json = requests::Json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw Error("request: " + json_fault(error));
    }
    if (!json.is_object()) throw Error("request: expected a JSON object");
    for (const auto& [key, value] : json.items())
        requests::read(requests::entry_of(key), value, request);
    for (const char* term : {"shadows", "ambient_occlusion"})
        if (request.look.studio && json.contains(term) && json[term] == false)
            throw RequestError(term,
                               " false: `light` studio has it; state `light` head or a direction, "
                               "and what else you want");
    return request;
}

void set_member(PictureRequest& request, const std::string& key,
                const std::vector<std::string>& words) {
    using requests::Json;
    const requests::Entry& entry = requests::entry_of(key);
    if (key == "tf") {
        request.transfer.points = transfer_points(words.back());
    } else if (key == "layers") {
        request.layers.clear();
        for (const std::string& word : words)
            request.layers.push_back(requests::layer_of_words(word));
    } else if (entry.schema.many) {
        Json rows = Json::array();
        for (const std::string& word : words) rows.push_back(requests::words_value(word));
        requests::read(entry, rows, request);
    } else if (entry.schema.takes.empty() && entry.schema.choices.empty()) {
        requests::read(entry, words.back() == "true", request);
    } else {
        const std::string& word = words.back();
        requests::read(entry, entry.schema.verbatim ? Json(word) : requests::words_value(word),
                       request);
    }
}

}  // namespace vog
