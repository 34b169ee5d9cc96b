// raw.cpp: raw values (.raw) with a head in JSON beside them.
#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "io/scan/scan_file.h"
#include "io/scan/scan_values.h"
#include "vog/dense.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

using Json = nlohmann::json;

/// FILE.json, else the name with .json for .raw.
std::filesystem::path head_of(const std::filesystem::path& file) {
    std::filesystem::path longer = file, other = file;
    longer += ".json";
    other.replace_extension(".json");
    std::error_code code;
    for (const std::filesystem::path& head : {longer, other})
        if (std::filesystem::exists(head, code)) return head;
    throw Error(
        fmt::format("{}: raw values without a head, expected {} beside it: "
                    "{{\"size\": [x, y, z], \"type\": \"uint16\", \"spacing\": [1, 1, 1]}}",
                    file.string(), longer.filename().string()));
}

Json parsed(const std::filesystem::path& head) {
    require_readable(head);
    std::ifstream in(head);
    Json json = Json::parse(in);
    if (!json.is_object()) throw Error(fmt::format("{}: no JSON object", head.string()));
    for (const auto& [key, value] : json.items()) {
        bool known = false;
        for (const char* name :
             {"size", "type", "endian", "spacing", "origin", "matrix", "unit", "value_unit",
              "slope", "intercept", "skip", "frames", "channels", "name"})
            known |= key == name;
        if (!known)
            throw Error(
                fmt::format("{}: unknown key '{}', expected size, type, endian, spacing, origin, "
                            "matrix, unit, value_unit, slope, intercept, skip, frames, channels "
                            "or name",
                            head.string(), printable(key, 40)));
    }
    return json;
}

Vec3d vector_at(const Json& json, const char* key, Vec3d otherwise) {
    if (!json.contains(key)) return otherwise;
    const auto v = json.at(key).get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

Affine map_of(const Json& json, const std::filesystem::path& head) {
    if (!json.contains("matrix"))
        return affine_from_voxels(vector_at(json, "spacing", {1, 1, 1}),
                                  vector_at(json, "origin", {}));
    if (json.contains("spacing") || json.contains("origin"))
        throw Error(fmt::format("{}: matrix beside spacing or origin, expected one of them",
                                head.string()));
    const auto rows = json.at("matrix").get<std::array<std::array<double, 4>, 4>>();
    std::array<double, 16> flat;
    for (std::size_t n = 0; n < 16; ++n) flat[n] = rows[n / 4][n % 4];
    return affine_from_matrix(flat);
}

}  // namespace

ScanFile open_raw(const std::filesystem::path& file) {
    require_readable(file);
    const std::filesystem::path head = head_of(file);
    try {
        const Json json = parsed(head);
        const auto size = json.at("size").get<std::array<std::int64_t, 3>>();
        const auto type = json.at("type").get<std::string>();
        const std::string endian = json.value("endian", "little");
        const std::optional<Number> number = number_named(type);
        if (!number)
            throw Error(
                fmt::format("{}: type '{}', expected int8, uint8, ... int64, uint64, float16, "
                            "float32 or float64",
                            head.string(), printable(type, 40)));
        if (endian != "little" && endian != "big")
            throw Error(fmt::format("{}: endian '{}', expected little or big", head.string(),
                                    printable(endian, 40)));
        StoredArray array;
        array.type = *number;
        array.big_endian = endian == "big";
        array.voxels = checked_voxels(head, size[0], size[1], size[2]);
        array.slope = json.value("slope", 1.0);
        array.offset = json.value("intercept", 0.0);
        const std::int64_t skip = json.value("skip", std::int64_t{0});
        const std::int64_t frames = json.value("frames", std::int64_t{1});
        const std::int64_t channels = json.value("channels", std::int64_t{1});
        if (skip < 0 || frames < 1 || channels < 1 || frames > kMostGrids ||
            channels > kMostGrids || (frames > 1 && channels > 1))
            throw Error(
                fmt::format("{}: skip {}, frames {}, channels {}, expected skip from 0 on, and "
                            "several frames or several channels",
                            head.string(), skip, frames, channels));
        array.parts = {{file, static_cast<std::uint64_t>(skip), 0}};
        array.grids = static_cast<std::uint64_t>(std::max(frames, channels));
        array.interleaved = channels > 1;
        const std::uint64_t expected =
            array.parts[0].begin + array.voxels * array.grids * bytes_of(array.type);
        if (const std::uint64_t bytes = std::filesystem::file_size(file); bytes != expected)
            throw Error(
                fmt::format("{}: {} bytes, expected {} for {} x {} x {} x {} values of {} behind "
                            "{} bytes",
                            file.string(), bytes, expected, size[0], size[1], size[2], array.grids,
                            type, skip));
        ScanGrid grid;
        grid.size = {static_cast<std::int32_t>(size[0]), static_cast<std::int32_t>(size[1]),
                     static_cast<std::int32_t>(size[2])};
        grid.type = type;
        grid.world_from_index = map_of(json, head);
        grid.length_unit = json.value("unit", "");
        grid.value_unit = json.value("value_unit", "");
        std::vector<std::string> names = numbered_names(channels > 1 ? "c" : "t", array.grids);
        if (names.size() == 1) names[0] = json.value("name", names[0]);
        ScanFile scan;
        scan.read = reader_of(array);
        scan.grids = named_copies(grid, names);
        return scan;
    } catch (const Json::exception& error) {
        throw Error(fmt::format("{}: {}", head.string(), json_fault(error)));
    }
}

}  // namespace vog::scan
