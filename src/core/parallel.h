// parallel.h: tbb::parallel_for that a call's owner can end (InterruptCheck in vog/progress.h).
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <type_traits>

namespace vog {

/// Whether an InterruptCheck of this thread is alive.
bool interruptible();
/// Calls it if its time has come. For long loops on one thread; costs 5 ns.
void look_in();

/// As TBB's. The thread that began the loop looks in as it works; once its check has thrown, the
/// others leave what they have begun. Called as vog::parallel_for: the ranges bring TBB's own name.
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
                look_in();
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
    // TBB's pieces of a range may be long: looks in at each index.
    std::atomic<bool> ended{false};
    tbb::parallel_for(tbb::blocked_range<Index>(begin, end),
                      [&](const tbb::blocked_range<Index>& piece) {
                          const bool own = interruptible();
                          try {
                              for (Index n = piece.begin(); n < piece.end(); ++n) {
                                  if (ended.load(std::memory_order_relaxed)) return;
                                  if (own) look_in();
                                  body(n);
                              }
                          } catch (...) {
                              ended = true;
                              throw;
                          }
                      });
}

}  // namespace vog
