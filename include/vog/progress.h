// vog/progress.h: how long calls report and how many threads they may use.
#pragma once

#include <functional>
#include <memory>

namespace vog {

/// Called with the finished fraction in [0, 1], from any thread but never from two at once.
/// Throwing from it ends the call that reports.
using Progress = std::function<void(double)>;

/// While alive, vog's parallel loops in this process use at most `threads` threads (0: all cores).
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Threads vog's loops use now.
int thread_count();

}  // namespace vog
