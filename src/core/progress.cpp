// progress.cpp: the interrupt check and the thread limit.
#include "vog/progress.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <ctime>
#include <optional>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog {

struct InterruptCheck::State {
    std::function<void()> check;
    double period_ms = 0;
    double next_ms = 0;      ///< when to look in again
    State* outer = nullptr;  ///< the one that was there before
};

namespace {

// What a thread's calls look in at is a matter of the thread, as TBB's limits are: a token handed
// through forty signatures would reach the same loops.
thread_local InterruptCheck::State* of_this_thread = nullptr;

double clock_ms() {
#ifdef CLOCK_MONOTONIC_COARSE
    // Of the kernel's tick: 1 to 4 ms, at a quarter of the steady clock's price.
    std::timespec now{};
    clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
#else
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double, std::milli>(now).count();
#endif
}

}  // namespace

bool interruptible() { return of_this_thread != nullptr || memory_limited(); }

void look_in() {
    keep_memory();
    InterruptCheck::State* state = of_this_thread;
    if (!state) return;
    const double now = clock_ms();
    if (now < state->next_ms) return;
    // What the check itself calls is not interrupted.
    struct Pause {
        InterruptCheck::State* state = std::exchange(of_this_thread, nullptr);
        ~Pause() { of_this_thread = state; }
    } pause;
    state->next_ms = now + state->period_ms;
    state->check();
}

InterruptCheck::InterruptCheck(std::function<void()> check, double period_ms)
    : state_(std::make_unique<State>()) {
    state_->check = std::move(check);
    state_->period_ms = period_ms;
    state_->next_ms = clock_ms() + period_ms;
    state_->outer = std::exchange(of_this_thread, state_.get());
}
InterruptCheck::~InterruptCheck() { of_this_thread = state_->outer; }

struct ThreadLimit::Control {
    std::optional<tbb::global_control> limit;
};

ThreadLimit::ThreadLimit(int threads) : control_(std::make_unique<Control>()) {
    if (threads > 0)
        control_->limit.emplace(tbb::global_control::max_allowed_parallelism,
                                static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() = default;

int thread_count() {
    const auto allowed = static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    return allowed;
}

}  // namespace vog
