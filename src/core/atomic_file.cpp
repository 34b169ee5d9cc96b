// atomic_file.cpp: writing through a temporary file, and checks of paths.
#include "core/atomic_file.h"

#include <fmt/core.h>

#include <cerrno>
#include <ios>
#include <system_error>

#include "vog/error.h"
#include "vog/temporary_file.h"

namespace vog {

void write_beside_and_rename(const std::filesystem::path& file,
                             const std::function<void(const std::filesystem::path&)>& write) {
    namespace fs = std::filesystem;
    // Devices and pipes are written in place; a symbolic link stays and its target is replaced.
    std::error_code code;
    const fs::file_status status = fs::status(file, code);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        return write(file);
    if (fs::is_regular_file(status) && fs::is_symlink(file, code))
        return write_beside_and_rename(fs::canonical(file), write);

    TemporaryFile beside(file);
    write(beside.path());
    beside.rename();
}

void write_file(const std::filesystem::path& file,
                const std::function<void(std::ofstream&)>& write) {
    write_beside_and_rename(file, [&](const std::filesystem::path& path) {
        errno = 0;
        const auto fail = [&]() -> Error {
            return Error(fmt::format("{}: cannot write: {}", file.string(),
                                     std::generic_category().message(errno ? errno : EIO)));
        };
        try {
            std::ofstream out(path, std::ios::binary);
            out.exceptions(std::ios::failbit | std::ios::badbit);
            write(out);
            out.close();
            if (!out) throw fail();  // a writer kept an exception to itself
        } catch (const std::ios_base::failure&) {
            throw fail();
        }
    });
}

void require_readable(const std::filesystem::path& file) {
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (status.type() == std::filesystem::file_type::not_found)
        throw Error(fmt::format("{}: no such file", file.string()));
    if (status.type() == std::filesystem::file_type::none)
        throw Error(fmt::format("{}: cannot be read: {}", file.string(), code.message()));
    if (std::filesystem::is_directory(status))
        throw Error(fmt::format("{}: is a folder, expected a file", file.string()));
    // Opening a pipe waits for its writer, and readers go back and forth in a file.
    if (!std::filesystem::is_regular_file(status))
        throw Error(
            fmt::format("{}: is a pipe, a socket or a device, expected a file", file.string()));
    errno = 0;
    if (!std::ifstream(file, std::ios::binary))
        throw Error(fmt::format("{}: cannot be read: {}", file.string(),
                                std::generic_category().message(errno ? errno : EIO)));
}

}  // namespace vog
