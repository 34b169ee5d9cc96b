// memory_options.h: --memory and --scratch: options of commands that read volumes larger than memory.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "vog/memory.h"

namespace vog::cli {

inline constexpr const char* kLargeDataGroup = "Large data";

struct MemoryArguments {
    std::string memory, scratch;
};
/// Adds --memory and --scratch.
/// more  what else --memory does in this command, a sentence; may be empty
void add_memory_options(CLI::App& command, MemoryArguments& arguments, const std::string& more);

/// While alive, the process stays below --memory, if it is given; says at its end on standard error
/// where that did not do.
class AskedMemory {
  public:
    /// throws CLI::ValidationError, and vog::Error as MemoryLimit does
    explicit AskedMemory(const MemoryArguments& arguments);
    ~AskedMemory();
    AskedMemory(const AskedMemory&) = delete;
    AskedMemory& operator=(const AskedMemory&) = delete;

    std::uint64_t bytes() const { return bytes_; }  ///< 0: no limit

  private:
    std::uint64_t bytes_ = 0;
    std::optional<MemoryLimit> limit_;
    int exceptions_;  ///< in flight when it began: a command that fails says one line
};

}  // namespace vog::cli
