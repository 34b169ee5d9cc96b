// paging.h: what loops over much data do for a MemoryLimit (vog/memory.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "vog/memory.h"

namespace vog {

/// Whether one is alive.
bool memory_limited();
/// Lets go of the pages of large arrays where the process has come near its limit. Looks
/// twenty times a millisecond; costs next to nothing in between, and nothing without a limit.
void keep_memory();

/// For loops on one thread that go from page to page: `n` counts their turns. Those that jump
/// between pages call keep_memory() at every turn.
inline void keep_memory_at(std::size_t n) {
    constexpr std::size_t kEvery = 1024;
    if (n % kEvery == kEvery - 1) keep_memory();
}

/// values.resize(count), which writes to every page that is new.
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

/// to.insert(to.end(), from.begin(), from.end()).
template <class T>
void append_kept(BigVector<T>& to, const BigVector<T>& from) {
    constexpr std::size_t kStep = (std::size_t{1} << 20) / sizeof(T);
    const std::size_t together = to.size() + from.size();
    if (to.capacity() < together) {
        BigVector<T> larger;
        larger.reserve(std::max(together, to.empty() ? 0 : 2 * to.capacity()));
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
