// manifest.cpp: manifests and tables as JSON; every number is checked when read.
#include "io/site/manifest.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "io/model_json.h"
#include "io/site/chunk_name.h"
#include "io/vogz/file_table.h"
#include "vog/error.h"

namespace vog::site {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kFormat = "vog site";
constexpr int kVersion = 1;
constexpr std::string_view kCrcKey = ",\"crc\":";
/// Far above those of any site; a file of damaged length does not allocate more.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
constexpr std::uint32_t kMostGaussians = 1u << 20, kMostChunkBytes = 1u << 30;
constexpr int kMostDepth = 64;

Json json_of(const Row& row) {
    Json json = {{"name", row.name},
                 {"nodes", row.nodes},
                 {"gaussians", row.gaussians},
                 {"error", six_digits(row.error, true)}};
    for (std::size_t k = 0; k < 6; ++k) json["box"].push_back(six_digits(row.box[k], k >= 3));
    json["bytes"] = row.bytes;
    if (!row.table.empty()) {
        json["table"] = row.table;
        json["tableBytes"] = row.table_bytes;
    }
    for (const Row& part : row.parts) json["parts"].push_back(json_of(part));
    return json;
}

/// A finite number as the float that writers rounded: six digits of the largest float are above it.
float float_of(const Json& json) {
    constexpr double kMost = std::numeric_limits<float>::max();
    const auto v = json.get<double>();
    if (!std::isfinite(v)) throw Error("a number that is not finite");
    return static_cast<float>(std::clamp(v, -kMost, kMost));
}

std::uint32_t count_of(const Json& json, const char* key, std::uint32_t most) {
    const Json& value = json.at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
        throw Error(
            fmt::format("{} {}, expected a whole number of at most {}", key, value.dump(), most));
    return value.get<std::uint32_t>();
}
std::string name_of(const Json& json, const char* key) {
    const auto name = json.at(key).get<std::string>();
    if (!is_content_name(name)) throw Error(fmt::format("a {} that is no name of a chunk", key));
    return name;
}

Row row_of(const Json& json, std::size_t fields, int depth) {
    Row row;
    row.name = name_of(json, "name");
    row.gaussians = count_of(json, "gaussians", kMostGaussians);
    row.nodes = count_of(json, "nodes", row.gaussians);
    row.error = float_of(json.at("error"));
    const auto corners = json.at("box").get<std::array<Json, 6>>();
    std::ranges::transform(corners, row.box.begin(), float_of);
    row.bytes = json.at("bytes").get<std::vector<std::uint32_t>>();
    if (row.gaussians == 0) throw Error("a chunk without Gaussians");
    if (!(row.error >= 0))
        throw Error(fmt::format("an error of {}, expected a finite number >= 0", row.error));
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(row.box[axis] <= row.box[axis + 3])) throw Error("a box that is none");
    if (row.bytes.size() != 1 + fields)
        throw Error(fmt::format("{} sizes of files, expected {}", row.bytes.size(), 1 + fields));
    for (const std::uint32_t bytes : row.bytes)
        if (bytes > kMostChunkBytes) throw Error(fmt::format("a chunk of {} bytes", bytes));
    if (json.contains("table")) {
        row.table = name_of(json, "table");
        row.table_bytes = count_of(json, "tableBytes", kMostChunkBytes);
    }
    if (json.contains("parts")) {
        if (depth == 0) throw Error(fmt::format("a tree of more than {} depths", kMostDepth));
        for (const Json& part : json["parts"]) row.parts.push_back(row_of(part, fields, depth - 1));
    }
    const int ways = (row.table.empty() ? 0 : 1) + (row.parts.empty() ? 0 : 1);
    if (ways != (row.nodes > 0 ? 1 : 0))
        throw Error("a chunk whose nodes have no parts, or parts without nodes");
    return row;
}

Json json_of(const ManifestModel& model) {
    const Gaussians& about = model.description;
    Json json = {{"name", model.name}, {"gaussians", model.gaussians}, {"rotated", model.rotated}};
    put_description(json, about);
    json["fields"] = fields_json(about.fields);
    json["levels"] = Json::array();
    for (const SiteLevel& level : model.levels)
        json["levels"].push_back({{"chunks", level.chunks},
                                  {"gaussians", level.gaussians},
                                  {"bytes", level.bytes},
                                  {"error", six_digits(level.error, true)}});
    json["root"] = json_of(model.root);
    return json;
}

ManifestModel model_of(const Json& json) {
    ManifestModel model;
    Gaussians& about = model.description;
    model.name = json.at("name");
    model.gaussians = json.at("gaussians");
    model.rotated = json.at("rotated");
    take_description(json, about);
    if (!(about.cutoff > 0 && about.cutoff <= 8))
        throw Error(
            fmt::format("a cutoff of {}, expected more than 0 and at most 8", about.cutoff));
    about.fields = fields_of(json.at("fields"));
    for (const Json& level : json.at("levels"))
        model.levels.push_back(
            {level.at("chunks"), level.at("gaussians"), level.at("bytes"), level.at("error")});
    model.root = row_of(json.at("root"), field_count(model), kMostDepth);
    return model;
}

/// throws vog::Error with the name of the file for whatever `read` throws
template <class Read>
auto named(const fs::path& file, const Read& read) {
    try {
        return read();
    } catch (const nlohmann::json::exception& error) {
        throw Error(fmt::format("{}: damaged: {}", file.string(), json_fault(error)));
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
}

/// Text of a description, its last entry the CRC-32 of all bytes before that entry: browsers have no hash of names.
std::string text_of(const Json& json) {
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.pop_back();
    const std::uint32_t crc = vogz::checksum(text);
    return text + fmt::format("{}{}}}\n", kCrcKey, crc);
}

/// throws vog::Error where a text ends in another checksum than its own; those of earlier writers have none
void check_sum(std::string_view text) {
    const std::size_t at = text.rfind(kCrcKey);
    if (at == text.npos || !text.ends_with("}\n")) return;
    const std::string_view digits =
        text.substr(at + kCrcKey.size(), text.size() - 2 - at - kCrcKey.size());
    const bool number = !digits.empty() && std::ranges::all_of(digits, [](char letter) {
        return letter >= '0' && letter <= '9';
    });
    if (number && digits != std::to_string(vogz::checksum(text.substr(0, at))))
        throw Error("damaged: other bytes than were written");
}

}  // namespace

std::uint64_t Row::all_bytes() const {
    return std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
}

std::size_t field_count(const ManifestModel& model) {
    return model.description.fields.scalar.size() + model.description.fields.vector.size();
}

const ManifestModel& model_at(const Manifest& manifest, std::size_t model, const fs::path& folder) {
    if (model >= manifest.models.size())
        throw Error(fmt::format("{}: model {}, expected below {}", folder.string(), model,
                                manifest.models.size()));
    return manifest.models[model];
}

fs::path shapes_path(const fs::path& folder, const std::string& name) {
    return folder / kChunksName / (name + ".vogz");
}
fs::path field_path(const fs::path& folder, const std::string& name, std::size_t field) {
    return folder / kChunksName / fmt::format("{}.{}", name, field);
}
fs::path table_path(const fs::path& folder, const std::string& name) {
    return folder / kChunksName / (name + ".json");
}

std::string manifest_text(const Manifest& manifest) {
    Json json = {{"format", kFormat}, {"version", kVersion}, {"steps", manifest.steps}};
    for (const ManifestModel& model : manifest.models) json["models"].push_back(json_of(model));
    return text_of(json);
}

std::string table_text(const std::vector<Row>& parts) {
    Json json;
    for (const Row& part : parts) json["parts"].push_back(json_of(part));
    return text_of(json);
}

std::string read_whole(const fs::path& file, std::uint64_t size) {
    require_readable(file);
    std::ifstream in(file, std::ios::binary);
    std::string bytes(size, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    if (static_cast<std::uint64_t>(in.gcount()) != size ||
        in.peek() != std::ifstream::traits_type::eof())
        throw Error(fmt::format("{}: damaged: {} bytes, expected {}", file.string(),
                                fs::file_size(file), size));
    return bytes;
}

Manifest read_manifest(const fs::path& folder) {
    const fs::path file = folder / kManifestName;
    require_readable(file);
    const std::uint64_t size = fs::file_size(file);
    if (size > kMostBytes)
        throw Error(
            fmt::format("{}: {} bytes, expected at most {}", file.string(), size, kMostBytes));
    const std::string text = read_whole(file, size);
    const Json json = named(file, [&] { return Json::parse(text); });
    if (!json.is_object() || json.value("format", Json()) != kFormat)
        throw Error(fmt::format("{}: no manifest of a site (vog page MODEL -o FOLDER/ writes one)",
                                file.string()));
    return named(file, [&] {
        if (json.at("version") != kVersion)
            throw Error(fmt::format("version {}, expected {}: written by another vog",
                                    json["version"].dump(), kVersion));
        check_sum(text);
        Manifest manifest;
        manifest.steps = json.at("steps");
        for (const Json& model : json.at("models")) manifest.models.push_back(model_of(model));
        if (manifest.models.empty()) throw Error("no model");
        return manifest;
    });
}

std::vector<Row> read_parts(const fs::path& folder, const Row& row, std::size_t fields) {
    const fs::path file = table_path(folder, row.table);
    const std::string text = read_whole(file, row.table_bytes);
    return named(file, [&] {
        if (content_name(std::span(&text, 1)) != row.table)
            throw Error("other bytes than were written");
        std::vector<Row> parts;
        const Json json = Json::parse(text);
        for (const Json& part : json.at("parts")) parts.push_back(row_of(part, fields, kMostDepth));
        if (parts.empty()) throw Error("no parts");
        return parts;
    });
}

}  // namespace vog::site
