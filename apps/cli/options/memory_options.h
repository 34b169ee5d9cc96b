// memory_options.h: --memory and --set scratch, for volumes larger than memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "options/parser/given_options.h"
#include "vog/memory.h"

namespace vog::cli {

inline constexpr const char* kLargeDataGroup = "Large data";

struct MemoryArguments {
    std::string memory, scratch;
};
/// Adds --memory and --set scratch.
/// more  a further sentence for the help of --memory; may be empty
void add_memory_options(CLI::App& command, MemoryArguments& arguments, const std::string& more);

/// Memory limit of a command while it lives: pages voxels out to stay below --memory. At its end,
/// notes on standard error if the peak was above the limit all the same.
class CommandMemory {
  public:
    /// throws  UsageError for a limit that is no size, vog::Error as MemoryLimit does
    explicit CommandMemory(const MemoryArguments& arguments);
    ~CommandMemory();
    CommandMemory(const CommandMemory&) = delete;
    CommandMemory& operator=(const CommandMemory&) = delete;

    std::uint64_t bytes() const { return bytes_; }  ///< 0: no limit

  private:
    std::uint64_t bytes_ = 0;
    std::optional<MemoryLimit> limit_;
    int exceptions_;  ///< in flight at construction: a command that fails prints its error only
};

}  // namespace vog::cli
