// allocations.cpp: a counting operator new for the whole process. Not under the address sanitizer,
// which has its own.
#include "support/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#ifdef __SANITIZE_ADDRESS__

namespace vog::test {

long allocations() { return -1; }

}  // namespace vog::test

#else

namespace {

std::atomic<long> calls{0};

void* counted(std::size_t bytes, std::size_t alignment) {
    ++calls;
    // aligned_alloc requires a multiple of the alignment above 0.
    const std::size_t blocks = bytes / alignment + 1;
    void* memory = std::aligned_alloc(alignment, blocks * alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return counted(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace vog::test {

long allocations() { return calls; }

}  // namespace vog::test

#endif
