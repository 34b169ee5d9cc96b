// scan_bytes.cpp: reading and unpacking of files, step by step.
#include "io/scan/scan_bytes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

/// Largest ratio of deflate: 258 bytes for two bits, and some bytes of head.
constexpr std::uint64_t kMostRatio = 1032, kHead = 4096;

}  // namespace

bool is_gzip(const std::filesystem::path& file) {
    require_readable(file);
    std::ifstream stream(file, std::ios::binary);
    return stream.get() == 0x1f && stream.get() == 0x8b;
}

ScanBytes::ScanBytes(const std::filesystem::path& file, std::uint64_t begin, Encoding encoding)
    : name_(file.string()), encoding_(encoding) {
    require_readable(file);
    stream_.open(file, std::ios::binary | std::ios::ate);
    const auto end = stream_.tellg();
    if (!stream_ || end < 0) throw Error(fmt::format("{}: cannot be read", name_));
    size_ = static_cast<std::uint64_t>(end);
    if (begin > size_)
        throw Error(fmt::format("{}: truncated: {} bytes, expected values from byte {} on", name_,
                                size_, begin));
    read_ = begin;
    stream_.seekg(static_cast<std::streamoff>(begin));
    // 15 bits of window; + 32: gzip or zlib, as the head says.
    if (encoding_ == Encoding::deflate && inflateInit2(&zip_, 15 + 32) != Z_OK)
        throw Error(fmt::format("{}: not enough memory", name_));
}

ScanBytes::~ScanBytes() {
    if (encoding_ == Encoding::deflate) inflateEnd(&zip_);
}

std::uint64_t ScanBytes::most_left() const {
    const std::uint64_t left = size_ - read_;
    if (encoding_ == Encoding::raw) return left;
    if (encoding_ == Encoding::hex) return (left + zip_.avail_in) / 2;
    return (left + zip_.avail_in + kHead) * kMostRatio;
}

void ScanBytes::refill() {
    const std::uint64_t count = std::min(kStep, size_ - read_);
    packed_.resize(count);
    if (count > 0 && !stream_.read(packed_.data(), static_cast<std::streamsize>(count)))
        throw Error(fmt::format("{}: cannot be read", name_));
    read_ += count;
    zip_.next_in = reinterpret_cast<Bytef*>(packed_.data());
    zip_.avail_in = static_cast<uInt>(count);
}

std::uint64_t ScanBytes::read_digits(char* to, std::uint64_t count) {
    std::uint64_t got = 0;
    std::optional<std::size_t> high;
    while (got < count) {
        if (zip_.avail_in == 0) refill();
        if (zip_.avail_in == 0) break;
        const unsigned char c = *zip_.next_in;
        ++zip_.next_in, --zip_.avail_in;
        if (std::isspace(c) != 0) continue;
        const std::size_t digit =
            std::string_view("0123456789abcdef").find(static_cast<char>(std::tolower(c)));
        if (digit == std::string_view::npos)
            throw Error(fmt::format("{}: '{}' among hexadecimal digits", name_,
                                    printable(std::string(1, static_cast<char>(c)))));
        if (high)
            to[got++] = static_cast<char>(16 * *high + digit), high.reset();
        else
            high = digit;
    }
    if (high) throw Error(fmt::format("{}: truncated: an odd number of digits", name_));
    return got;
}

std::uint64_t ScanBytes::read_some(char* to, std::uint64_t count) {
    if (encoding_ == Encoding::hex) return read_digits(to, count);
    if (encoding_ == Encoding::raw) {
        count = std::min(count, size_ - read_);
        if (count > 0 && !stream_.read(to, static_cast<std::streamsize>(count)))
            throw Error(fmt::format("{}: cannot be read", name_));
        read_ += count;
        return count;
    }
    zip_.next_out = reinterpret_cast<Bytef*>(to);
    zip_.avail_out = static_cast<uInt>(std::min(count, kStep));
    const uInt wanted = zip_.avail_out;
    while (zip_.avail_out == wanted && !ended_) {
        if (zip_.avail_in == 0) {
            refill();
            if (zip_.avail_in == 0) {
                if (between_members_) {
                    ended_ = true;
                    break;
                }
                throw Error(fmt::format(
                    "{}: truncated: a deflated stream of {} bytes without its end", name_, size_));
            }
        }
        if (between_members_) {
            // Several members make one stream, as those of pigz and bgzip; zeros may pad it.
            if (*zip_.next_in != 0x1f) {
                if (const auto in = zip_.next_in, end = in + zip_.avail_in;
                    std::any_of(in, end, [](Bytef byte) { return byte != 0; }))
                    throw Error(fmt::format(
                        "{}: {} bytes or more behind the end of the deflated stream, expected none",
                        name_, zip_.avail_in));
                ended_ = true;
                break;
            }
            inflateReset(&zip_);
            between_members_ = false;
        }
        const int status = inflate(&zip_, Z_NO_FLUSH);
        if (status == Z_STREAM_END)
            between_members_ = true;
        else if (status != Z_OK && status != Z_BUF_ERROR)
            throw Error(fmt::format("{}: corrupt deflated stream ({}), expected gzip or zlib",
                                    name_, zip_.msg ? zip_.msg : "unknown fault"));
    }
    return wanted - zip_.avail_out;
}

void ScanBytes::read(char* to, std::uint64_t count) {
    for (std::uint64_t done = 0; done < count;) {
        const std::uint64_t got = read_some(to + done, count - done);
        if (got == 0)
            throw Error(fmt::format("{}: truncated: {} bytes{}, expected {} or more", name_,
                                    position_, encoding_ == Encoding::raw ? "" : " unpacked",
                                    position_ + count - done));
        done += got;
        position_ += got;
    }
}

void ScanBytes::skip(std::uint64_t count) {
    if (encoding_ == Encoding::raw) {
        if (count > size_ - read_)
            throw Error(fmt::format("{}: truncated: {} bytes, expected {} or more", name_, size_,
                                    read_ + count));
        read_ += count;
        position_ += count;
        stream_.seekg(static_cast<std::streamoff>(read_));
        return;
    }
    std::vector<char> buffer(std::min(count, kStep));
    while (count > 0) {
        const std::uint64_t step = std::min<std::uint64_t>(count, buffer.size());
        read(buffer.data(), step);
        count -= step;
    }
}

BigVector<char> unpacked_bytes(const std::filesystem::path& file) {
    ScanBytes bytes(file, 0, Encoding::deflate);
    BigVector<char> all;
    std::vector<char> step(ScanBytes::kStep);
    while (const std::uint64_t got = bytes.read_some(step.data(), step.size())) {
        all.insert(all.end(), step.begin(), step.begin() + static_cast<std::ptrdiff_t>(got));
        keep_memory();
    }
    return all;
}

}  // namespace vog::scan
