// byte_source.h: checked access to bytes. No read goes past what is there, so a length in a corrupt
// file never allocates more than the file holds and never walks out of a buffer.
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

namespace vog {

/// Little-endian bytes, in order. A read past the end throws vog::Error.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    /// The next `count` bytes, valid until the next call.
    virtual const char* take(std::uint64_t count) = 0;
    /// Passes over the next `count` bytes.
    virtual void skip(std::uint64_t count) { take(count); }
    virtual std::uint64_t position() const = 0;  ///< in the file
    virtual bool at_end() const = 0;

    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value), sizeof value);
        return value;
    }
    /// A 32-bit length and as many characters.
    std::string string();
    [[noreturn]] void fail(const std::string& what) const;

  protected:
    explicit ByteSource(std::string where) : where_(std::move(where)) {}
    [[noreturn]] void fail_short(std::uint64_t wanted, std::uint64_t left) const;

  private:
    std::string where_;  // what every message starts with: "smoke.vdb: grid 'density'"
};

/// A file, read as asked.
class FileBytes : public ByteSource {
  public:
    /// throws vog::Error unless `file` is a readable file
    explicit FileBytes(const std::filesystem::path& file);
    const char* take(std::uint64_t count) override;
    std::uint64_t position() const override { return position_; }
    bool at_end() const override { return position_ == size_; }
    std::uint64_t size() const { return size_; }
    void seek(std::uint64_t position);
    BigVector<char> range(std::uint64_t begin, std::uint64_t end);

  private:
    std::ifstream stream_;
    std::uint64_t size_ = 0, position_ = 0;
    BigVector<char> taken_;
};

/// A part of a file, read through a window that moves along; what is skipped beyond it is not read.
class FileRange : public ByteSource {
  public:
    /// file  must outlive this, and is left to it alone meanwhile
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

/// Bytes in memory that lay at `file_offset` of a file.
class MemoryBytes : public ByteSource {
  public:
    MemoryBytes(std::span<const char> bytes, std::string where, std::uint64_t file_offset)
        : ByteSource(std::move(where)), bytes_(bytes), file_offset_(file_offset) {}
    const char* take(std::uint64_t count) override;
    std::uint64_t position() const override { return file_offset_ + offset_; }
    std::size_t offset() const { return offset_; }  ///< in `bytes`
    const char* at(std::size_t offset) const { return bytes_.data() + offset; }
    bool at_end() const override { return offset_ == bytes_.size(); }

  private:
    std::span<const char> bytes_;
    std::uint64_t file_offset_;
    std::size_t offset_ = 0;
};

/// std::istream over bytes in memory that stay where they are; a short read throws
/// std::ios_base::failure.
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
