// ply_index.cpp: JSON list of the PLY files of one model.
#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/ply.h"
#include "vog/text.h"

namespace vog {

namespace {

constexpr const char* kKey = "vog_models";

[[noreturn]] void fail(const std::filesystem::path& file) {
    throw Error(fmt::format("{}: not an index of models, expected {{\"{}\": [\"a.ply\", ...]}}",
                            file.string(), kKey));
}

}  // namespace

void write_model_index(const std::filesystem::path& file, std::span<const std::string> models) {
    for (const std::string& name : models)
        if (printable(name) != name)
            throw Error(
                fmt::format("{}: cannot write: an index holds names in UTF-8 without control "
                            "characters, got '{}'",
                            file.string(), name));
    const nlohmann::json json = {{kKey, std::vector<std::string>(models.begin(), models.end())}};
    write_file(file, [&](std::ofstream& out) { out << json.dump(2) << '\n'; });
}

std::vector<std::filesystem::path> read_model_index(const std::filesystem::path& file) {
    require_readable(file);
    std::ifstream in(file, std::ios::binary);
    const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
    if (!json.is_object() || !json.contains(kKey) || !json[kKey].is_array() || json[kKey].empty())
        fail(file);
    std::vector<std::filesystem::path> models;
    for (const nlohmann::json& name : json[kKey]) {
        if (!name.is_string()) fail(file);
        models.push_back(file.parent_path() / name.get<std::string>());
    }
    return models;
}

}  // namespace vog
