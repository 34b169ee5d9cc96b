// device_radix_sort.cuh: CUB's stable radix sort of pairs in double buffers, 8 bits a pass: the result is in either
// half, and the other holds what the passes left.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "emulation.h"

namespace cub {

template <class T>
struct DoubleBuffer {
    DoubleBuffer() = default;
    DoubleBuffer(T* current, T* alternate) : half{current, alternate} {}
    T* Current() const { return half[0]; }
    T* Alternate() const { return half[1]; }
    T* half[2] = {};
};

struct DeviceRadixSort {
    template <class Key, class Value, class Count>
    static cudaError_t SortPairs(void* scratch, std::size_t& bytes, DoubleBuffer<Key>& keys,
                                 DoubleBuffer<Value>& values, Count count, int begin_bit,
                                 int end_bit) {
        constexpr std::size_t kAtLeast = 2048;
        constexpr int kDigit = 8;
        if (!scratch) {
            bytes = kAtLeast;
            return cudaSuccess;
        }
        if (bytes < kAtLeast) vog::emulation::refuse("sort with too little scratch memory");
        vog::emulation::finish_stream(nullptr);
        std::memset(scratch, 0xee, bytes);
        for (int bit = begin_bit; bit < end_bit; bit += kDigit) {
            const int bits = std::min(kDigit, end_bit - bit);
            std::vector<Count> first((std::size_t{1} << bits) + 1);
            const auto digit = [&](Count n) {
                return keys.half[0][n] >> bit & ((Key{1} << bits) - 1);
            };
            for (Count n = 0; n < count; ++n) ++first[digit(n) + 1];
            for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
            for (Count n = 0; n < count; ++n) {
                const Count to = first[digit(n)]++;
                keys.half[1][to] = keys.half[0][n];
                values.half[1][to] = values.half[0][n];
            }
            std::swap(keys.half[0], keys.half[1]);
            std::swap(values.half[0], values.half[1]);
        }
        return cudaSuccess;
    }
};

}  // namespace cub
