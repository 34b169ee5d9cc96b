// progress.cpp: the thread limit.
#include "vog/progress.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <optional>

namespace vog {

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
