// allocations.h: how often operator new has been called.
#pragma once

namespace vog::test {

/// Calls of operator new so far, by anyone in this process; TBB's tasks come from its own pool.
/// Below 0: nobody counts, for the address sanitizer has an operator new of its own.
long allocations();

}  // namespace vog::test
