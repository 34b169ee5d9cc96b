// temporary_file.cpp: unused short names, and the list of files to remove on a signal.
#include "vog/temporary_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <random>
#include <system_error>

#include "vog/error.h"

namespace vog {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, int error) {
    throw Error(
        fmt::format("{}: cannot write: {}", file.string(), std::generic_category().message(error)));
}

/// Path of a temporary file for signal handlers, which must neither lock nor allocate.
struct Slot {
    std::atomic<bool> taken{false}, holds_path{false};
    std::array<char, PATH_MAX> path{};
};
/// As many as files are written at once, by far: sequences write one on each thread. Files beyond
/// stay after a signal.
std::array<Slot, 64> slots;
/// Whether a signal is about to end the program.
std::atomic<bool> ending{false};

void wait_for_end() {
    while (ending) ::pause();
}

int take_slot(const fs::path& path) {
    std::error_code code;
    const std::string text = fs::absolute(path, code).string();  // the folder may change
    for (std::size_t n = 0; n < slots.size() && !code && text.size() < PATH_MAX; ++n) {
        Slot& slot = slots[n];
        if (slot.taken.exchange(true)) continue;
        std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
        slot.holds_path = true;
        return static_cast<int>(n);
    }
    return -1;
}

void release_slot(int slot) {
    if (slot < 0) return;
    slots[static_cast<std::size_t>(slot)].holds_path = false;
    slots[static_cast<std::size_t>(slot)].taken = false;
}

/// Waits until the disk has the bytes of a file, or the names in a folder. File systems that do not know the call
/// (EINVAL, ENOTSUP) have nothing to wait for.
/// returns  0, or the system's reason
int wait_for_disk(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return errno == EACCES ? 0 : errno;  // a folder to write in, not to list
    const int error = ::fsync(file) == 0 ? 0 : errno;
    ::close(file);
    return error == EINVAL || error == ENOTSUP ? 0 : error;
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// ".vog-0123456789ab.ply". Random, as processes of several machines may share a folder.
std::string hidden_name(const fs::path& file) {
    constexpr std::size_t kLongestExtension = 8;
    std::random_device random;
    const std::uint64_t number = std::uint64_t{random()} << 16 ^ random();
    const std::string extension = file.extension().string();
    return fmt::format(".vog-{:012x}{}", number & 0xffffffffffff,
                       extension.size() <= kLongestExtension ? extension : "");
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& file) : file_(file) {
    std::error_code code;
    const fs::path folder = folder_of(file);
    const auto type = fs::status(file, code).type();
    if (type == fs::file_type::none) fail(file, code.value());  // the name is too long, and such
    if (type == fs::file_type::directory) fail(file, EISDIR);
    for (int tries = 0; tries < 100; ++tries) {
        path_ = folder / hidden_name(file);
        // Listed before it exists: no signal comes between.
        slot_ = take_slot(path_);
        const int made = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        const int error = errno;
        if (ending) {
            ::unlink(path_.c_str());
            wait_for_end();
        }
        if (made >= 0) {
            ::close(made);
            return;
        }
        release_slot(slot_);
        if (error == ENOENT)
            throw Error(
                fmt::format("{}: cannot write: no folder '{}'", file.string(), folder.string()));
        if (error != EEXIST) fail(file, error);
    }
    fail(file, EEXIST);
}

TemporaryFile::~TemporaryFile() {
    if (!renamed_) ::unlink(path_.c_str());
    release_slot(slot_);
}

void TemporaryFile::rename() {
    // Else a power cut could leave the new name with none of its bytes, and the earlier file lost.
    if (const int error = wait_for_disk(path_)) fail(file_, error);
    if (::rename(path_.c_str(), file_.c_str()) != 0) fail(file_, errno);
    renamed_ = true;
    if (const int error = wait_for_disk(folder_of(file_))) fail(file_, error);
}

void remove_temporary_files() noexcept {
    const int error = errno;
    ending = true;
    for (const Slot& slot : slots)
        if (slot.holds_path) ::unlink(slot.path.data());
    errno = error;
}

}  // namespace vog
