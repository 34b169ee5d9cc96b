// memory_pages.h: what loops over much data do for a MemoryLimit (vog/memory.h).
#pragma once

namespace vog {

/// Whether one is alive.
bool memory_limited();
/// Lets go of the pages of large arrays where the process has come near its limit. Looks four
/// times a millisecond; costs next to nothing in between, and nothing without a limit.
void keep_memory();

}  // namespace vog
