// paging.h: calls by which loops over large arrays keep to a MemoryLimit (vog/memory.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "vog/memory.h"

namespace vog {

/// Whether a MemoryLimit is alive.
bool memory_limited();
/// Drops the resident pages of large arrays if the process is near its limit. Checks at most every
/// 50 microseconds; costs one clock read in between, and one load without a limit.
void keep_memory();

/// keep_memory() every 1024 iterations, for sequential loops on one thread; loops with random
/// access call keep_memory() in every iteration.
/// n  iteration
inline void keep_memory_at(std::size_t n) {
    constexpr std::size_t kEvery = 1024;
    if (n % kEvery == kEvery - 1) keep_memory();
}

/// values.resize(count) with keep_memory() after each MiB: resizing writes to every new page.
template <class T>
void resize_kept(BigVector<T>& values, std::size_t count) {
    constexpr std::size_t kStep = (std::size_t{1} << 20) / sizeof(T);
    values.reserve(count);
    while (values.size() + kStep < count) {
        values.resize(values.size() + kStep);
        keep_memory();
    }
    values.resize(count);
}

/// to.insert(to.end(), from.begin(), from.end()) with keep_memory() after each MiB.
template <class T>
void append_kept(BigVector<T>& to, const BigVector<T>& from) {
    constexpr std::size_t kStep = (std::size_t{1} << 20) / sizeof(T);
    const std::size_t total = to.size() + from.size();
    if (to.capacity() < total) {
        BigVector<T> larger;
        larger.reserve(std::max(total, to.empty() ? 0 : 2 * to.capacity()));
        append_kept(larger, to);
        to = std::move(larger);
    }
    for (std::size_t first = 0; first < from.size(); first += kStep) {
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
        const std::size_t count = std::min(kStep, from.size() - first);
        to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
        keep_memory();
    }
}

}  // namespace vog
