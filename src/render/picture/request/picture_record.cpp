// picture_record.cpp: records of pictures as JSON, and in files of pictures.
#include "vog/picture_record.h"

#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "io/image/image_files.h"
#include "vog/error.h"
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
    if (!json.is_object() || !json.contains("picture"))
        throw Error("no record of a picture, expected an object with 'picture' and 'inputs'");
    PictureRecord record;
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
        return record_of_json(text);
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
}

}  // namespace vog
