// allocations.h: number of calls of operator new.
#pragma once

namespace vog::test {

/// Calls of operator new in this process so far; TBB allocates tasks from its own pool.
/// returns  -1 under the address sanitizer, which has its own operator new
long allocations();

}  // namespace vog::test
