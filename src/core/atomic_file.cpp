// atomic_file.cpp: temporary names, renaming, and checks of paths.
#include "core/atomic_file.h"

#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <system_error>

#include "vog/error.h"

namespace vog {

void write_beside_and_rename(const std::filesystem::path& file,
                             const std::function<void(const std::filesystem::path&)>& write) {
    namespace fs = std::filesystem;
    std::error_code code;
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, code))
        throw Error(
            fmt::format("{}: cannot write: no folder '{}'", file.string(), folder.string()));
    if (fs::is_directory(file, code))
        throw Error(fmt::format("{}: cannot write: it is a folder", file.string()));

    // Devices and pipes are written in place; a symbolic link stays and its target is replaced.
    const auto type = fs::status(file, code).type();
    if (type != fs::file_type::not_found && type != fs::file_type::regular) return write(file);
    if (fs::is_symlink(file, code) && type == fs::file_type::regular)
        return write_beside_and_rename(fs::canonical(file), write);

    // Unique by process id and counter; some writers choose a format by the extension, so it stays.
    static std::atomic<unsigned> counter{0};
    const fs::path beside = folder / fmt::format(".{}.{}-{}{}", file.stem().string(), ::getpid(),
                                                 counter++, file.extension().string());
    try {
        write(beside);
        fs::rename(beside, file);
    } catch (const fs::filesystem_error& error) {
        fs::remove(beside, code);
        throw Error(fmt::format("{}: cannot write: {}", file.string(), error.code().message()));
    } catch (...) {
        fs::remove(beside, code);
        throw;
    }
}

void require_readable(const std::filesystem::path& file) {
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (status.type() == std::filesystem::file_type::not_found)
        throw Error(fmt::format("{}: no such file", file.string()));
    if (std::filesystem::is_directory(status))
        throw Error(fmt::format("{}: is a folder, expected a file", file.string()));
    if (!std::ifstream(file, std::ios::binary))
        throw Error(fmt::format("{}: cannot be read", file.string()));
}

}  // namespace vog
