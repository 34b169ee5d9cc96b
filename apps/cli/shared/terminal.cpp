// terminal.cpp: progress bars and notes on standard error.
#include "shared/terminal.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>

namespace vog::cli {

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void Stages::begin(const std::string& name) {
    name_ = name;
    bar_shown_ = false;
    start_ = last_shown_ = Clock::now();
}

void Stages::end() {
    const double ms = milliseconds_since(start_);
    if (bar_shown_) fmt::print(stderr, "\r\033[K");
    if (verbose_) fmt::print(stderr, "{:<10} {:>10.1f} ms\n", name_, ms);
    times_.emplace_back(name_, ms);
}

Progress Stages::progress() {
    if (!isatty(STDERR_FILENO)) return {};
    return [this](double fraction) {
        constexpr double kQuietMs = 1000, kRefreshMs = 100;
        constexpr int kWidth = 30;
        if (milliseconds_since(start_) < kQuietMs) return;
        if (bar_shown_ && milliseconds_since(last_shown_) < kRefreshMs) return;
        const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
        fmt::print(stderr, "\r{:<10} [{:#<{}}{:<{}}] {:3.0f} %", name_, "", filled, "",
                   kWidth - filled, 100 * fraction);
        bar_shown_ = true;
        last_shown_ = Clock::now();
    };
}

void note(const std::string& text) { fmt::print(stderr, "vog: note: {}\n", text); }

}  // namespace vog::cli
