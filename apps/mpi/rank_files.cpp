// rank_files.cpp: greedy assignment of files to ranks by size; sizes, times and contents compared.
#include "rank_files.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog::mpi {

namespace {

struct FileStatus {
    std::uint64_t bytes = 0, device = 0, inode = 0;
    std::int64_t seconds = 0, nanoseconds = 0;  ///< of the last change, since 1970
};

/// File that changes with an input: of a site its manifest, which names all others by their content.
std::string file_of(const std::string& input) {
    const auto site = find_site(input);
    return site ? (site->folder / "manifest.json").string() : input;
}

/// throws vog::Error for a file that is not there; its reader reports all other faults
FileStatus status_of(const std::string& file) {
    struct stat status {};
    if (::stat(file_of(file).c_str(), &status) != 0)
        throw Error(fmt::format("{}: no such file", file));
    return {static_cast<std::uint64_t>(status.st_size), status.st_dev, status.st_ino,
            status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

/// FNV-1a on words of 64 bits, with the upper half mixed into the lower: not for adversaries.
std::uint64_t hash_of(std::span<const char> bytes, std::uint64_t hash) {
    for (std::size_t at = 0; at < bytes.size(); at += sizeof hash) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min(sizeof word, bytes.size() - at));
        hash = (hash ^ word) * 0x100000001b3;
        hash ^= hash >> 32;
    }
    return hash;
}

/// Hash of a file's contents: of all bytes, or of 16 pieces of 64 KiB from its first to its last
/// byte, which take a few ms.
std::uint64_t hash_of_file(const std::string& file, std::uint64_t bytes, bool whole) {
    constexpr std::uint64_t kPiece = 1 << 16, kPieces = 16;
    std::ifstream in(file_of(file), std::ios::binary);
    std::vector<char> piece(kPiece);
    std::uint64_t hash = 0xcbf29ce484222325;
    const std::uint64_t pieces =
        whole || bytes <= kPieces * kPiece ? (bytes + kPiece - 1) / kPiece : kPieces;
    for (std::uint64_t n = 0; n < pieces; ++n) {
        if (pieces == kPieces && bytes > kPieces * kPiece)
            in.seekg(static_cast<std::streamoff>((bytes - kPiece) * n / (kPieces - 1)));
        in.read(piece.data(), static_cast<std::streamsize>(kPiece));
        hash = hash_of({piece.data(), static_cast<std::size_t>(in.gcount())}, hash);
    }
    return hash;
}

/// Everything that a later write or rename changes.
std::string stamp_of(const std::string& file) {
    const FileStatus status = status_of(file);
    return fmt::format("{} {} {} {} {}", status.bytes, status.device, status.inode, status.seconds,
                       status.nanoseconds);
}

/// throws vog::Error, on every rank, where a rank's text differs from the root's
void require_equal(const std::string& file, const std::string& text, const Ranks& ranks) {
    const std::vector<std::string> all = ranks.gather(text);
    const auto other = std::ranges::find_if(all, [&](const auto& one) { return one != all[0]; });
    if (other == all.end()) return;
    throw Error(
        fmt::format("{}: is another file on rank {} ({}) than on rank 0 ({}), expected one file, "
                    "or copies of it",
                    file, other - all.begin(), *other, all[0]));
}

/// Bytes; 0 for a missing file, which its reader reports.
std::uint64_t size_of(const std::string& file) {
    std::error_code code;
    const std::uintmax_t size = std::filesystem::file_size(file_of(file), code);
    return code ? 0 : size;
}

}  // namespace

std::vector<bool> whole_files_of(std::span<const std::string> files, const Ranks& ranks) {
    // The root's sizes are used by all, so that ranks divide alike even if they see other files.
    std::vector<std::uint64_t> sizes(files.size());
    if (ranks.first()) std::transform(files.begin(), files.end(), sizes.begin(), size_of);
    ranks.sum(sizes);
    std::vector<std::size_t> order(files.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t n) { return sizes[n]; });
    std::vector<std::uint64_t> load(static_cast<std::size_t>(ranks.count()));
    std::vector<bool> mine(files.size());
    for (const std::size_t n : order) {
        const auto least = std::ranges::min_element(load) - load.begin();
        mine[n] = least == ranks.rank();
        load[static_cast<std::size_t>(least)] += std::max<std::uint64_t>(sizes[n], 1);
    }
    return mine;
}

bool are_many(std::size_t files, const Ranks& ranks) {
    // With four files of one size per rank, the busiest rank has at most a quarter more than its
    // share.
    constexpr std::size_t kManyFiles = 4;
    return files >= kManyFiles * static_cast<std::size_t>(ranks.count());
}

std::vector<std::optional<VolumePart>> shares_of(std::span<const std::string> files,
                                                 const Ranks& ranks) {
    std::vector<std::optional<VolumePart>> shares(files.size());
    if (!are_many(files.size(), ranks)) {
        for (auto& share : shares) share = VolumePart{ranks.rank(), ranks.count()};
        return shares;
    }
    const std::vector<bool> mine = whole_files_of(files, ranks);
    for (std::size_t n = 0; n < files.size(); ++n)
        if (mine[n]) shares[n] = VolumePart{};
    return shares;
}

SameFiles::SameFiles(std::span<const std::string> files, const Ranks& ranks, bool divided)
    : files_(files.begin(), files.end()) {
    for (const std::string& file : files_) stamps_.push_back(stamp_of(file));
    if (ranks.count() == 1) return;
    require_equal("inputs", fmt::format("{} files", files_.size()), ranks);
    for (const std::string& file : files_) {
        const FileStatus status = status_of(file);
        require_equal(file, fmt::format("{}, {} bytes", file, status.bytes), ranks);
        if (!divided) continue;
        const auto seconds = static_cast<double>(status.seconds);
        const bool one_time =
            ranks.max(seconds) == ranks.min(seconds) &&
            ranks.max(double(status.nanoseconds)) == ranks.min(double(status.nanoseconds));
        require_equal(file,
                      fmt::format("{} bytes, contents {:016x}", status.bytes,
                                  hash_of_file(file, status.bytes, !one_time)),
                      ranks);
    }
}

void SameFiles::check_unchanged() const {
    for (std::size_t n = 0; n < files_.size(); ++n)
        if (stamp_of(files_[n]) != stamps_[n])
            throw Error(fmt::format(
                "{}: has changed while it was read, expected a file that nothing writes",
                files_[n]));
}

}  // namespace vog::mpi
