// atomic_file.h: write a file beside its name and rename it when complete, so that a failed or
// interrupted write never destroys an existing file.
#pragma once

#include <filesystem>
#include <functional>

namespace vog {

/// Calls write(path) with a path beside `file` and the same extension, then renames it to `file`.
/// If write throws, the temporary file is removed, `file` is unchanged, the exception propagates.
/// throws vog::Error if the folder does not exist or cannot be written
void write_beside_and_rename(const std::filesystem::path& file,
                             const std::function<void(const std::filesystem::path&)>& write);

/// throws vog::Error unless `file` exists and is a regular file that can be opened
void require_readable(const std::filesystem::path& file);

}  // namespace vog
