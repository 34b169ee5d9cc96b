// steps.cpp: one thread that reads the nearest missing step.
#include "session/steps.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "vog/error.h"

namespace vog::viewer {

namespace {

constexpr std::size_t kMostAhead = 8;             ///< steps read before they are shown
constexpr std::size_t kMostGaussians = 16000000;  ///< kept: 1 to 3 GB with fields
constexpr std::size_t kMostKept = 256;            ///< steps

}  // namespace

Steps::Steps(std::vector<std::string> files, ReadFiles read)
    : files_(std::move(files)), read_(std::move(read)), thread_([this] { work(); }) {}

Steps::~Steps() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void Steps::want(std::size_t step) {
    {
        const std::lock_guard lock(mutex_);
        if (wanted_ == step) return;
        wanted_ = step;
    }
    wake_.notify_one();
}

std::shared_ptr<const Level> Steps::get(std::size_t step) {
    const std::lock_guard lock(mutex_);
    if (const auto failed = errors_.find(step); failed != errors_.end())
        throw Error(failed->second);
    const auto found = kept_.find(step);
    return found == kept_.end() ? nullptr : found->second;
}

std::size_t Steps::ahead() {
    const std::lock_guard lock(mutex_);
    std::size_t n = 0;
    while (n + 1 < count() && kept_.count((wanted_ + n + 1) % count())) ++n;
    return n;
}

/// The first step from the wanted one on that is to be read; count(): none.
std::size_t Steps::next_missing() const {
    for (std::size_t n = 0; n < std::min(count(), kMostAhead + 1); ++n) {
        const std::size_t step = (wanted_ + n) % count();
        if (!kept_.count(step) && !errors_.count(step)) return step;
    }
    return count();
}

/// Drops the steps that are needed last, while there are too many.
void Steps::drop_others() {
    const auto wait_for = [&](std::size_t step) { return (step + count() - wanted_) % count(); };
    while (true) {
        std::size_t gaussians = 0, last = wanted_;
        for (const auto& [step, level] : kept_) {
            gaussians += level->size();
            if (wait_for(step) > wait_for(last)) last = step;
        }
        if ((gaussians <= kMostGaussians && kept_.size() <= kMostKept) || wait_for(last) < 2)
            return;
        kept_.erase(last);
    }
}

Level Steps::read(std::size_t step) const {
    Content content = read_({files_[step]});
    const std::string name = fmt::format("step {} of {}", step + 1, count());
    if (content.site) {
        Level level = level_of(*content.site);
        level.name = name;
        return level;
    }
    if (content.model.size() == 0)
        throw Error(fmt::format("{}: a model without Gaussians", files_[step]));
    Level level;
    level.name = name;
    level.made_by = content.model.options;
    if (content.hierarchy.empty()) content.hierarchy = build_hierarchy(content.model);
    level.hierarchy = std::make_shared<const Hierarchy>(std::move(content.hierarchy));
    level.model = std::make_shared<const Gaussians>(std::move(content.model));
    return level;
}

void Steps::work() {
    std::unique_lock lock(mutex_);
    while (!end_) {
        const std::size_t step = next_missing();
        if (step == count()) {
            wake_.wait(lock);
            continue;
        }
        lock.unlock();
        std::shared_ptr<const Level> level;
        std::string error;
        try {
            level = std::make_shared<const Level>(read(step));
        } catch (const std::exception& failed) {
            error = failed.what();
        }
        lock.lock();
        if (level)
            kept_[step] = std::move(level);
        else
            errors_[step] = error;
        drop_others();
        // A step that was dropped at once is not read again before another is wanted.
        if (!kept_.count(step) && !errors_.count(step)) wake_.wait(lock);
    }
}

}  // namespace vog::viewer
