// byte_source.cpp: bounds-checked reading of bytes from files and memory.
#include "io/byte_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "io/file_extension.h"
#include "io/scan/scan_bytes.h"
#include "vog/error.h"

namespace vog {

std::string ByteSource::string() {
    const auto length = number<std::uint32_t>();
    return {take(length), length};
}

void ByteSource::fail(const std::string& what) const {
    throw Error(fmt::format("{}: {} (at byte {})", where_, what, position()));
}

void ByteSource::fail_short(std::uint64_t wanted, std::uint64_t left) const {
    fail(fmt::format("truncated or corrupt: expected {} more bytes, got {}", wanted, left));
}

FileBytes::FileBytes(const std::filesystem::path& file) : ByteSource(file.string()) {
    require_readable(file);
    if (lower_extension(file) == ".gz" && scan::is_gzip(file)) {
        unpacked_ = scan::unpacked_bytes(file);
        size_ = unpacked_.size();
        return;
    }
    stream_.open(file, std::ios::binary | std::ios::ate);
    const auto end = stream_.tellg();
    if (!stream_ || end < 0) fail("cannot be read");
    size_ = static_cast<std::uint64_t>(end);
    seek(0);
}

void FileBytes::seek(std::uint64_t position) {
    if (position > size_) fail_short(position - position_, size_ - position_);
    if (unpacked_.empty() && !stream_.seekg(static_cast<std::streamoff>(position)))
        fail("cannot be read");
    position_ = position;
}

const char* FileBytes::take(std::uint64_t count) {
    if (count > size_ - position_) fail_short(count, size_ - position_);
    resize_kept(taken_, count);
    constexpr std::uint64_t kStep = 1 << 20;
    for (std::uint64_t at = 0; at < count; at += kStep) {
        const std::uint64_t bytes = std::min(kStep, count - at);
        if (!unpacked_.empty())
            std::memcpy(taken_.data() + at, unpacked_.data() + position_ + at, bytes);
        else if (!stream_.read(taken_.data() + at, static_cast<std::streamsize>(bytes)))
            fail("cannot be read");
        keep_memory();
    }
    position_ += count;
    return taken_.data();
}

BigVector<char> FileBytes::range(std::uint64_t begin, std::uint64_t end) {
    seek(begin);
    take(end - begin);
    return std::move(taken_);
}

const char* FileRange::take(std::uint64_t count) {
    constexpr std::uint64_t kWindow = 1 << 20;
    check(count);
    if (position_ < window_begin_ || position_ + count > window_begin_ + window_.size()) {
        window_begin_ = position_;
        window_ = file_.range(position_,
                              position_ + std::min(std::max(count, kWindow), end_ - position_));
    }
    const char* bytes = window_.data() + (position_ - window_begin_);
    position_ += count;
    return bytes;
}

void FileRange::skip(std::uint64_t count) {
    check(count);
    position_ += count;
}

const char* MemoryBytes::take(std::uint64_t count) {
    if (count > bytes_.size() - offset_) fail_short(count, bytes_.size() - offset_);
    const char* bytes = bytes_.data() + offset_;
    offset_ += count;
    return bytes;
}

std::streambuf::pos_type MemoryStream::Buffer::seekoff(off_type offset, std::ios::seekdir from,
                                                       std::ios::openmode) {
    const off_type base = from == std::ios::beg   ? 0
                          : from == std::ios::cur ? gptr() - eback()
                                                  : egptr() - eback();
    const off_type target = base + offset;
    if (target < 0 || target > egptr() - eback()) return pos_type(off_type(-1));
    setg(eback(), eback() + target, egptr());
    return pos_type(target);
}

}  // namespace vog
