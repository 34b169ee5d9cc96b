// picture_record.cpp: records of pictures as JSON, and in files of pictures.
#include "vog/picture_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "io/image/image_files.h"
#include "vog/error.h"
#include "vog/request_schema.h"
#include "vog/text.h"

namespace vog {

namespace {

using Json = nlohmann::ordered_json;

/// throws  vog::Error that names the version which wrote the request, whose words may be others
PictureRequest request_of(const std::string& json, const std::string& version) try {
    return request_of_json(json);
} catch (const Error& error) {
    if (version.empty()) throw;
    throw Error(fmt::format("{} (written by vog {})", error.what(), printable(version, 20)));
}

/// Text of a record beyond this is none.
constexpr std::size_t kMostBytes = std::size_t{1} << 20;

/// Words of links that are about a page, not its picture (src/web/page/link/link.js).
constexpr std::string_view kOfPage[] = {"embed",     "still", "half",     "logaxis",
                                        "subframes", "model", "level",    "error",
                                        "memory",    "most",  "exposure", "planes_off"};

/// Text of a word of an address: "%2C" a comma, "+" a space.
std::string decoded(const std::string& word) {
    std::string text;
    for (std::size_t n = 0; n < word.size(); ++n) {
        unsigned code = 0;
        const char* digits = word.data() + n + 1;
        const char* end = digits + std::min<std::size_t>(2, word.size() - n - 1);
        if (word[n] == '%' && std::from_chars(digits, end, code, 16).ptr == digits + 2) {
            text += static_cast<char>(code);
            n += 2;
        } else {
            text += word[n] == '+' ? ' ' : word[n];
        }
    }
    while (!text.empty() && std::string_view("\r\n").find(text.back()) != std::string_view::npos)
        text.pop_back();  // of a file
    return text;
}

/// JSON of a link's value, which may lack outer brackets or quotes; nothing is a member's default.
Json value_of(const std::string& key, const std::string& text) {
    const auto member = std::ranges::find(request_schema(), key, &RequestMember::key);
    if (member != request_schema().end() && member->verbatim) return text;
    if (text.empty()) return nullptr;
    for (const std::string& json : {text, "[" + text + "]"})
        if (Json value = Json::parse(json, nullptr, false); !value.is_discarded()) return value;
    return text;
}

}  // namespace

std::string record_json(const PictureRecord& record) {
    Json json = Json::object();
    if (!record.version.empty()) json["vog"] = record.version;
    json["inputs"] = record.inputs;
    if (!record.reading.empty()) json["reading"] = record.reading;
    json["picture"] = Json::parse(request_json(record.request));
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PictureRecord record_of_json(const std::string& text) try {
    const Json json = Json::parse(text);
    if (!json.is_object()) throw Error("no record of a picture, expected an object");
    PictureRecord record;
    if (!json.contains("picture")) {
        record.request = request_of(text, {});  // without a record around it, as of <vog-view>
        return record;
    }
    record.version = json.value("vog", "");
    for (const auto& [key, value] : json.items()) {
        if (key == "vog")
            continue;
        else if (key == "inputs")
            value.get_to(record.inputs);
        else if (key == "reading")
            value.get_to(record.reading);
        else if (key == "picture")
            record.request = request_of(value.dump(), record.version);
        else
            throw Error(fmt::format("unknown key '{}', expected vog, inputs, reading and picture",
                                    printable(key, 60)));
    }
    return record;
} catch (const nlohmann::json::exception& error) {
    throw Error("no record of a picture: " + json_fault(error));
}

PictureRecord record_of_link(const std::string& link) try {
    Json json = Json::object();
    bool has_words = false;
    for (std::size_t at = std::min(link.find('#'), link.size()); at < link.size();) {
        const std::size_t begin = at + 1;
        at = std::min(link.find('&', begin), link.size());
        const std::string word = link.substr(begin, at - begin);
        const std::size_t is = std::min(word.find('='), word.size());
        const std::string key = decoded(word.substr(0, is));
        has_words = has_words || !key.empty();
        const Json value =
            is == word.size() ? Json(true) : value_of(key, decoded(word.substr(is + 1)));
        if (key == "exposure" && value != 1)
            throw Error(
                "exposure, a factor on a page's own extinction; extinction=NUMBER works here, too");
        if (key.empty() || std::ranges::count(kOfPage, std::string_view(key)) > 0) continue;
        constexpr std::string_view kCamera = "camera.";
        if (key.starts_with(kCamera))
            json["camera"][key.substr(kCamera.size())] = value;
        else
            json[key] = value;
    }
    if (!has_words) throw Error("no link of a page, expected words behind '#', show=column&...");
    return {request_of_json(json.dump()), {}};
} catch (const nlohmann::json::exception& error) {
    throw Error("no link of a page: " + json_fault(error));
}

PictureRecord read_record(const std::filesystem::path& file) {
    using image_files::ImageFormat;
    const ImageFormat format = image_files::image_format(file);
    std::string text;
    if (format == ImageFormat::kOther) {
        std::ifstream stream(file, std::ios::binary);
        text.resize(kMostBytes + 1);
        stream.read(text.data(), static_cast<std::streamsize>(text.size()));
        text.resize(static_cast<std::size_t>(stream.gcount()));
    } else {
        text = format == ImageFormat::kPng ? image_files::png_record(file)
                                           : image_files::exr_record(file);
        if (text.empty())
            throw Error(file.string() + ": a picture without a record of how it was made");
    }
    if (text.size() > kMostBytes)
        throw Error(file.string() + ": too long for a record of a picture");
    try {
        const std::size_t first = text.find_first_of("{#");
        return first != text.npos && text[first] == '#' ? record_of_link(text)
                                                        : record_of_json(text);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
}

}  // namespace vog
