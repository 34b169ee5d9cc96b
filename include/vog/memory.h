// vog/memory.h: arrays larger than memory. While a MemoryLimit is alive, large BigVectors lie in
// unnamed files that the system pages in on access; results are the same bytes without a limit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace vog {

/// Limit on the resident memory of the process while alive, as far as BigVectors occupy it: those
/// of at least a sixteenth of `bytes` that are allocated meanwhile lie in files of `folder`, and a
/// thread drops their pages when the process comes near the limit. Earlier arrays stay where they
/// are. One limit at a time; Linux only.
class MemoryLimit {
  public:
    /// bytes   at least 64 MiB
    /// folder  on a disk with room for the uncompressed data; empty: the system's temporary folder
    /// throws  vog::Error for too small a limit, while another limit is alive, for a folder that
    ///         cannot be written or lies in memory itself (tmpfs)
    explicit MemoryLimit(std::uint64_t bytes, const std::filesystem::path& folder = {});
    ~MemoryLimit();
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

    std::uint64_t scratch_bytes() const;  ///< peak size of the arrays in files, bytes

  private:
    class Pager;
    std::unique_ptr<Pager> pager_;
};

/// Peak resident memory of the process so far, bytes.
std::uint64_t peak_memory();

/// Untyped memory of BigAllocator: from operator new, or a mapped file under a MemoryLimit.
class BigMemory {
    template <class T>
    friend struct BigAllocator;
    /// throws  std::bad_alloc; vog::Error if the disk is full
    static void* allocate(std::size_t bytes, std::size_t alignment);
    static void free(void* memory, std::size_t alignment) noexcept;
};

/// Standard allocator of BigVector.
template <class T>
struct BigAllocator {
    using value_type = T;
    BigAllocator() = default;
    template <class U>
    BigAllocator(const BigAllocator<U>&) {}
    T* allocate(std::size_t count) {
        return static_cast<T*>(BigMemory::allocate(count * sizeof(T), alignof(T)));
    }
    void deallocate(T* memory, std::size_t) noexcept { BigMemory::free(memory, alignof(T)); }
    friend bool operator==(const BigAllocator&, const BigAllocator&) { return true; }
};

/// std::vector whose memory a MemoryLimit may place in a file.
template <class T>
using BigVector = std::vector<T, BigAllocator<T>>;

}  // namespace vog
