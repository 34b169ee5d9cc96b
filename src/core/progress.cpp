// progress.cpp: interrupt checks of threads, and the limit on TBB's threads.
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
    double next_ms = 0;      ///< clock time of the next call
    State* outer = nullptr;  ///< enclosing check of this thread
};

namespace {

// Innermost check of this thread. A thread-local, as TBB's limits are: the alternative, a token
// parameter in forty signatures, would end the same loops.
thread_local InterruptCheck::State* current_check = nullptr;

double clock_ms() {
#ifdef CLOCK_MONOTONIC_COARSE
    // Resolution of the kernel's tick, 1 to 4 ms, in a quarter of the steady clock's time.
    std::timespec now{};
    clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
#else
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double, std::milli>(now).count();
#endif
}

}  // namespace

bool interruptible() { return current_check != nullptr || memory_limited(); }

void check_interrupt() {
    keep_memory();
    InterruptCheck::State* state = current_check;
    if (!state) return;
    const double now = clock_ms();
    if (now < state->next_ms) return;
    // Calls made by the check itself are not interrupted.
    struct Pause {
        InterruptCheck::State* state = std::exchange(current_check, nullptr);
        ~Pause() { current_check = state; }
    } pause;
    state->next_ms = now + state->period_ms;
    state->check();
}

InterruptCheck::InterruptCheck(std::function<void()> check, double period_ms)
    : state_(std::make_unique<State>()) {
    state_->check = std::move(check);
    state_->period_ms = period_ms;
    state_->next_ms = clock_ms() + period_ms;
    state_->outer = std::exchange(current_check, state_.get());
}
InterruptCheck::~InterruptCheck() { current_check = state_->outer; }

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
