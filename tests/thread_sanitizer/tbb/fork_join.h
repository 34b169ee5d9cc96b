// fork_join.h: what vog uses of TBB, on plain threads: for the thread sanitizer alone. Debian's TBB
// is not built with the sanitizer, which then sees neither its hand-over of work nor the end of a
// loop and reports every loop; suppressing those reports suppresses ours, whose stacks all pass
// through TBB. Here each loop starts threads, which take chunks in any order, and joins them: the
// sanitizer sees all of it, and races between our tasks are reported as such.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <list>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace tbb {

template <class T>
class blocked_range {
  public:
    blocked_range(T begin, T end, std::size_t grain = 1)
        : begin_(begin), end_(end), grain_(grain) {}
    T begin() const { return begin_; }
    T end() const { return end_; }
    std::size_t size() const { return end_ > begin_ ? static_cast<std::size_t>(end_ - begin_) : 0; }
    bool empty() const { return size() == 0; }
    std::size_t grainsize() const { return grain_; }

  private:
    T begin_, end_;
    std::size_t grain_;
};

/// Calls body(chunk number, piece of range) from several threads; the first exception ends the
/// loop. Chunks are dealt out beforehand: if they were taken, one quick thread might take them all,
/// and there would be no race to see.
template <class T, class Body>
void fork_join(const blocked_range<T>& range, std::size_t chunks, const Body& body) {
    constexpr std::size_t kThreads = 4;
    std::atomic<bool> failed{false};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto at = [&](std::size_t chunk) {
        return range.begin() + static_cast<T>(range.size() * chunk / chunks);
    };
    const auto work = [&](std::size_t thread) {
        try {
            for (std::size_t n = thread; n < chunks && !failed; n += kThreads)
                body(n, blocked_range<T>(at(n), at(n + 1)));
        } catch (...) {
            const std::lock_guard lock(mutex);
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t n = 0; n < std::min(kThreads, chunks); ++n) threads.emplace_back(work, n);
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
}

template <class T>
std::size_t chunks_of(const blocked_range<T>& range) {
    constexpr std::size_t kMost = 16;
    return std::min(kMost, (range.size() + range.grainsize() - 1) / range.grainsize());
}

struct simple_partitioner {};
template <class T, class Body>
void parallel_for(const blocked_range<T>& range, const Body& body, simple_partitioner = {}) {
    fork_join(range, chunks_of(range),
              [&](std::size_t, const blocked_range<T>& piece) { body(piece); });
}
template <class T, class Body>
void parallel_for(T begin, T end, const Body& body) {
    parallel_for(blocked_range<T>(begin, end), [&](const blocked_range<T>& piece) {
        for (T n = piece.begin(); n < piece.end(); ++n) body(n);
    });
}

template <class T, class Value, class Body, class Join>
Value parallel_reduce(const blocked_range<T>& range, const Value& identity, const Body& body,
                      const Join& join) {
    std::vector<Value> parts(chunks_of(range), identity);
    fork_join(range, parts.size(), [&](std::size_t n, const blocked_range<T>& piece) {
        parts[n] = body(piece, identity);
    });
    Value all = identity;
    for (const Value& part : parts) all = join(all, part);
    return all;
}
template <class T, class Value, class Body, class Join>
Value parallel_deterministic_reduce(const blocked_range<T>& range, const Value& identity,
                                    const Body& body, const Join& join) {
    return parallel_reduce(range, identity, body, join);
}

template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
    std::sort(begin, end, less);
}
template <class Iterator>
void parallel_sort(Iterator first, Iterator last) {
    std::sort(first, last);
}

template <class T>
class enumerable_thread_specific {
  public:
    T& local() {
        const std::lock_guard lock(mutex_);
        T*& mine = of_thread_[std::this_thread::get_id()];
        if (mine == nullptr) mine = &all_.emplace_back();
        return *mine;
    }
    auto begin() { return all_.begin(); }
    auto end() { return all_.end(); }

  private:
    std::mutex mutex_;
    std::list<T> all_;
    std::map<std::thread::id, T*> of_thread_;
};

class global_control {
  public:
    enum parameter { max_allowed_parallelism };
    global_control(parameter, std::size_t) {}
    static std::size_t active_value(parameter) { return 4; }
};

}  // namespace tbb
