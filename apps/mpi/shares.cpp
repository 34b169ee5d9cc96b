// shares.cpp: greedy assignment of files to ranks by size.
#include "shares.h"
#include "vog/distributed.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace vog::mpi {

namespace {

/// Bytes; 0 for a missing file, which its reader reports.
std::uint64_t size_of(const std::string& file) {
    std::error_code code;
    const std::uintmax_t size = std::filesystem::file_size(file, code);
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

std::vector<std::optional<VolumePart>> shares_of(std::span<const std::string> files,
                                                 const Ranks& ranks) {
    // With four files of one size per rank, the busiest rank has at most a quarter more than its
    // share.
    constexpr std::size_t kManyFiles = 4;
    const auto count = static_cast<std::size_t>(ranks.count());
    std::vector<std::optional<VolumePart>> shares(files.size());
    if (files.size() < kManyFiles * count) {
        for (auto& share : shares) share = VolumePart{ranks.rank(), ranks.count()};
        return shares;
    }
    const std::vector<bool> mine = whole_files_of(files, ranks);
    for (std::size_t n = 0; n < files.size(); ++n)
        if (mine[n]) shares[n] = VolumePart{};
    return shares;
}

}  // namespace vog::mpi
