// memory_options.cpp: help and evaluation of the memory options.
#include "options/memory_options.h"

#include <fmt/core.h>

#include <charconv>
#include <CLI/CLI.hpp>
#include <exception>
#include <map>

#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "terminal/terminal.h"
#include "terminal/usage_error.h"

namespace vog::cli {

namespace {

/// Bytes of a text such as "2G", "500M", "1.5G" or "123456"; units are powers of 1024.
std::uint64_t parse_memory(const std::string& text) {
    double number = 0;
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, number);
    std::string unit(stop, end);
    if (unit.ends_with('B') && unit.size() > 1) unit.pop_back();
    const std::map<std::string, double> bytes{
        {"", 1},       {"K", 0x1p10},  {"M", 0x1p20},  {"G", 0x1p30},  {"T", 0x1p40},
        {"k", 0x1p10}, {"Ki", 0x1p10}, {"Mi", 0x1p20}, {"Gi", 0x1p30}, {"Ti", 0x1p40}};
    const auto scale = bytes.find(unit);
    if (code != std::errc{} || scale == bytes.end() || !(number > 0) || number > 1e15)
        throw UsageError(
            fmt::format("--memory {}: expected a number of bytes > 0, such as 500M or 2G", text));
    return static_cast<std::uint64_t>(number * scale->second);
}

}  // namespace

void add_memory_options(CLI::App& command, MemoryArguments& arguments, const std::string& more) {
    const OptionGroup grouped(command, kLargeDataGroup);
    command.add_option("--memory", arguments.memory,
                       "Memory limit, such as 2G. Voxels that do not fit are paged to a scratch "
                       "file; the result is the same" +
                           more);
    command.add_option(setting("scratch"), arguments.scratch,
                       "Folder for scratch files. Default: the system's temporary folder");
}

CommandMemory::CommandMemory(const MemoryArguments& arguments)
    : exceptions_(std::uncaught_exceptions()) {
    if (arguments.memory.empty()) return;
    bytes_ = parse_memory(arguments.memory);
    limit_.emplace(bytes_, arguments.scratch);
}

CommandMemory::~CommandMemory() {
    if (bytes_ == 0 || std::uncaught_exceptions() > exceptions_ || peak_memory() <= bytes_) return;
    note(
        fmt::format("peak memory {} exceeded --memory {}: only voxels are paged out, not models, "
                    "cells or pictures",
                    bytes_text(peak_memory()), bytes_text(bytes_)));
}

}  // namespace vog::cli
