// scan_bytes.h: bytes of plain, deflated and hexadecimal files, forward only.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "vog/memory.h"

namespace vog::scan {

/// How a file has its values: as bytes, as bytes packed by gzip or zlib, as hexadecimal digits of bytes, or as numbers in words.
enum class Encoding { raw, deflate, hex, text };

/// Bytes of a file, unpacked where they are deflated or hexadecimal, forward only.
class ScanBytes {
  public:
    /// Most bytes of one read_some.
    static constexpr std::uint64_t kStep = std::uint64_t{1} << 18;

    /// encoding  any but text
    explicit ScanBytes(const std::filesystem::path& file, std::uint64_t begin = 0,
                       Encoding encoding = Encoding::raw);
    ~ScanBytes();
    ScanBytes(const ScanBytes&) = delete;
    ScanBytes& operator=(const ScanBytes&) = delete;

    /// Reads the next bytes.
    /// throws vog::Error where there are fewer
    void read(char* to, std::uint64_t count);
    void skip(std::uint64_t count);
    /// Reads up to `count` bytes. Returns their number, 0 at the end.
    std::uint64_t read_some(char* to, std::uint64_t count);
    std::uint64_t position() const { return position_; }
    /// Most bytes that can follow: those of the file, times deflate's largest ratio.
    std::uint64_t most_left() const;

  private:
    void refill();
    std::uint64_t read_digits(char* to, std::uint64_t count);

    std::string name_;
    std::ifstream stream_;
    std::uint64_t size_ = 0, read_ = 0, position_ = 0;
    std::vector<char> packed_;
    z_stream zip_{};
    Encoding encoding_ = Encoding::raw;
    bool between_members_ = false, ended_ = false;
};

/// Whether a file begins with the bytes of gzip.
bool is_gzip(const std::filesystem::path& file);

/// Unpacks a gzip'd or zlib'd file.
BigVector<char> unpacked_bytes(const std::filesystem::path& file);

}  // namespace vog::scan
