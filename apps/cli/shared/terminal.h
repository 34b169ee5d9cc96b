// terminal.h: what the command says while it works: stage timings, progress bars, notes. All of it
// goes to standard error; standard output holds results only.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "vog/progress.h"
#include "vog/text.h"

namespace vog::cli {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start);

/// Runs `work` as a named stage: a progress bar if it takes longer than a second on a terminal, its
/// time under --verbose and in `times`.
class Stages {
  public:
    explicit Stages(bool verbose) : verbose_(verbose) {}

    template <class Work>
    auto run(const std::string& name, const Work& work) {
        begin(name);
        struct End {
            Stages& stages;
            ~End() { stages.end(); }
        } end_stage{*this};
        return work();
    }
    /// Progress callback for the stage that runs; empty where there is no terminal.
    Progress progress();
    /// Milliseconds per stage, in order.
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

/// One line of standard error that is no failure: what the user should know.
void note(const std::string& text);

}  // namespace vog::cli
