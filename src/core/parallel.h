// parallel.h: tbb::parallel_for that an InterruptCheck (vog/progress.h) can end.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <type_traits>

namespace vog {

/// Whether an InterruptCheck of this thread or a MemoryLimit is alive.
bool interruptible();
/// Calls keep_memory(), and this thread's InterruptCheck if its period has passed. For long loops
/// on one thread; about 5 ns.
/// throws whatever the check throws
void check_interrupt();

/// tbb::parallel_for; the calling thread calls check_interrupt() before each of its pieces. After a
/// throw, the remaining pieces are skipped and the exception leaves the loop. Callers qualify it as
/// vog::parallel_for, because argument-dependent lookup on ranges also finds TBB's.
template <class Range, class Body, class... Partitioner>
void parallel_for(const Range& range, const Body& body, const Partitioner&... partitioner) {
    if (!interruptible()) {
        tbb::parallel_for(range, body, partitioner...);
        return;
    }
    std::atomic<bool> ended{false};
    tbb::parallel_for(
        range,
        [&](const Range& piece) {
            if (ended.load(std::memory_order_relaxed)) return;
            try {
                check_interrupt();
            } catch (...) {
                ended = true;
                throw;
            }
            body(piece);
        },
        partitioner...);
}

template <class Index, class Body>
requires std::is_integral_v<Index>
void parallel_for(Index begin, Index end, const Body& body) {
    if (!interruptible()) {
        tbb::parallel_for(begin, end, body);
        return;
    }
    // TBB's pieces of a range may be long: the check is made for each index.
    std::atomic<bool> ended{false};
    tbb::parallel_for(tbb::blocked_range<Index>(begin, end),
                      [&](const tbb::blocked_range<Index>& piece) {
                          const bool own = interruptible();
                          try {
                              for (Index n = piece.begin(); n < piece.end(); ++n) {
                                  if (ended.load(std::memory_order_relaxed)) return;
                                  if (own) check_interrupt();
                                  body(n);
                              }
                          } catch (...) {
                              ended = true;
                              throw;
                          }
                      });
}

}  // namespace vog
