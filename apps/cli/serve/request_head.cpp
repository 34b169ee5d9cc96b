// request_head.cpp: parsing of request lines, fields, hosts and ranges.
#include "serve/request_head.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace vog::cli {

namespace {

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// Letters of methods and of names of fields (RFC 9110, token).
bool is_token(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](char letter) {
        return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
               is_digit(letter) ||
               std::string_view("!#$%&'*+-.^_`|~").find(letter) != std::string_view::npos;
    });
}

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& letter : result)
        if (letter >= 'A' && letter <= 'Z') letter = char(letter - 'A' + 'a');
    return result;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == text.npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

RequestHead refused(int status, std::string reason) {
    RequestHead head;
    head.status = status;
    head.reason = std::move(reason);
    head.keeps_open = false;
    return head;
}

/// Method, path and version: "GET /chunks/0a.vogz HTTP/1.1".
RequestHead parse_request_line(std::string_view line) {
    if (line.size() > kLargestRequestLine) return refused(414, "the address is too long");
    const std::size_t first = line.find(' '), last = line.rfind(' ');
    if (first == line.npos || first == last || line.find(' ', first + 1) != last)
        return refused(400, "expected a method, a path and a version");
    const std::string_view method = line.substr(0, first);
    const std::string_view target = line.substr(first + 1, last - first - 1);
    const std::string_view version = line.substr(last + 1);
    if (!is_token(method)) return refused(400, "expected a method, a path and a version");
    if (version != "HTTP/1.1" && version != "HTTP/1.0")
        return refused(version.starts_with("HTTP/") ? 505 : 400, "expected HTTP/1.1");
    const bool plain = std::ranges::all_of(
        target, [](char letter) { return letter > ' ' && letter < 0x7f && letter != '#'; });
    if (!plain || !target.starts_with('/'))
        return refused(400, "expected a path that begins with /, in ASCII");
    RequestHead head;
    head.method = method;
    head.path = target.substr(0, target.find('?'));
    head.keeps_open = version == "HTTP/1.1";
    return head;
}

/// Adds a field, "Name: value"; a refusal replaces the head.
void add_field(RequestHead& head, std::string_view line) {
    const std::size_t colon = line.find(':');
    // A line that begins with a space goes on with the field before it: obsolete, and a way to hide fields.
    if (colon == line.npos || !is_token(line.substr(0, colon))) {
        head = refused(400, "a field is malformed");
        return;
    }
    const std::string name = lower(line.substr(0, colon));
    const std::string_view value = trimmed(line.substr(colon + 1));
    const auto [field, added] = head.fields.try_emplace(name, value);
    if (added) return;
    if (name == "host")
        head = refused(400, "two Host fields");
    else
        field->second.append(", ").append(value);
}

/// Refusal of what no request here has: a body, another method.
void check_content(RequestHead& head, bool preflight) {
    const bool reads = head.method == "GET" || head.method == "HEAD";
    if (!reads && !(preflight && head.method == "OPTIONS"))
        head = refused(405, "expected GET or HEAD");
    else if (head.fields.contains("transfer-encoding"))
        head = refused(413, "expected no body");
    else if (const auto length = head.fields.find("content-length");
             length != head.fields.end() && length->second != "0")
        head = refused(413, "expected no body");
    else if (!head.fields.contains("host"))
        head = refused(400, "expected a Host field");
}

/// Decimal number of at most 18 digits, which fit; none: anything else.
std::optional<std::uint64_t> number_of(std::string_view text) {
    if (text.empty() || text.size() > 18 || !std::ranges::all_of(text, is_digit)) return {};
    std::uint64_t value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

}  // namespace

std::size_t head_size(std::string_view received) {
    // An empty line of LF alone ends the head, too: the parser then refuses it at once.
    const std::size_t strict = received.find("\n\r\n"), loose = received.find("\n\n");
    if (loose < strict) return loose + 2;
    return strict == received.npos ? 0 : strict + 3;
}

RequestHead parse_request_head(std::string_view text, bool preflight) {
    if (text.size() > kLargestRequestHead) return refused(431, "the fields are too large");
    RequestHead head;
    std::size_t lines = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        if (end == text.npos || end == 0 || text[end - 1] != '\r')
            return refused(400, "expected lines that end in CR LF");
        const std::string_view line = text.substr(0, end - 1);
        text.remove_prefix(end + 1);
        if (line.empty()) break;
        // Bytes from 0x80 on are negative characters, and allowed in values.
        if (std::ranges::any_of(line, [](char letter) {
                return (letter >= 0 && letter < ' ' && letter != '\t') || letter == 0x7f;
            }))
            return refused(400, "a control character");
        if (lines++ == 0)
            head = parse_request_line(line);
        else if (lines > kMostFields + 1)
            return refused(431, "too many fields");
        else
            add_field(head, line);
        if (head.status != 200) return head;
    }
    if (lines == 0 || !text.empty()) return refused(400, "expected one request");
    check_content(head, preflight);
    if (const auto connection = head.fields.find("connection"); connection != head.fields.end())
        head.keeps_open =
            head.keeps_open && lower(connection->second).find("close") == std::string::npos;
    return head;
}

bool is_loopback_host(std::string_view field, std::string_view own) {
    const std::size_t end = field.starts_with('[') ? field.find(']') + 1 : field.find(':');
    const std::string name = lower(field.substr(0, end));
    const std::string_view rest = field.substr(std::min(name.size(), field.size()));
    const bool port = rest.empty() || (rest.size() <= 6 && rest.starts_with(':') &&
                                       std::ranges::all_of(rest.substr(1), is_digit));
    return port && !name.empty() &&
           (name == "localhost" || name == "127.0.0.1" || name == "[::1]" || name == lower(own));
}

RangeRequest requested_range(std::string_view field, std::uint64_t size) {
    using Kind = RangeRequest::Kind;
    constexpr std::string_view kUnit = "bytes=";
    if (!field.starts_with(kUnit)) return {};
    field.remove_prefix(kUnit.size());
    const std::size_t dash = field.find('-');
    if (dash == field.npos) return {};
    const auto first = number_of(field.substr(0, dash)), last = number_of(field.substr(dash + 1));
    if (dash == 0) {  // the last bytes
        if (!last) return {};
        const std::uint64_t count = std::min(*last, size);
        if (count == 0) return {Kind::beyond};
        return {Kind::part, size - count, count};
    }
    if (!first || (!last && dash + 1 != field.size()) || (last && *last < *first)) return {};
    if (*first >= size) return {Kind::beyond};
    return {Kind::part, *first, (last ? std::min(*last, size - 1) : size - 1) - *first + 1};
}

}  // namespace vog::cli
