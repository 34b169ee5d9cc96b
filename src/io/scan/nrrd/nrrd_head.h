// nrrd_head.h: the head of NRRD files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vog::scan {

/// Fields of a head, by their names in lower case.
struct NrrdHead {
    std::filesystem::path file;
    std::map<std::string, std::string> fields;
    std::vector<std::string> list;  ///< names of files behind "data file: LIST"
    std::uint64_t bytes = 0;        ///< to the end of the empty line behind the head

    std::string text(const std::string& key) const {
        const auto at = fields.find(key);
        return at == fields.end() ? std::string() : at->second;
    }
    [[noreturn]] void fail(const std::string& what) const;
};

NrrdHead read_nrrd_head(const std::filesystem::path& file);

/// Vectors "(1,0,0) none (0,0,2)" of 2 to 4 numbers: one for each axis; none, or NaN, for an axis not in space.
using NrrdVectors = std::vector<std::optional<std::vector<double>>>;
NrrdVectors vectors_of(const NrrdHead& head, const std::string& key);

}  // namespace vog::scan
