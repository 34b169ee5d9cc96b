// aligned_buffer.h: zeroed memory with the 32-byte alignment that NanoVDB requires of grids.
#pragma once

#include <nanovdb/NanoVDB.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/paging.h"
#include "vog/memory.h"

namespace vog {

/// Zeroed bytes at an address that is a multiple of 32.
class NanoBuffer {
  public:
    NanoBuffer() = default;
    explicit NanoBuffer(std::size_t bytes) : bytes_(bytes) {
        // Zeroed 1 MiB at a time: the buffer may be larger than memory.
        constexpr std::size_t kStep = (1 << 20) / NANOVDB_DATA_ALIGNMENT;
        const std::size_t count = (bytes + sizeof(Block) - 1) / sizeof(Block);
        blocks_.reserve(count);
        while (blocks_.size() < count) {
            keep_memory();
            blocks_.resize(std::min(blocks_.size() + kStep, count));
        }
    }

    std::byte* data() { return reinterpret_cast<std::byte*>(blocks_.data()); }
    const std::byte* data() const { return reinterpret_cast<const std::byte*>(blocks_.data()); }
    std::size_t size() const { return bytes_; }

  private:
    struct alignas(NANOVDB_DATA_ALIGNMENT) Block : std::array<std::byte, NANOVDB_DATA_ALIGNMENT> {};
    std::size_t bytes_ = 0;
    BigVector<Block> blocks_;
};

}  // namespace vog
