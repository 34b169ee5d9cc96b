// terminal.h: stage timings, progress bars and notes, all on standard error; standard output holds
// results only.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "vog/progress.h"
#include "vog/text.h"

namespace vog::cli {

using Clock = std::chrono::steady_clock;

/// Elapsed time, ms.
double milliseconds_since(Clock::time_point start);

/// Named, timed stages of a command, with progress bars.
class Stages {
  public:
    explicit Stages(bool verbose) : verbose_(verbose) {}

    /// Runs `work` as a stage; shows a progress bar after a second on a terminal, and its time
    /// where verbose.
    template <class Work>
    auto run(const std::string& name, const Work& work) {
        begin(name);
        struct End {
            Stages& stages;
            ~End() { stages.end(); }
        } end_stage{*this};
        return work();
    }
    /// Progress callback of the current stage; empty where standard error is no terminal.
    Progress progress();
    /// Name and time (ms) of each stage, in the order they ran.
    const std::vector<std::pair<std::string, double>>& times() const { return times_; }

  private:
    void begin(const std::string& name);
    void end();

    bool verbose_ = false;
    bool bar_shown_ = false;
    Clock::time_point start_, last_shown_;
    std::string name_;
    std::vector<std::pair<std::string, double>> times_;
};

/// Prints one line that is no failure to standard error.
void note(const std::string& text);

}  // namespace vog::cli
