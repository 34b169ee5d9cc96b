// byte_source.h: bounds-checked reading of bytes from files and memory. Lengths are checked against
// the bytes left, so a corrupt file causes neither an overrun nor an allocation beyond its size.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <span>
#include <streambuf>
#include <string>
#include <vector>

#include "vog/memory.h"
#include "vog/text.h"

namespace vog {

/// Name of a grid in lists and messages, and to select it by: printable, and at most 100 bytes of
/// it. The same for a name that has this form already, so that both forms select the grid.
inline std::string grid_name(std::string_view stored) {
    constexpr std::size_t kLongest = 100;
    return printable(stored, kLongest);
}

/// Sequential little-endian bytes. Every read past the end throws vog::Error.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    /// Returns the next `count` bytes, valid until the next call.
    virtual const char* take(std::uint64_t count) = 0;
    /// Skips the next `count` bytes.
    virtual void skip(std::uint64_t count) { take(count); }
    virtual std::uint64_t position() const = 0;  ///< of the next byte, from the start of the file
    virtual bool at_end() const = 0;

    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value), sizeof value);
        return value;
    }
    /// Reads a 32-bit length and as many characters.
    std::string string();
    /// throws vog::Error with the name of the file, `what` and the position
    [[noreturn]] void fail(const std::string& what) const;

  protected:
    explicit ByteSource(std::string where) : where_(std::move(where)) {}
    [[noreturn]] void fail_short(std::uint64_t wanted, std::uint64_t left) const;

  private:
    std::string where_;  // start of every message: "smoke.vdb: grid 'density'"
};

/// A whole file with random access. A .gz is unpacked into memory.
class FileBytes : public ByteSource {
  public:
    /// throws vog::Error unless `file` is a readable file
    explicit FileBytes(const std::filesystem::path& file);
    const char* take(std::uint64_t count) override;
    std::uint64_t position() const override { return position_; }
    bool at_end() const override { return position_ == size_; }
    std::uint64_t size() const { return size_; }
    void seek(std::uint64_t position);
    /// Bytes begin to end - 1.
    BigVector<char> range(std::uint64_t begin, std::uint64_t end);

  private:
    std::ifstream stream_;
    std::uint64_t size_ = 0, position_ = 0;
    BigVector<char> taken_, unpacked_;
};

/// Part of a file, read in windows of 1 MiB; skipped windows are not read.
class FileRange : public ByteSource {
  public:
    /// file  must outlive this and not be used by others meanwhile
    FileRange(FileBytes& file, std::uint64_t begin, std::uint64_t end, std::string where)
        : ByteSource(std::move(where)), file_(file), position_(begin), end_(end) {}
    const char* take(std::uint64_t count) override;
    void skip(std::uint64_t count) override;
    std::uint64_t position() const override { return position_; }
    bool at_end() const override { return position_ == end_; }

  private:
    void check(std::uint64_t count) const {
        if (count > end_ - position_) fail_short(count, end_ - position_);
    }
    FileBytes& file_;
    std::uint64_t position_, end_;
    std::uint64_t window_begin_ = 0;
    BigVector<char> window_;
};

/// Bytes in memory, copied from `file_offset` of a file.
class MemoryBytes : public ByteSource {
  public:
    MemoryBytes(std::span<const char> bytes, std::string where, std::uint64_t file_offset)
        : ByteSource(std::move(where)), bytes_(bytes), file_offset_(file_offset) {}
    const char* take(std::uint64_t count) override;
    std::uint64_t position() const override { return file_offset_ + offset_; }
    std::size_t offset() const { return offset_; }  ///< of the next byte, from the start of `bytes`
    const char* at(std::size_t offset) const { return bytes_.data() + offset; }
    bool at_end() const override { return offset_ == bytes_.size(); }

  private:
    std::span<const char> bytes_;
    std::uint64_t file_offset_;
    std::size_t offset_ = 0;
};

/// std::istream over bytes in memory, without a copy; a short read throws std::ios_base::failure.
class MemoryStream : public std::istream {
  public:
    explicit MemoryStream(std::span<const char> bytes) : std::istream(nullptr), buffer_(bytes) {
        rdbuf(&buffer_);
        exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    }

  private:
    struct Buffer : std::streambuf {
        explicit Buffer(std::span<const char> bytes) {
            char* begin = const_cast<char*>(bytes.data());  // only ever read
            setg(begin, begin, begin + bytes.size());
        }
        pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode) override;
        pos_type seekpos(pos_type position, std::ios::openmode mode) override {
            return seekoff(off_type(position), std::ios::beg, mode);
        }
    };
    Buffer buffer_;
};

}  // namespace vog
