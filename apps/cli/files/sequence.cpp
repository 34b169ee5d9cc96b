// sequence.cpp: file patterns, output names and concurrent frames.
#include "files/sequence.h"

#include <fmt/core.h>
#include <glob.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

#include "files/inputs.h"
#include "vog/error.h"
#include "vog/ply.h"
#include "vog/progress.h"

namespace vog::cli {

namespace fs = std::filesystem;

namespace {

/// Natural order: digits compare by their value, frame_2 before frame_10.
bool natural_less(const std::string& a, const std::string& b) {
    const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (!digit(a[i]) || !digit(b[j])) {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i, ++j;
            continue;
        }
        const auto number_end = [&](const std::string& text, std::size_t from) {
            while (from < text.size() && digit(text[from])) ++from;
            return from;
        };
        while (i + 1 < a.size() && a[i] == '0' && digit(a[i + 1])) ++i;
        while (j + 1 < b.size() && b[j] == '0' && digit(b[j + 1])) ++j;
        const std::size_t i_end = number_end(a, i), j_end = number_end(b, j);
        if (i_end - i != j_end - j) return i_end - i < j_end - j;
        const int order = a.compare(i, i_end - i, b, j, j_end - j);
        if (order != 0) return order < 0;
        i = i_end, j = j_end;
    }
    return a.size() - i < b.size() - j;
}

}  // namespace

std::vector<std::string> expanded(const std::vector<std::string>& inputs) {
    std::vector<std::string> files;
    for (const std::string& input : inputs) {
        std::error_code code;
        const std::string extension = extension_of(input);
        const bool stack = extension == ".tif" || extension == ".tiff";
        if (stack || input.find_first_of("*?") == std::string::npos || fs::exists(input, code)) {
            files.push_back(input);
            continue;
        }
        glob_t found{};
        const int status = ::glob(input.c_str(), 0, nullptr, &found);
        std::vector<std::string> matches(found.gl_pathv, found.gl_pathv + found.gl_pathc);
        ::globfree(&found);
        if (status != 0 || matches.empty()) throw Error(fmt::format("{}: no such files", input));
        std::ranges::sort(matches, natural_less);
        files.insert(files.end(), matches.begin(), matches.end());
    }
    return files;
}

bool is_sequence(const std::string& output) {
    std::error_code code;
    return output.ends_with('/') || fs::is_directory(output, code);
}

std::vector<Frame> frames_of(const std::vector<std::string>& inputs, const std::string& folder,
                             const std::string& extension) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (std::error_code ignored; !fs::is_directory(folder, ignored))
        throw Error(fmt::format("{}: cannot create this folder: {}", folder, code.message()));
    std::vector<Frame> frames;
    std::map<fs::path, std::string> owner;
    for (const std::string& input : inputs) {
        const fs::path output = fs::path(folder) / (fs::path(input).stem().string() + extension);
        const auto [other, is_new] = owner.emplace(output, input);
        if (!is_new)
            throw Error(fmt::format("{} would be written for both {} and {}", output.string(),
                                    other->second, input));
        if (fs::equivalent(output, input, code))
            throw Error(fmt::format("{} is an input and would be overwritten", input));
        frames.push_back({input, output.string()});
    }
    return frames;
}

bool is_fresh(const Frame& frame) {
    std::error_code missing;
    const auto made = fs::last_write_time(frame.output, missing);
    if (missing) return false;
    const auto given = fs::last_write_time(frame.input, missing);
    return !missing && made > given && is_whole_ply(frame.output);
}

void for_each_frame(const std::vector<Frame>& frames, std::uint64_t memory,
                    const std::function<std::uint64_t(const Frame&)>& need,
                    const std::function<void(const Frame&)>& work) {
    std::uint64_t most = 1;
    if (memory > 0)
        for (const Frame& frame : frames) most = std::max(most, need(frame));
    const std::uint64_t fit = memory > 0 ? std::max<std::uint64_t>(1, memory / most) : 1;
    const auto at_once = std::min<std::uint64_t>(fit, static_cast<std::uint64_t>(thread_count()));
    // Threads outside of TBB: a TBB worker that waits in one frame's loop would begin another
    // frame.
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr first_error;
    const auto run_frames = [&] {
        for (std::size_t n = next++; n < frames.size(); n = next++) {
            try {
                work(frames[n]);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!first_error) first_error = std::current_exception();
                next = frames.size();
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        for (std::uint64_t n = 1; n < std::min<std::uint64_t>(at_once, frames.size()); ++n)
            threads.emplace_back(run_frames);
        run_frames();
    }
    if (first_error) std::rethrow_exception(first_error);
}

}  // namespace vog::cli
