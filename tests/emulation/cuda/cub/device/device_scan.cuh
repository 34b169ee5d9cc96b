// device_scan.cuh: CUB's prefix sum. It adds up in the type of its input, whatever the type of its output.
#pragma once

#include <cuda_runtime.h>

#include <type_traits>

#include "emulation.h"

namespace cub {

struct DeviceScan {
    template <class In, class Out, class Count>
    static cudaError_t InclusiveSum(void* scratch, std::size_t& bytes, In in, Out out,
                                    Count count) {
        constexpr std::size_t kAtLeast = 512;
        if (!scratch) {
            bytes = kAtLeast;
            return cudaSuccess;
        }
        if (bytes < kAtLeast) vog::emulation::refuse("prefix sum with too little scratch memory");
        vog::emulation::finish_stream(nullptr);
        std::remove_cvref_t<decltype(*in)> sum{};
        for (Count n = 0; n < count; ++n) out[n] = sum = sum + in[n];
        return cudaSuccess;
    }
};

}  // namespace cub
