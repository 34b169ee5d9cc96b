// atomic_file.h: write a file beside its name and rename it when complete, so that a failed or
// interrupted write never destroys an existing file.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>

namespace vog {

/// Calls write(path) with the path of a TemporaryFile, then renames it to `file`. If write throws,
/// the temporary file is removed, `file` is unchanged, the exception propagates. Devices and pipes
/// are written in place.
/// throws vog::Error if the folder does not exist or cannot be written
void write_beside_and_rename(const std::filesystem::path& file,
                             const std::function<void(const std::filesystem::path&)>& write);

/// The same with a binary stream that throws std::ios_base::failure where a write fails.
/// throws vog::Error with the system's reason where a write fails
void write_file(const std::filesystem::path& file,
                const std::function<void(std::ofstream&)>& write);

/// throws vog::Error unless `file` exists and is a regular file that can be opened
void require_readable(const std::filesystem::path& file);

}  // namespace vog
