// parallel_sort.h: tbb::parallel_sort of what may be larger than memory.
#pragma once

#include <tbb/parallel_sort.h>

#include <functional>

#include "core/paging.h"

namespace vog {

/// As TBB's, on one thread or many; the order must be total, or results depend on the threads.
template <class Values, class Less = std::less<>>
void parallel_sort(Values& values, const Less& less = {}) {
    if (!memory_limited()) {
        tbb::parallel_sort(values.begin(), values.end(), less);
        return;
    }
    tbb::parallel_sort(values.begin(), values.end(), [&less](const auto& a, const auto& b) {
        thread_local std::size_t turns = 0;
        keep_memory_at(turns++);
        return less(a, b);
    });
}

}  // namespace vog
