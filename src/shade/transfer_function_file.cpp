// transfer_function_file.cpp: transfer functions of names and of files: JSON, or tables of labels.
#include <fmt/core.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_fault.h"
#include "shade/transfer_function.h"
#include "shade/transfer_json.h"
#include "shade/values/label_table.h"
#include "shade/values/unit_range.h"
#include "vog/error.h"
#include "vog/value_transfer.h"

namespace vog {

using namespace shading;
namespace {

using nlohmann::json;

/// A file, and a label of its table: "organs.ctbl:liver".
struct FileOfLabel {
    std::filesystem::path file;
    std::string label{};
};
FileOfLabel file_of(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    std::error_code code;
    if (colon == std::string::npos || std::filesystem::exists(text, code) ||
        !std::filesystem::exists(text.substr(0, colon), code))
        return {text};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

TransferPoints points_in(const std::string& file_or_label) {
    const auto [file, label] = file_of(file_or_label);
    require_readable(file);
    const std::string where = file.string() + ": ";
    std::ifstream stream(file, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(stream), {});
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);  // the mark of UTF-8
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool is_json = file.extension() == ".json" || first == std::string::npos ||
                         text[first] == '{' || text[first] == '[';
    if (is_json && !label.empty())
        throw Error(fmt::format("{}has no label '{}', expected a table of labels", where, label));
    TransferPoints read;
    try {
        read = is_json ? points_of(json::parse(text), where) : label_points(text, label, where);
    } catch (const json::exception& error) {
        throw Error(where + json_fault(error));
    }
    if (read.points.name.empty()) read.points.name = file.stem().string();
    return read;
}

/// throws  vog::Error unless the text is the name of a map or a file
bool is_map_name(const std::string& name_or_file) {
    if (is_transfer_function_name(name_or_file)) return true;
    std::error_code code;
    if (std::filesystem::exists(file_of(name_or_file).file, code)) return false;
    throw Error(fmt::format("{}: neither a file nor the name of a transfer function (names: {})",
                            name_or_file, transfer_function_name_list()));
}

}  // namespace

TransferFunction read_transfer_function(const std::filesystem::path& file) {
    return over_unit_range(points_in(file.string()));
}

TransferFunction load_transfer_function(const std::string& name_or_file) {
    return is_map_name(name_or_file) ? named_transfer_function(name_or_file)
                                     : read_transfer_function(name_or_file);
}

TransferPoints transfer_points(const std::string& name_or_file) {
    if (!is_map_name(name_or_file)) return points_in(name_or_file);
    TransferPoints read;
    const TransferFunction named = named_transfer_function(name_or_file);
    read.points.name = named.name;
    for (const ColorPoint& point : named.color)
        read.points.color.push_back({double{point.v}, point.r, point.g, point.b});
    return read;
}

}  // namespace vog
