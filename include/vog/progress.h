// vog/progress.h: progress reports, interruption and the number of threads of long calls.
#pragma once

#include <functional>
#include <memory>

namespace vog {

/// Callback with the finished fraction of a call, in [0, 1]. Called from any thread, never from two
/// at once. An exception from it ends the call that reports, and leaves that call. Empty: no
/// reports.
using Progress = std::function<void(double)>;

/// Scope in which long calls of this thread can be interrupted: they call `check` about every
/// `period_ms`, on this thread. An exception from `check` ends the call and leaves it; no file is
/// left half written. Work inside OpenVDB (decompressing a grid) is not interrupted.
/// cost  5 ns for each reading of the clock
class InterruptCheck {
  public:
    /// check      throws to interrupt
    /// period_ms  least time between two calls of `check`, milliseconds, >= 0
    explicit InterruptCheck(std::function<void()> check, double period_ms = 20);
    ~InterruptCheck();
    InterruptCheck(const InterruptCheck&) = delete;
    InterruptCheck& operator=(const InterruptCheck&) = delete;

    struct State;

  private:
    std::unique_ptr<State> state_;
};

/// Scope in which vog's parallel loops, in the whole process, use at most `threads` threads.
class ThreadLimit {
  public:
    /// threads  >= 1; 0 or less: all cores
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    struct Control;
    std::unique_ptr<Control> control_;
};

/// Number of threads that vog's parallel loops use at present, >= 1.
int thread_count();

}  // namespace vog
