// vog/memory.h: data larger than memory. Volumes keep their voxels in BigVectors; while a
// MemoryLimit is alive, large ones lie in files without a name, which the system pages in as they
// are read. Results are the same bytes either way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace vog {

/// While alive, the process is kept below `bytes`, as far as what it holds in BigVectors goes:
/// arrays of a sixteenth of that or more are made in files of `folder`, and a thread lets go of
/// their pages whenever the process comes near. Arrays made before stay where they are. One at a
/// time; Linux.
class MemoryLimit {
  public:
    /// folder  on a disk with room for the data, uncompressed; empty: that of temporary files
    /// throws  vog::Error for less than 64 MiB, another limit alive, a folder that cannot be
    ///         written or is itself in memory (tmpfs)
    explicit MemoryLimit(std::uint64_t bytes, const std::filesystem::path& folder = {});
    ~MemoryLimit();
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

    std::uint64_t scratch_bytes() const;  ///< most that lay in files at a time

  private:
    class Pager;
    std::unique_ptr<Pager> pager_;
};

/// Most memory the process has held so far, bytes.
std::uint64_t peak_memory();

/// Memory as operator new gives it, or as MemoryLimit has it.
/// throws  std::bad_alloc; vog::Error where the disk is full
void* allocate_big(std::size_t bytes, std::size_t alignment);
void free_big(void* memory, std::size_t bytes, std::size_t alignment) noexcept;

template <class T>
struct BigAllocator {
    using value_type = T;
    BigAllocator() = default;
    template <class U>
    BigAllocator(const BigAllocator<U>&) {}
    T* allocate(std::size_t count) {
        return static_cast<T*>(allocate_big(count * sizeof(T), alignof(T)));
    }
    void deallocate(T* memory, std::size_t count) noexcept {
        free_big(memory, count * sizeof(T), alignof(T));
    }
    friend bool operator==(const BigAllocator&, const BigAllocator&) { return true; }
};

/// A std::vector that may be larger than memory.
template <class T>
using BigVector = std::vector<T, BigAllocator<T>>;

}  // namespace vog
