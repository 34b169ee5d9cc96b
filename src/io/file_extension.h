// file_extension.h: the extension of a file's name in lower case, by which formats are chosen.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace vog {

/// Extension with its dot: ".vdb" of "SMOKE.VDB"; empty: none.
inline std::string lower_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// Extension of the file inside where its name ends in .gz: ".nvdb" of "smoke.nvdb.gz".
inline std::string stored_extension(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".gz" ? lower_extension(file.stem()) : extension;
}

/// Name without the folder, the extension and that of packing: "smoke" of "run/smoke.nvdb.gz".
inline std::string plain_stem(const std::filesystem::path& file) {
    const std::filesystem::path stem = file.stem();
    return (lower_extension(file) == ".gz" ? stem.stem() : stem).string();
}

}  // namespace vog
