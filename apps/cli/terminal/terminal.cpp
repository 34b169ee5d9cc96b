// terminal.cpp: printing with every failure reported, and signals.
#include "terminal/terminal.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "vog/error.h"
#include "vog/temporary_file.h"

namespace vog::cli {

namespace {

/// Prints to standard error. Without one there is nobody to report the failure to.
void print_aside(const std::string& text) {
    (void)std::fwrite(text.data(), 1, text.size(), stderr);
    (void)std::fflush(stderr);
}

[[noreturn]] void fail_output(int error) {
    throw Error("standard output: cannot write: " +
                std::generic_category().message(error ? error : EIO));
}

/// Handler of signals that end the program, by their default action, when it returns.
extern "C" void end_by_signal(int number) {
    remove_temporary_files();
    (void)std::signal(number, SIG_DFL);
    (void)::raise(number);
}

}  // namespace

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
    if (bar_shown_) print_aside("\r\033[K");
    if (verbose_) print_aside(fmt::format("{:<10} {:>10.1f} ms\n", name_, ms));
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
        print_aside(fmt::format("\r{:<10} [{:#<{}}{:<{}}] {:3.0f} %", name_, "", filled, "",
                                kWidth - filled, 100 * fraction));
        bar_shown_ = true;
        last_shown_ = Clock::now();
    };
}

void note(const std::string& text) { print_failure("vog: note", text); }

void print_text(const std::string& text) {
    errno = 0;
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_output(errno);
}

void print_line(const std::string& text) { print_text(printable(text) + "\n"); }

void print_json(const nlohmann::ordered_json& json) {
    print_text(json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

std::string json_line(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void prepare_process() {
    // In the order of their numbers, as each open takes the lowest free one. Against their direction:
    // every use fails, as with a closed stream.
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0)
            (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    (void)std::signal(SIGXFSZ, SIG_IGN);
    for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM, SIGXCPU}) {
        struct sigaction action {};
        // Signals that the parent has made us ignore, such as nohup's, stay ignored.
        if (::sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = end_by_signal;
        (void)::sigaction(number, &action, nullptr);
    }
}

void finish_output() {
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) fail_output(errno);
}

void print_failure(const std::string& program, const std::string& text, int exit_code) {
    print_aside(program + ": " + printable(text) + "\n" +
                (exit_code == 2 ? "Run with --help for usage.\n" : ""));
}

std::string failure_text(const std::exception& error) {
    const auto* files = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
    if (!files) return error.what();
    return files->path1().string() + ": " + files->code().message();
}

}  // namespace vog::cli
