// vog/progress.h: how long calls report, how they are ended, how many threads they may use.
#pragma once

#include <functional>
#include <memory>

namespace vog {

/// Called with the finished fraction in [0, 1], from any thread but never from two at once.
/// Throwing from it ends the call that reports.
using Progress = std::function<void(double)>;

/// While alive, the calls that its thread makes into vog look in at `check` every `period_ms` or
/// so, on that thread, from wherever they are. Throwing from it ends the call: the exception comes
/// out of it, nothing is left half written. A look at the clock costs 5 ns; what OpenVDB
/// does for vog (decompressing a grid) is waited for.
class InterruptCheck {
  public:
    explicit InterruptCheck(std::function<void()> check, double period_ms = 20);
    ~InterruptCheck();
    InterruptCheck(const InterruptCheck&) = delete;
    InterruptCheck& operator=(const InterruptCheck&) = delete;

    struct State;

  private:
    std::unique_ptr<State> state_;
};

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
