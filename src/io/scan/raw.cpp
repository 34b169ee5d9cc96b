// raw.cpp: raw values (.raw) with a head in JSON beside them.
#include <fmt/core.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <type_traits>

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
        fmt::format("{}: raw values without a head, expected {} beside it: {{\"size\": [x, y, z], "
                    "\"type\": \"uint16\", \"spacing\": [1, 1, 1]}}",
                    file.string(), longer.filename().string()));
}

using Sizes = std::array<std::int64_t, 3>;
using Numbers = std::array<double, 3>;
using Rows = std::array<std::array<double, 4>, 4>;

/// Keys of a head.
struct RawHead {
    std::filesystem::path file;
    Json json;

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}", file.string(), what));
    }
    /// throws vog::Error where the key is absent, or its value is not exactly a T
    template <class T>
    T at(const char* key) const {
        if (!json.contains(key)) fail(fmt::format("no key '{}'", key));
        const Json& stated = json.at(key);
        try {
            T value = stated.get<T>();
            // Further elements of a list and fractions of whole numbers would be dropped.
            if (Json(value) == stated) return value;
        } catch (const Json::exception&) {  // a value of another type
        }
        const char* expected = std::is_same_v<T, Sizes>          ? "3 whole numbers"
                               : std::is_same_v<T, Numbers>      ? "3 numbers"
                               : std::is_same_v<T, Rows>         ? "4 rows of 4 numbers"
                               : std::is_same_v<T, std::string>  ? "a text"
                               : std::is_same_v<T, std::int64_t> ? "a whole number"
                                                                 : "a number";
        fail(fmt::format("{} is {}, expected {}", key, printable(stated.dump(), 60), expected));
    }
    template <class T>
    T at(const char* key, const T& otherwise) const {
        return json.contains(key) ? at<T>(key) : otherwise;
    }
};

RawHead read_raw_head(const std::filesystem::path& file) {
    RawHead head{file, {}};
    require_readable(file);
    std::ifstream in(file);
    try {
        head.json = Json::parse(in);
    } catch (const Json::exception& error) {
        head.fail(json_fault(error));
    }
    if (!head.json.is_object()) head.fail("no JSON object");
    for (const auto& [key, value] : head.json.items()) {
        bool known = false;
        for (const char* name :
             {"size", "type", "endian", "spacing", "origin", "matrix", "unit", "value_unit",
              "slope", "intercept", "skip", "frames", "channels", "name"})
            known |= key == name;
        if (!known)
            head.fail(fmt::format(
                "unknown key '{}', expected size, type, endian, spacing, origin, matrix, unit, "
                "value_unit, slope, intercept, skip, frames, channels or name",
                printable(key, 40)));
    }
    return head;
}

Affine map_of(const RawHead& head) {
    const bool has_matrix = head.json.contains("matrix");
    if (has_matrix && (head.json.contains("spacing") || head.json.contains("origin")))
        head.fail("matrix beside spacing or origin, expected one of them");
    const auto edge = head.at<Numbers>("spacing", {1, 1, 1}),
               origin = head.at<Numbers>("origin", {});
    std::array<double, 16> flat{};
    if (has_matrix) {
        const auto rows = head.at<Rows>("matrix");
        for (std::size_t n = 0; n < 16; ++n) flat[n] = rows[n / 4][n % 4];
    }
    try {
        return has_matrix ? affine_from_matrix(flat)
                          : affine_from_voxels({edge[0], edge[1], edge[2]},
                                               {origin[0], origin[1], origin[2]});
    } catch (const Error& error) {
        head.fail(error.what());
    }
}

}  // namespace

ScanFile open_raw(const std::filesystem::path& file) {
    require_readable(file);
    const RawHead head = read_raw_head(head_of(file));
    const auto size = head.at<Sizes>("size");
    const auto type = head.at<std::string>("type");
    const auto endian = head.at<std::string>("endian", "little");
    const std::optional<Number> number = number_named(type);
    if (!number)
        head.fail(fmt::format(
            "type '{}', expected int8, uint8, ... int64, uint64, float16, float32 or float64",
            printable(type, 40)));
    if (endian != "little" && endian != "big")
        head.fail(fmt::format("endian '{}', expected little or big", printable(endian, 40)));
    StoredArray array;
    array.type = *number;
    array.big_endian = endian == "big";
    array.voxels = checked_voxels(head.file, size[0], size[1], size[2]);
    array.scale = "slope";
    array.slope = head.at("slope", 1.0);
    array.offset = head.at("intercept", 0.0);
    const auto skip = head.at<std::int64_t>("skip", 0), frames = head.at<std::int64_t>("frames", 1),
               channels = head.at<std::int64_t>("channels", 1);
    if (skip < 0 || frames < 1 || channels < 1 || frames > kMostGrids || channels > kMostGrids ||
        (frames > 1 && channels > 1))
        head.fail(
            fmt::format("skip {}, frames {}, channels {}, expected skip from 0 on, and several "
                        "frames or several channels",
                        skip, frames, channels));
    array.parts = {{file, static_cast<std::uint64_t>(skip), 0}};
    array.grids = static_cast<std::uint64_t>(std::max(frames, channels));
    array.interleaved = channels > 1;
    const std::uint64_t expected =
        array.parts[0].begin + array.voxels * array.grids * bytes_of(array.type);
    if (const std::uint64_t bytes = std::filesystem::file_size(file); bytes != expected)
        throw Error(fmt::format(
            "{}: {} bytes, expected {} for {} x {} x {} x {} values of {} behind {} bytes",
            file.string(), bytes, expected, size[0], size[1], size[2], array.grids, type, skip));
    ScanGrid grid;
    grid.size = {static_cast<std::int32_t>(size[0]), static_cast<std::int32_t>(size[1]),
                 static_cast<std::int32_t>(size[2])};
    grid.type = type;
    grid.world_from_index = map_of(head);
    grid.length_unit = head.at<std::string>("unit", "");
    grid.value_unit = head.at<std::string>("value_unit", "");
    std::vector<std::string> names = numbered_names(channels > 1 ? "c" : "t", array.grids);
    if (names.size() == 1) names[0] = head.at<std::string>("name", names[0]);
    ScanFile scan;
    scan.read = reader_of(array);
    scan.grids = named_copies(grid, names);
    return scan;
}

}  // namespace vog::scan
