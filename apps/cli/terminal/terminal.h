// terminal.h: standard streams and signals of a command. Standard output holds results only; stage
// timings, progress bars and notes go to standard error.
#pragma once

#include <chrono>
#include <exception>
#include <nlohmann/json_fwd.hpp>
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
/// Prints text of our own, such as that of --help, to standard output.
/// throws vog::Error if it cannot be written
void print_text(const std::string& text);
/// Prints one line of results to standard output, printable.
/// throws vog::Error if it cannot be written
void print_line(const std::string& text);
/// Prints the report of --json to standard output. Bytes that are not UTF-8, which JSON lacks,
/// become U+FFFD.
/// throws vog::Error if it cannot be written
void print_json(const nlohmann::ordered_json& json);
/// JSON on one line, for other processes. Bytes that are not UTF-8 become U+FFFD.
std::string json_line(const nlohmann::ordered_json& json);

/// The first call of a program. Standard streams that are closed stay out of the reach of files
/// opened later, whose content would be mixed with results. A signal that ends the program removes
/// its temporary files first; a file beyond the system's limit (SIGXFSZ) is an error of that write.
void prepare_process();
/// The last call of a program that succeeds: writes what is left in the buffer.
/// throws vog::Error if standard output did not take all results
void finish_output();
/// Prints one line on a failure to standard error, printable: "vog: c.vdb: no such file".
/// exit_code  2, wrong usage: a second line names --help
void print_failure(const std::string& program, const std::string& text, int exit_code = 1);
/// Message of an exception, with file and reason of failures of the file system.
std::string failure_text(const std::exception& error);

}  // namespace vog::cli
